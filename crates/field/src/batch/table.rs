//! The tiles of one frame prepared for many points.

use std::cmp::Ordering;
use std::ops::Range as Span;
use std::sync::OnceLock;

use fearless_simd::Level;
use rustc_hash::{FxHashMap, FxHashSet};

use super::bars::decomposed;
use super::cluster::Cluster;
use super::expansion::Expansion;
use super::multipole::Distant;
use super::range::Range;
use super::series::Series;
use crate::block::Block;
use crate::tolerances::{HALVED_RADIUS, KEPT_SERIES, MOST_PLANES, TILES_PER_CLUSTER, TILES_PER_ITEM};

/// Clusters of neighbouring tiles, and the series of their shapes.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameTable {
    pub(super) clusters: Vec<Together>,
    pub(super) tiles: Vec<TileTable>,
    series: Vec<Series>,
}

/// A tile for all the forms that take it by itself.
#[derive(Clone, Debug)]
pub(super) struct TileTable {
    pub(super) range: Range,
    pub(super) far: Distant,
    shape: u32,
}

/// Consecutive blocks that one form serves at many points.
#[derive(Clone, Debug)]
pub(super) struct Together {
    pub(super) blocks: Span<usize>,
    pub(super) range: Range,
    /// `None` for a single tile.
    pub(super) cluster: Option<Cluster>,
    /// Made when first needed.
    expansion: OnceLock<Expansion>,
}

impl Together {
    /// Of some of a frame's blocks, from `start` on; `None` if they do not fit.
    fn of(blocks: &[Block], start: usize) -> Option<Together> {
        let (range, cluster) = if let [block] = blocks {
            (Range::of_tile(block), None)
        } else {
            let parts = decomposed(blocks);
            let cluster = Cluster::of(&parts, Range::scale_of(&parts))?;
            let range = Range::of_tiles(&parts, blocks.len(), cluster.largest_group_volume, cluster.largest_group);
            (range, Some(cluster))
        };
        Some(Together { blocks: start..start + blocks.len(), range, cluster, expansion: OnceLock::new() })
    }

    /// Two halves of these of a frame's `blocks`, if they are many, much smaller, and fit whatever they share.
    pub(super) fn halves(&self, blocks: &[Block]) -> Option<[Span<usize>; 2]> {
        let Span { start, end } = self.blocks;
        let middle = start + (end - start) / 2;
        let halves = [start..middle, middle..end];
        let radius = Range::radius_of(&blocks[start..end]);
        let serves = |half: &Span<usize>| {
            let blocks = &blocks[half.clone()];
            Range::radius_of(blocks) <= HALVED_RADIUS * radius && most_planes(blocks) <= MOST_PLANES
        };
        (end - start > TILES_PER_ITEM && halves.iter().all(serves)).then_some(halves)
    }

    /// One of the [`Together::halves`].
    pub(super) fn half(blocks: &[Block], half: Span<usize>) -> Together {
        // Of so few tiles corners and groups fit as well: 32 tiles have 256 corners and 192 elements, and bars instead of them have fewer elements, each
        // 3 of them 8 corners.
        Together::of(&blocks[half.clone()], half.start).expect("halves that fit")
    }

    /// The expansion of these of a frame's `blocks`.
    pub(super) fn expansion(&self, level: Level, blocks: &[Block]) -> &Expansion {
        let own = || &blocks[self.blocks.clone()];
        self.expansion.get_or_init(|| Expansion::of(level, own(), self.range.centre, self.range.scale))
    }
}

impl FrameTable {
    /// Brings `blocks` into an order in which neighbours are close to each other, and prepares them.
    pub(crate) fn of(blocks: &mut [Block]) -> FrameTable {
        let mut table = FrameTable::default();
        let mut places: Vec<Place> = blocks.iter().enumerate().map(|(index, block)| Place::of(index, block)).collect();
        let mut ordered = Vec::with_capacity(blocks.len());
        table.divide(blocks, &mut places, true, &mut ordered);
        blocks.clone_from_slice(&ordered);
        let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        for block in &*blocks {
            let next = known.len() as u32;
            let shape = *known.entry(block.size.map(f64::to_bits)).or_insert(next);
            let range = Range::of_tile(block);
            table.tiles.push(TileTable { far: Distant::of(block, range.scale), range, shape });
        }
        if known.len() <= KEPT_SERIES {
            let mut shapes: Vec<([u64; 3], u32)> = known.into_iter().collect();
            shapes.sort_by_key(|shape| shape.1);
            let orders: FxHashMap<u32, usize> =
                table.tiles.iter().map(|tile| (tile.shape, tile.range.highest_order())).collect();
            let series = |(size, shape): ([u64; 3], u32)| Series::of(size.map(f64::from_bits), orders[&shape]);
            table.series = shapes.into_iter().map(series).collect();
        }
        table
    }

    /// How many clusters and tiles by themselves there are.
    pub(crate) fn parts(&self) -> usize {
        self.clusters.len()
    }

    /// The series of a block's shape, if it is kept.
    pub(super) fn series(&self, block: usize) -> Option<&Series> {
        self.series.get(self.tiles[block].shape as usize)
    }

    /// Brings the `blocks` at some places into order; those of all places, if they are together, remain in theirs.
    fn divide(&mut self, blocks: &[Block], places: &mut [Place], are_all: bool, ordered: &mut Vec<Block>) {
        let start = ordered.len();
        if places.len() <= TILES_PER_CLUSTER {
            if !are_all {
                // Along their own longest axis, so that halves of them are compact.
                let axes = longest_first(places);
                places.sort_unstable_by(|a, b| a.compare(b, axes));
            }
            ordered.extend(places.iter().map(|place| blocks[place.index].clone()));
            if self.take_together(&ordered[start..], start) {
                return;
            }
            ordered.truncate(start);
        }
        let axes = longest_first(places);
        let (low, high) = halved(places, axes);
        self.divide(blocks, low, false, ordered);
        self.divide(blocks, high, false, ordered);
    }

    /// Whether blocks that are now at `start` are none, one, or some that one form serves.
    fn take_together(&mut self, blocks: &[Block], start: usize) -> bool {
        if blocks.is_empty() {
            return true;
        }
        match Together::of(blocks, start) {
            Some(together) if together.cluster.is_none() || together.range.is_compact() => {
                self.clusters.push(together);
                true
            }
            _ => false,
        }
    }
}

/// How many planes the faces of blocks and of bars over some of them lie in, at most.
fn most_planes(blocks: &[Block]) -> usize {
    let faces = blocks.iter().flat_map(|block| (0..3).flat_map(|axis| block.faces[axis].map(|face| (axis, face))));
    let planes: FxHashSet<(usize, [u64; 2])> =
        faces.map(|(axis, face)| (axis, [face.hi, face.lo].map(f64::to_bits))).collect();
    planes.len()
}

/// Where a block is: what is sorted instead of the blocks, which are ten times larger.
#[derive(Clone, Copy)]
struct Place {
    centre: [f64; 3],
    index: usize,
}

impl Place {
    fn of(index: usize, block: &Block) -> Place {
        Place { centre: block.faces.map(|[low, high]| 0.5 * low.hi + 0.5 * high.hi), index }
    }

    /// By position along axes, those of one position as they were.
    fn compare(&self, other: &Place, axes: [usize; 3]) -> Ordering {
        let along = axes.map(|axis| self.centre[axis].total_cmp(&other.centre[axis]));
        along[0].then(along[1]).then(along[2]).then(self.index.cmp(&other.index))
    }
}

/// The axis along which the places reach farthest, and those that follow it.
fn longest_first(places: &[Place]) -> [usize; 3] {
    let reach = |axis: usize| {
        let positions = places.iter().map(|place| place.centre[axis]);
        positions.clone().fold(f64::NEG_INFINITY, f64::max) * 0.5 - positions.fold(f64::INFINITY, f64::min) * 0.5
    };
    let reaches = [0, 1, 2].map(reach);
    let longest = (0..3).max_by(|&a, &b| reaches[a].total_cmp(&reaches[b])).expect("three axes");
    [longest, (longest + 1) % 3, (longest + 2) % 3]
}

/// Those that come first along axes, and the others.
fn halved(places: &mut [Place], axes: [usize; 3]) -> (&mut [Place], &mut [Place]) {
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |a, b| a.compare(b, axes));
    places.split_at_mut(middle)
}
