//! A film as a sum of cuboids, fewer than its tiles.
//!
//! Tiles in a row often share one component of J with different strengths. A bar over the whole row
//! with the smallest strength, plus cuboids for the remainders, then needs fewer cuboids. Only
//! strengths of one sign are split, so no parts cancel.

use glam::DVec3;
use magsplice_cuboid::block::Block;
use rustc_hash::FxHashMap;

use crate::tolerances::LONGEST_BAR;

/// Cuboids with the same field as `blocks` that need fewer tensor elements; `None` without such
/// cuboids.
pub(super) fn decomposed(blocks: &[Block]) -> Option<Vec<Block>> {
    let mut parts: Vec<Block> = Vec::new();
    for component in 0..3 {
        let choices = [0, 1, 2].map(|along| rows(blocks, component, along));
        parts.extend(choices.into_iter().min_by_key(Vec::len).expect("three directions"));
    }
    let elements = |blocks: &[Block]| blocks.iter().map(|b| element_count(b.polarization_t)).sum::<usize>();
    let is_short = |part: &Block| {
        let mut sides = part.size;
        sides.sort_by(f64::total_cmp);
        sides[2] <= LONGEST_BAR * sides[1]
    };
    (elements(&parts) < elements(blocks) && parts.iter().all(is_short)).then_some(parts)
}

/// Number of tensor elements that a polarization needs.
fn element_count(j: DVec3) -> usize {
    match j.to_array().iter().filter(|j| **j != 0.0).count() {
        0 => 0,
        1 => 3,
        _ => 5,
    }
}

/// One component of J of the blocks, in bars along one axis.
fn rows(blocks: &[Block], component: usize, along: usize) -> Vec<Block> {
    let magnetized = blocks.iter().filter(|block| block.polarization_t[component] != 0.0);
    let mut by_outline: FxHashMap<[[u64; 4]; 2], Vec<&Block>> = FxHashMap::default();
    for block in magnetized {
        let outline = [1, 2].map(|next| {
            let [low, high] = block.faces[(along + next) % 3];
            [low.hi, low.lo, high.hi, high.lo].map(f64::to_bits)
        });
        by_outline.entry(outline).or_default().push(block);
    }
    // The order depends on the blocks alone.
    let mut outlines: Vec<_> = by_outline.into_iter().collect();
    outlines.sort_by_key(|(outline, _)| *outline);
    let mut parts = Vec::new();
    for (_, mut row) in outlines {
        row.sort_by(|a, b| a.faces[along][0].hi.total_cmp(&b.faces[along][0].hi));
        let joined = |a: &&Block, b: &&Block| {
            a.faces[along][1] == b.faces[along][0]
                && a.polarization_t[component].is_sign_positive() == b.polarization_t[component].is_sign_positive()
        };
        for run in row.chunk_by(joined) {
            cut(run, component, along, 0.0, &mut parts);
        }
    }
    parts
}

/// Appends a bar over a whole run with its smallest strength, and the remainders. `below` is the
/// strength already covered by other bars.
fn cut(run: &[&Block], component: usize, along: usize, below: f64, parts: &mut Vec<Block>) {
    let strength = |block: &&Block| block.polarization_t[component].abs();
    let least = run.iter().map(strength).fold(f64::INFINITY, f64::min);
    let mut bar = run[0].clone();
    bar.faces[along][1] = run[run.len() - 1].faces[along][1];
    bar.size[along] = bar.faces[along][1].minus(bar.faces[along][0]).value();
    bar.polarization_t = DVec3::ZERO;
    bar.polarization_t[component] = (least - below).copysign(run[0].polarization_t[component]);
    parts.push(bar);
    for rest in run.split(|block| strength(block) == least).filter(|rest| !rest.is_empty()) {
        cut(rest, component, along, least, parts);
    }
}
