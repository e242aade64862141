//! The tiles of one frame prepared for many points.

use std::ops::Range as Span;
use std::sync::OnceLock;

use fearless_simd::Level;
use rustc_hash::FxHashMap;

use super::bars::decomposed;
use super::cluster::Cluster;
use super::expansion::Expansion;
use super::multipole::{Distant, Series};
use super::range::Range;
use crate::block::Block;
use crate::tolerances::{KEPT_SERIES, TILES_PER_CLUSTER};

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
    fn new(blocks: Span<usize>, range: Range, cluster: Option<Cluster>) -> Together {
        Together { blocks, range, cluster, expansion: OnceLock::new() }
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
        table.divide(blocks, 0);
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
            table.series = shapes.into_iter().map(|(size, _)| Series::of(size.map(f64::from_bits))).collect();
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

    fn divide(&mut self, blocks: &mut [Block], start: usize) {
        match blocks {
            [] => {}
            [block] => {
                let range = Range::of_tile(block);
                self.clusters.push(Together::new(start..start + 1, range, None));
            }
            _ => {
                if blocks.len() <= TILES_PER_CLUSTER {
                    let parts = decomposed(blocks);
                    if let Some(cluster) = Cluster::of(&parts, Range::scale_of(&parts)) {
                        let range = Range::of_tiles(&parts, blocks.len(), cluster.largest_group_volume);
                        if range.is_compact() {
                            let blocks = start..start + blocks.len();
                            self.clusters.push(Together::new(blocks, range, Some(cluster)));
                            return;
                        }
                    }
                }
                let middle = blocks.len() / 2;
                sort_along_longest(blocks);
                let (low, high) = blocks.split_at_mut(middle);
                self.divide(low, start);
                self.divide(high, start + middle);
            }
        }
    }
}

/// Sorts by position along the axis on which the blocks reach farthest, ties along the next axes.
fn sort_along_longest(blocks: &mut [Block]) {
    let at = |block: &Block, axis: usize| 0.5 * block.faces[axis][0].hi + 0.5 * block.faces[axis][1].hi;
    let reach = |axis: usize| {
        let positions = blocks.iter().map(|b| at(b, axis));
        positions.clone().fold(f64::NEG_INFINITY, f64::max) * 0.5 - positions.fold(f64::INFINITY, f64::min) * 0.5
    };
    let reaches = [0, 1, 2].map(reach);
    let longest = (0..3).max_by(|&a, &b| reaches[a].total_cmp(&reaches[b])).expect("three axes");
    let axes = [longest, (longest + 1) % 3, (longest + 2) % 3];
    blocks.sort_by(|a, b| {
        let along = axes.map(|axis| at(a, axis).total_cmp(&at(b, axis)));
        along[0].then(along[1]).then(along[2])
    });
}
