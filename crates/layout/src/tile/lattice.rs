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
use crate::tile::interval::Interval;
use crate::tile::room::Room;
use crate::tile::wave::WaveTable;
use crate::volume::WorkingVolume;

/// Sum of two waves below which it is 0.
const ROUND_OFF: f64 = 1e-12;

/// A film cut along lines parallel to x and y. Each cell holds one tile, unless its pattern is zero
/// along both axes.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct LatticeTable {
    /// First part of the names of its tiles, as in NAME-x2-y1. Default: lattice-1, lattice-2 and so
    /// on, numbered in the order of the file.
    pub(crate) name: Option<String>,
    /// Lower corner, in mm.
    #[schemars(extend("example" = "[-10.0, -10.0, 0.0]"))]
    pub(crate) start_mm: [f64; 3],
    /// Height along z, in mm.
    pub(crate) height_mm: f64,
    /// Magnitude of every tile's polarization, in T. Give either this or component_t.
    strength_t: Option<f64>,
    /// Factor of the pattern, in T: the polarization is this times the pattern. Give either this or
    /// strength_t.
    component_t: Option<f64>,
    /// Relative recoil permeability of its tiles. Default: that of [material].
    recoil_permeability: Option<RecoilPermeability>,
    /// A sinusoidal magnetization in slices, with component_t as its amplitude. Give either this or
    /// x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) wave: Option<WaveTable>,
    /// Intervals along x.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
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
        faults.numbers("start_mm", &self.start_mm[..2], FINITE);
        faults.require(self.height_mm > 0.0, "height_mm", self.height_mm, "must be greater than 0");
        let permeability = self.recoil_permeability.and_then(|written| written.resolve(faults));
        let [columns, rows] = match &self.wave {
            Some(wave) => self.slices(wave, name, room, faults)?,
            None => self.sections(name, room, faults)?,
        };
        if faults.count() > before {
            return None;
        }
        let largest = |of: fn(&Interval) -> f64| {
            let along = |intervals: &[Interval]| intervals.iter().map(|at| of(at).abs()).fold(0.0, f64::max);
            [along(&columns), along(&rows)]
        };
        match self.strength_t {
            Some(strength) => check_material(key, strength, faults),
            None => {
                let ([x, y], [z_of_x, z_of_y]) = (largest(|at| at.pattern), largest(|at| at.upright));
                check_component(factor_t, DVec3::new(x, y, z_of_x + z_of_y).length(), faults);
            }
        }
        if largest(|at| at.pattern) == [0.0; 2] && largest(|at| at.upright) == [0.0; 2] {
            return faults.refuse("has no tiles: pattern is zero everywhere");
        }
        if faults.count() > before {
            return None;
        }
        let z = self.start_mm[2] + 0.5 * self.height_mm;
        let mut tiles = Vec::new();
        for (i, column) in columns.iter().enumerate() {
            for (j, row) in rows.iter().enumerate() {
                let upright = column.upright + row.upright;
                // Opposite waves cancel but for round-off.
                let upright = if upright.abs() < ROUND_OFF { 0.0 } else { upright };
                let pattern = DVec3::new(column.pattern, row.pattern, upright);
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
                    disc: None,
                });
            }
        }
        Some(tiles)
    }

    /// The largest error of the field of a wave in slices where the volume is nearest to it, for a
    /// film without end. `None` without a wave, and for a volume beside the film or in it.
    pub(crate) fn slice_error(&self, volume: &WorkingVolume) -> Option<f64> {
        let (lower, upper) = (self.start_mm[2], self.start_mm[2] + self.height_mm);
        let distance_mm = (lower - volume.upper_mm.z).max(volume.lower_mm.z - upper);
        Some(self.wave.as_ref()?.error_at(distance_mm)).filter(|_| distance_mm > 0.0)
    }

    /// The intervals of a wave along x and y, or `None` after adding faults.
    fn slices(
        &self,
        wave: &WaveTable,
        name: &str,
        room: &mut Room,
        faults: &mut TableFaults,
    ) -> Option<[Vec<Interval>; 2]> {
        let before = faults.count();
        if !self.x.is_empty() || self.y.is_some() {
            faults.add("gives wave and x, must give only one of them");
        }
        if self.strength_t.is_some() {
            faults.add("gives strength_t, and a wave has component_t, its amplitude");
        }
        wave.check(faults);
        if faults.count() > before {
            return None;
        }
        let [columns, rows] = wave.counts();
        let has_room = room.take(columns.saturating_mul(rows), name.len(), cells(columns, rows), faults);
        has_room.then(|| wave.intervals(self.start_mm))
    }

    /// The intervals of sections along x and y, or `None` after adding faults.
    fn sections(&self, name: &str, room: &mut Room, faults: &mut TableFaults) -> Option<[Vec<Interval>; 2]> {
        let before = faults.count();
        check_sections("x", &self.x, faults);
        if let Some(y) = &self.y {
            check_sections("y", y, faults);
        }
        let both = [&self.x, self.y.as_ref().unwrap_or(&self.x)];
        let [columns, rows] = both.map(|sections| count(sections));
        // Every cell counts, so that a lattice with few tiles in many cells takes no time either.
        if faults.count() > before || !room.take(columns.saturating_mul(rows), name.len(), cells(columns, rows), faults)
        {
            return None;
        }
        Some([0, 1].map(|axis| intervals(both[axis], self.start_mm[axis])))
    }
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

fn cells(columns: usize, rows: usize) -> String {
    format!("has {columns} x {rows} cells")
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
        Interval { centre: 0.5 * (low + (at + carry)), width, pattern, upright: 0.0 }
    };
    entries.map(interval).collect()
}
