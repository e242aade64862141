//! Usual errors of tiles, by the way in which a film is made.
//!
//! * By hand: a line drawn on a carrier is followed to a few tenths of a millimetre, three
//!   deviations of 0.15 mm. A tile of 3 mm that is placed so is turned by 1.5 degrees. Magnets from
//!   a shop are specified to 0.1 mm in size, two deviations, and one grade of them spans 6 % of
//!   remanence. Their axis of magnetization is specified to 3 degrees or not at all.
//! * Workshop: tiles placed under a magnifier or against stops, sorted by size and axis, whose
//!   errors are then small beside the others.
//! * Jig: pockets of a milled frame are in place to 0.02 mm, and the play of a tile in its pocket
//!   is as large. It turns a tile of 3 mm by 0.2 degrees. Ground faces keep 0.02 mm. One batch
//!   keeps 1 % of remanence. A frame does not sort magnets by their axis: 1 degree is usual for
//!   one batch.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::tolerance::TileErrors;
use crate::tolerance::distribution::Distribution;

/// Usual errors of a way to make films.
#[derive(Clone, Copy, Debug, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Magnets from a shop, placed along a drawn line.
    ByHand,
    /// Ground magnets of one batch in a milled frame.
    Jig,
    /// Sorted magnets, placed with care against stops.
    Workshop,
}

impl Preset {
    /// All presets, from the largest errors to the smallest.
    pub const ALL: [Preset; 3] = [Preset::ByHand, Preset::Workshop, Preset::Jig];

    /// The name in layout files.
    pub const fn name(self) -> &'static str {
        match self {
            Preset::ByHand => "by-hand",
            Preset::Workshop => "workshop",
            Preset::Jig => "jig",
        }
    }

    /// The errors of each tile: normal, the same along and about each axis, with these standard
    /// deviations:
    ///
    /// | preset | position | rotation | size | strength | direction |
    /// |---|---|---|---|---|---|
    /// | `by-hand` | 0.15 mm | 1.5 deg | 0.05 mm | 3 % | 2 deg |
    /// | `workshop` | 0.05 mm | 0.5 deg | 0 | 1 % | 0 |
    /// | `jig` | 0.02 mm | 0.2 deg | 0.02 mm | 1 % | 1 deg |
    pub fn errors(self) -> TileErrors {
        match self {
            Preset::ByHand => of_deviations(0.15, 1.5, 0.05, 0.03, 2.0),
            Preset::Jig => of_deviations(0.02, 0.2, 0.02, 0.01, 1.0),
            Preset::Workshop => of_deviations(0.05, 0.5, 0.0, 0.01, 0.0),
        }
    }
}

/// Normal errors, the same along and about each axis.
fn of_deviations(position_mm: f64, rotation_deg: f64, size_mm: f64, strength: f64, direction_deg: f64) -> TileErrors {
    let turn = |degrees: f64| Distribution::normal(degrees.to_radians());
    TileErrors {
        position: [position_mm; 3].map(Distribution::normal),
        rotation: [rotation_deg; 3].map(turn),
        size: [size_mm; 3].map(Distribution::normal),
        strength: Distribution::normal(strength),
        direction: [direction_deg; 2].map(turn),
    }
}
