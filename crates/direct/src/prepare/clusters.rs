//! Neighbouring tiles of a frame, prepared for many points.

use std::cmp::Ordering;
use std::ops::Range as Span;
use std::sync::OnceLock;

use fearless_simd::Level;
use glam::DVec3;
use magsplice_cuboid::block::Block;
use magsplice_cuboid::closed_form::terms::Form;
use magsplice_cuboid::evaluator::Evaluator;
use magsplice_cuboid::method::MethodRanges;
use magsplice_cuboid::series::coefficients::{GradientSeries, Series};
use magsplice_cuboid::series::multipole::Distant;
use magsplice_cuboid::shape::Shape;
use magsplice_expansion::moments::Moments;
use magsplice_expansion::multipole::MultipoleExpansion;
use magsplice_expansion::source::CuboidSource;
use magsplice_expansion::tolerances::HIGHEST_DEGREE;
use magsplice_simd::compensated_sum::TwoSum;
use rustc_hash::{FxHashMap, FxHashSet};

use super::bars::decomposed;
use super::cluster_methods::{is_compact, radius_of, ranges_of_cluster, scale_of};
use super::corner_tables::CornerTables;
use crate::tolerances::{HALVED_RADIUS, KEPT_SERIES, MOST_PLANES, TILES_PER_CLUSTER, TILES_PER_ITEM};

/// The clusters and tiles of a frame, and the multipole series of their shapes.
#[derive(Clone, Debug, Default)]
pub struct ClusterTable {
    /// Blocks evaluated together.
    pub clusters: Vec<Cluster>,
    /// Each block as a single tile.
    pub tiles: Vec<PreparedTile>,
    series: Vec<Series>,
    /// Built when first needed, like the series of the field for each shape.
    gradient_series: Vec<OnceLock<GradientSeries>>,
}

/// Precomputed data of a single tile.
#[derive(Clone, Debug)]
pub struct PreparedTile {
    /// The smallest distance of each method.
    pub ranges: MethodRanges,
    /// The far field of the tile.
    pub distant: Distant,
    shape: u32,
}

/// Consecutive blocks of a frame that share a method at many points.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// The blocks, in the order of the frame.
    pub blocks: Span<usize>,
    /// The smallest distance of each method.
    pub ranges: MethodRanges,
    /// Shared corners and planes; `None` for a single tile.
    pub corners: Option<CornerTables>,
    /// Built when first needed.
    expansion: OnceLock<MultipoleExpansion>,
    /// Built when first needed.
    slopes: OnceLock<[MultipoleExpansion; 2]>,
}

impl Cluster {
    /// A cluster of `blocks`, which begin at `start` in their frame; `None` if the tables would be
    /// too long.
    fn new(blocks: &[Block], start: usize) -> Option<Cluster> {
        let (ranges, corners) = if let [block] = blocks {
            (MethodRanges::from_block(block), None)
        } else {
            let bars = decomposed(blocks);
            let parts = bars.as_deref().unwrap_or(blocks);
            let scale = scale_of(parts);
            let form = |part: &Block| if bars.is_some() { Form::Compact } else { Shape::new(part, scale).form() };
            let forms: Vec<Form> = parts.iter().map(form).collect();
            let corners = CornerTables::new(parts, &forms, scale)?;
            let ranges = ranges_of_cluster(parts, &corners, blocks.len());
            (ranges, Some(corners))
        };
        Some(Cluster {
            blocks: start..start + blocks.len(),
            ranges,
            corners,
            expansion: OnceLock::new(),
            slopes: OnceLock::new(),
        })
    }

    /// The two halves of a long cluster, if they are much smaller and their tables fit. `blocks`
    /// are the blocks of the frame.
    pub fn halves(&self, blocks: &[Block]) -> Option<[Span<usize>; 2]> {
        let Span { start, end } = self.blocks;
        let middle = start + (end - start) / 2;
        let halves = [start..middle, middle..end];
        let radius = radius_of(&blocks[start..end]);
        let is_smaller = |half: &Span<usize>| {
            let blocks = &blocks[half.clone()];
            radius_of(blocks) <= HALVED_RADIUS * radius && most_planes(blocks) <= MOST_PLANES
        };
        (end - start > TILES_PER_ITEM && halves.iter().all(is_smaller)).then_some(halves)
    }

    /// One of the [`Cluster::halves`].
    pub fn half(blocks: &[Block], half: Span<usize>) -> Cluster {
        // The tables of so few tiles always fit: 32 tiles have 256 corners and 192 elements. Bars
        // have fewer elements, with 8 corners for 3 elements.
        Cluster::new(&blocks[half.clone()], half.start).expect("halves that fit")
    }

    /// The multipole expansion of the cluster. `blocks` are the blocks of the frame.
    pub fn expansion(&self, level: Level, blocks: &[Block]) -> &MultipoleExpansion {
        let own = || &blocks[self.blocks.clone()];
        self.expansion.get_or_init(|| expansion_of(level, own(), self.ranges.centre, self.ranges.scale))
    }
}

impl Cluster {
    /// The multipole expansions of the derivatives along x and y of the potential, with lengths
    /// multiplied by the scale of the ranges.
    pub fn slopes(&self, level: Level, blocks: &[Block]) -> &[MultipoleExpansion; 2] {
        let MethodRanges { centre, scale, .. } = self.ranges;
        let of = |slope: Moments| MultipoleExpansion::from_moments(&slope, centre, scale);
        let own = || moments_of(level, &blocks[self.blocks.clone()], centre, scale).slopes();
        self.slopes.get_or_init(|| own().map(of))
    }
}

impl ClusterTable {
    /// Sorts `blocks` so that neighbours follow each other, and divides them into clusters.
    pub fn new(blocks: &mut [Block]) -> ClusterTable {
        let mut table = ClusterTable::default();
        let mut places: Vec<BlockCentre> =
            blocks.iter().enumerate().map(|(index, block)| BlockCentre::new(index, block)).collect();
        let mut ordered = Vec::with_capacity(blocks.len());
        table.divide(blocks, &mut places, true, &mut ordered);
        blocks.clone_from_slice(&ordered);
        let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        for block in &*blocks {
            let next = known.len() as u32;
            let shape = *known.entry(block.size.map(f64::to_bits)).or_insert(next);
            let ranges = MethodRanges::from_block(block);
            table.tiles.push(PreparedTile { distant: Distant::new(block, ranges.scale), ranges, shape });
        }
        if known.len() <= KEPT_SERIES {
            let mut shapes: Vec<([u64; 3], u32)> = known.into_iter().collect();
            shapes.sort_by_key(|shape| shape.1);
            let orders: FxHashMap<u32, usize> =
                table.tiles.iter().map(|tile| (tile.shape, tile.ranges.highest_order())).collect();
            let series = |(size, shape): ([u64; 3], u32)| Series::new(size.map(f64::from_bits), orders[&shape]);
            table.series = shapes.into_iter().map(series).collect();
            table.gradient_series = table.series.iter().map(|_| OnceLock::new()).collect();
        }
        table
    }

    /// Number of clusters, including single tiles.
    pub fn parts(&self) -> usize {
        self.clusters.len()
    }

    /// The series of the shape of block `index`. A series that is not kept is computed into `made`.
    pub fn series<'a>(&'a self, blocks: &[Block], index: usize, made: &'a mut Option<Series>) -> &'a Series {
        let tile = &self.tiles[index];
        let kept = self.series.get(tile.shape as usize);
        kept.unwrap_or_else(|| made.insert(Series::new(blocks[index].size, tile.ranges.highest_order())))
    }

    /// [`ClusterTable::series`] of the gradient.
    pub fn gradient_series<'a>(
        &'a self,
        blocks: &[Block],
        index: usize,
        made: &'a mut Option<GradientSeries>,
    ) -> &'a GradientSeries {
        let tile = &self.tiles[index];
        let of_shape = || GradientSeries::new(blocks[index].size, tile.ranges.highest_order());
        match self.gradient_series.get(tile.shape as usize) {
            Some(kept) => kept.get_or_init(of_shape),
            None => made.insert(of_shape()),
        }
    }

    /// The evaluator of block `index` as a single tile. A series that is not kept is computed into
    /// `made`.
    pub fn evaluator<'a>(&'a self, blocks: &[Block], index: usize, made: &'a mut Option<Series>) -> Evaluator<'a> {
        let tile = &self.tiles[index];
        Evaluator::new(&blocks[index], &tile.ranges, &tile.distant, self.series(blocks, index, made))
    }

    /// Appends the `blocks` with the indices in `places` to `ordered`, cluster by cluster. If all
    /// blocks of the frame form one cluster, they keep their order.
    fn divide(&mut self, blocks: &[Block], places: &mut [BlockCentre], are_all: bool, ordered: &mut Vec<Block>) {
        let start = ordered.len();
        if places.len() <= TILES_PER_CLUSTER {
            if !are_all {
                // Sorted along their own longest axis, so that halves of a cluster are compact.
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

    /// Adds the blocks that begin at `start` as a cluster, if they can form one. Returns whether
    /// they can.
    fn take_together(&mut self, blocks: &[Block], start: usize) -> bool {
        if blocks.is_empty() {
            return true;
        }
        match Cluster::new(blocks, start) {
            Some(cluster) if cluster.corners.is_none() || is_compact(&cluster.ranges) => {
                self.clusters.push(cluster);
                true
            }
            _ => false,
        }
    }
}

/// The expansion of blocks of one frame around `centre`; lengths are multiplied by `scale`.
pub fn expansion_of(level: Level, blocks: &[Block], centre: [f64; 3], scale: f64) -> MultipoleExpansion {
    MultipoleExpansion::from_moments(&moments_of(level, blocks, centre, scale), centre, scale)
}

fn moments_of(level: Level, blocks: &[Block], centre: [f64; 3], scale: f64) -> Moments {
    let source = |block: &Block| {
        let middle = [0, 1, 2].map(|axis: usize| {
            let [low, high] = block.faces[axis].map(|face| face.minus(TwoSum::exact(centre[axis])).value());
            0.5 * low + 0.5 * high
        });
        CuboidSource::new(DVec3::from(middle) * scale, DVec3::from(block.size) * scale, None, block.polarization_t)
    };
    let sources: Vec<CuboidSource> = blocks.iter().map(source).collect();
    Moments::from_sources(level, &sources, HIGHEST_DEGREE)
}

/// Upper bound of the number of planes with faces of blocks, and of bars over them.
fn most_planes(blocks: &[Block]) -> usize {
    let faces = blocks.iter().flat_map(|block| (0..3).flat_map(|axis| block.faces[axis].map(|face| (axis, face))));
    let planes: FxHashSet<(usize, [u64; 2])> =
        faces.map(|(axis, face)| (axis, [face.hi, face.lo].map(f64::to_bits))).collect();
    planes.len()
}

/// The centre and index of a block. It is sorted in place of the block, which is ten times larger.
#[derive(Clone, Copy)]
struct BlockCentre {
    centre: [f64; 3],
    index: usize,
}

impl BlockCentre {
    fn new(index: usize, block: &Block) -> BlockCentre {
        BlockCentre { centre: block.faces.map(|[low, high]| 0.5 * low.hi + 0.5 * high.hi), index }
    }

    /// Compares positions along the axes in turn; equal positions keep the order of the blocks.
    fn compare(&self, other: &BlockCentre, axes: [usize; 3]) -> Ordering {
        let along = axes.map(|axis| self.centre[axis].total_cmp(&other.centre[axis]));
        along[0].then(along[1]).then(along[2]).then(self.index.cmp(&other.index))
    }
}

/// The axis along which the centres extend farthest, and the two axes that follow it.
fn longest_first(places: &[BlockCentre]) -> [usize; 3] {
    let reach = |axis: usize| {
        let positions = places.iter().map(|place| place.centre[axis]);
        positions.clone().fold(f64::NEG_INFINITY, f64::max) * 0.5 - positions.fold(f64::INFINITY, f64::min) * 0.5
    };
    let reaches = [0, 1, 2].map(reach);
    let longest = (0..3).max_by(|&a, &b| reaches[a].total_cmp(&reaches[b])).expect("three axes");
    [longest, (longest + 1) % 3, (longest + 2) % 3]
}

/// The first half along the axes, and the rest.
fn halved(places: &mut [BlockCentre], axes: [usize; 3]) -> (&mut [BlockCentre], &mut [BlockCentre]) {
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |a, b| a.compare(b, axes));
    places.split_at_mut(middle)
}
