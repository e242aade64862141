//! A lower bound of the holding force of all placement orders.
//!
//! Read backwards, an order removes tiles from the whole film. The force on each comes from the
//! remaining tiles, so a step depends on the set of removed tiles and not on their order. The
//! search examines sets in ascending order of the smallest holding force that reaches them. When it
//! stops, every order passes through a set that was not examined, and no such set is reached with a
//! smaller holding force than the set examined last. If the search reaches the empty film, or no
//! set remains below the holding force of a known order, the smallest holding force is known.

use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashSet};

use glam::DVec3;

use crate::film_forces::FilmForces;

/// Largest number of sets waiting for examination, in about 200 MB.
const MOST_WAITING: usize = 4_000_000;

/// Fraction by which the bound is lowered. Forces of sets are differences, with errors of a few
/// units of round-off of the largest.
const ROUND_OFF: f64 = 1e-12;

/// Result of the search.
pub(crate) struct Bound {
    /// No order has a smaller holding force.
    pub(crate) force: f64,
    /// An order better than the known order, if the search reached one.
    pub(crate) order: Option<Vec<usize>>,
}

/// A set of removed tiles: the set of `parent`, and one more.
struct Taken {
    parent: usize,
    tile: usize,
}

/// A waiting set, ordered by the smallest holding force, then by the largest set.
struct Waiting {
    holding: f64,
    size: usize,
    taken: usize,
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Waiting) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Waiting) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Waiting) -> Ordering {
        let by_size = || self.size.cmp(&other.size);
        other.holding.total_cmp(&self.holding).then_with(by_size).then_with(|| other.taken.cmp(&self.taken))
    }
}

/// The bound, from at most `examined_sets` sets, where an order with the holding force `known`
/// exists.
pub(crate) fn bound(forces: &FilmForces, known: f64, examined_sets: usize) -> Bound {
    let count = forces.tile_count();
    let whole: Vec<DVec3> = forces.by_all().iter().map(|load| load.force).collect();
    let mut arena: Vec<Taken> = Vec::new();
    let mut waiting = BinaryHeap::from([Waiting { holding: 0.0, size: 0, taken: usize::MAX }]);
    let mut examined: HashSet<Vec<u64>> = HashSet::new();
    let mut reached = 0.0;
    while let Some(next) = waiting.pop() {
        reached = next.holding;
        let taken = taken_tiles(&arena, next.taken);
        if taken.len() == count {
            return Bound { force: lowered(reached), order: Some(taken.into_iter().rev().collect()) };
        }
        if examined.len() >= examined_sets || waiting.len() >= MOST_WAITING {
            return Bound { force: lowered(reached), order: None };
        }
        let mut bits = vec![0_u64; count.div_ceil(64)];
        for &tile in &taken {
            bits[tile / 64] |= 1 << (tile % 64);
        }
        let is_left = |tile: &usize| bits[tile / 64] >> (tile % 64) & 1 == 0;
        if examined.contains(&bits) {
            continue;
        }
        for tile in (0..count).filter(is_left) {
            let gone: DVec3 = taken.iter().map(|&by| forces.by_one(tile, by).force).sum();
            let holding = (whole[tile] - gone).length().max(next.holding);
            if holding < known {
                waiting.push(Waiting { holding, size: taken.len() + 1, taken: arena.len() });
                arena.push(Taken { parent: next.taken, tile });
            }
        }
        examined.insert(bits);
    }
    // No order is below the known order.
    Bound { force: lowered(known.max(reached)), order: None }
}

fn lowered(force: f64) -> f64 {
    force * (1.0 - ROUND_OFF)
}

/// The removed tiles in placement order, which is the reverse of their removal.
fn taken_tiles(arena: &[Taken], mut at: usize) -> Vec<usize> {
    let mut tiles = Vec::new();
    while let Some(taken) = arena.get(at) {
        tiles.push(taken.tile);
        at = taken.parent;
    }
    tiles.reverse();
    tiles
}
