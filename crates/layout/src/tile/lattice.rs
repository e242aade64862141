//! `[[lattice]]`: one tile for each cell of a cut film whose pattern is not zero.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use std::iter::repeat_n;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{FINITE, NOT_NEGATIVE, POSITIVE, TableFaults};
use crate::layout::NamedTile;
use crate::material::RecoilPermeability;
use crate::plausible::{check_component, check_material};
use crate::tile::checked_tile;
use crate::tile::room::Room;

/// A film cut along lines parallel to x and y. Each cell holds one tile, unless its pattern is zero
/// along both axes.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct LatticeTable {
    /// First part of the names of its tiles, as in NAME-x2-y1. Default: lattice-1, lattice-2 and so
    /// on, numbered in the order of the file.
    pub(crate) name: Option<String>,
    /// Lower corner, in mm.
    #[schemars(extend("example" = "[-10.0, -10.0, 0.0]"))]
    start_mm: [f64; 3],
    /// Height along z, in mm.
    height_mm: f64,
    /// Magnitude of every tile's polarization, in T. Give either this or component_t.
    strength_t: Option<f64>,
    /// Factor of the pattern, in T: the polarization is this times the pattern. Give either this or
    /// strength_t.
    component_t: Option<f64>,
    /// Relative recoil permeability of its tiles. Default: that of [material].
    recoil_permeability: Option<RecoilPermeability>,
    /// Intervals along x.
    #[schemars(extend("example" = "[{ widths_mm = [3.3, 1.7], pattern = [1, 0] }]"))]
    x: Vec<LatticeSection>,
    /// Intervals along y. Default: the intervals along x.
    #[schemars(extend("example" = "[{ widths_mm = [3.3, 1.7], pattern = [1, 0] }]"))]
    y: Option<Vec<LatticeSection>>,
}

/// Consecutive intervals along one axis of a lattice.
#[derive(Deserialize, JsonSchema, Serialize)]
struct LatticeSection {
    /// Widths of the intervals, in mm.
    #[schemars(extend("example" = "[3.3, 1.7]"))]
    widths_mm: Vec<f64>,
    /// For each interval the component of the polarization's direction along this axis.
    #[schemars(extend("example" = "[1, 0]"))]
    pattern: Vec<f64>,
    /// How many times the section is repeated. Default: 1.
    times: Option<usize>,
}

impl LatticeTable {
    /// The tiles of a lattice, or `None` after adding its faults.
    pub(crate) fn resolve(&self, name: &str, room: &mut Room, faults: &mut TableFaults) -> Option<Vec<NamedTile>> {
        let (sections_x, sections_y) = (&self.x, self.y.as_ref().unwrap_or(&self.x));
        let before = faults.count();
        let (key, factor_t) = match (self.strength_t, self.component_t) {
            (Some(strength), None) => ("strength_t", strength),
            (None, Some(component)) => ("component_t", component),
            _ => {
                let rule = "must give one of strength_t (|J| of every tile) and component_t (factor of the pattern)";
                return faults.refuse(rule);
            }
        };
        faults.number(key, factor_t, NOT_NEGATIVE);
        match self.strength_t {
            Some(strength) => check_material(key, strength, faults),
            None => check_component(factor_t, largest(sections_x).hypot(largest(sections_y)), faults),
        }
        check_sections("x", &self.x, faults);
        if let Some(y) = &self.y {
            check_sections("y", y, faults);
        }
        let permeability = self.recoil_permeability.and_then(|written| written.resolve(faults));
        faults.numbers("start_mm", &self.start_mm[..2], FINITE);
        faults.require(self.height_mm > 0.0, "height_mm", self.height_mm, "must be greater than 0");
        if faults.count() > before {
            return None;
        }
        let [columns, rows] = [sections_x, sections_y].map(|sections| count(sections));
        // Every cell counts, so that a lattice with few tiles in many cells takes no time either.
        if !room.take(columns.saturating_mul(rows), name.len(), format!("has {columns} x {rows} cells"), faults) {
            return None;
        }
        let columns = intervals(sections_x, self.start_mm[0]);
        let rows = intervals(sections_y, self.start_mm[1]);
        if columns.iter().chain(&rows).all(|interval| interval.pattern == 0.0) {
            return faults.refuse("has no tiles: pattern is zero everywhere");
        }
        let z = self.start_mm[2] + 0.5 * self.height_mm;
        let mut tiles = Vec::new();
        for (i, column) in columns.iter().enumerate() {
            for (j, row) in rows.iter().enumerate() {
                let pattern = DVec3::new(column.pattern, row.pattern, 0.0);
                if pattern == DVec3::ZERO {
                    continue;
                }
                // With strength_t the pattern gives the direction only.
                let direction = match self.strength_t {
                    Some(_) => (pattern / pattern.abs().max_element()).normalize(),
                    None => pattern,
                };
                let position = DVec3::new(column.centre, row.centre, z);
                let size = DVec3::new(column.width, row.width, self.height_mm);
                let tile = checked_tile(position, size, direction * factor_t, faults)?;
                tiles.push(NamedTile {
                    name: format!("{name}-x{}-y{}", i + 1, j + 1),
                    kind: None,
                    rotation: None,
                    tile,
                    permeability,
                });
            }
        }
        Some(tiles)
    }
}

/// The largest absolute value in the patterns of an axis.
fn largest(sections: &[LatticeSection]) -> f64 {
    sections.iter().flat_map(|section| &section.pattern).fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

fn check_sections(axis: &str, sections: &[LatticeSection], faults: &mut TableFaults) {
    for (index, section) in sections.iter().enumerate() {
        let key = format!("{axis}[{index}]");
        let (widths, pattern) = (section.widths_mm.len(), section.pattern.len());
        if widths != pattern {
            faults.add(format!(
                "{key} has {widths} widths_mm and {pattern} pattern entries, must have the same number of both"
            ));
        }
        faults.numbers(format_args!("{key}.widths_mm"), &section.widths_mm, POSITIVE);
        faults.numbers(format_args!("{key}.pattern"), &section.pattern, FINITE);
        if widths == 0 {
            faults.add(format!("{key} has no widths_mm, must have at least one interval"));
        }
        if section.times == Some(0) {
            faults.add(format!("{key}.times = 0, must be at least 1"));
        }
    }
    if sections.is_empty() {
        faults.add(format!("{axis} has no sections, must have at least one interval"));
    }
}

/// One interval of a lattice along one axis, in millimetres.
struct Interval {
    centre: f64,
    width: f64,
    pattern: f64,
}

/// Number of intervals along one axis, sections repeated.
fn count(sections: &[LatticeSection]) -> usize {
    let intervals = sections.iter().map(|section| section.widths_mm.len().saturating_mul(section.times.unwrap_or(1)));
    intervals.fold(0, usize::saturating_add)
}

/// All intervals along one axis, sections repeated, from `start` on.
///
/// The sum of the widths is compensated (Neumaier 1974), so that decimal widths add up to the
/// decimal cut.
fn intervals(sections: &[LatticeSection], start: f64) -> Vec<Interval> {
    let repeated = sections.iter().flat_map(|section| repeat_n(section, section.times.unwrap_or(1)));
    let entries = repeated.flat_map(|section| section.widths_mm.iter().zip(&section.pattern));
    let (mut at, mut carry) = (start, 0.0);
    let interval = |(&width, &pattern): (&f64, &f64)| {
        let (low, next) = (at + carry, at + width);
        let width_part = next - at;
        carry += (at - (next - width_part)) + (width - width_part);
        at = next;
        Interval { centre: 0.5 * (low + (at + carry)), width, pattern }
    };
    entries.map(interval).collect()
}
