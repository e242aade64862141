//! Usual errors of tiles, by the way in which a film is made.
//!
//! | preset | position | rotation | size | strength | direction |
//! |---|---|---|---|---|---|
//! | `by-hand` | 0.15 mm | 1.5 deg | 0.05 mm | 3 % | 2 deg |
//! | `workshop` | 0.05 mm | 0.5 deg | 0 | 1 % | 0 |
//! | `jig` | 0.02 mm | 0.2 deg | 0.02 mm | 1 % | 1 deg |
//!
//! All are standard deviations of normal errors, the same along and about each axis.
//!
//! * By hand: a line drawn on a carrier is followed to a few tenths of a millimetre, three
//!   deviations of 0.15 mm. A tile of 3 mm that is laid so is turned by 1.5 degrees. Magnets from a
//!   shop are specified to 0.1 mm in size, two deviations, and one grade of them spans 6 % of
//!   remanence. Their axis of magnetization is specified to 3 degrees or not at all.
//! * Workshop: tiles laid under a magnifier or against stops, sorted by size and axis, whose errors
//!   are then small beside the others.
//! * Jig: pockets of a milled frame are in place to 0.02 mm, and the play of a tile in its pocket
//!   is as large. It turns a tile of 3 mm by 0.2 degrees. Ground faces keep 0.02 mm. One batch
//!   keeps 1 % of remanence. A frame does not sort magnets by their axis: 1 degree is that of one
//!   batch.

use crate::distribution::Distribution;
use crate::tolerance::TileErrors;

impl TileErrors {
    /// The errors of tiles that were cut and laid with care: normal errors of 0.05 mm in position
    /// along each axis, 0.5 degrees about each axis, and 1 % in strength.
    pub fn workshop() -> TileErrors {
        of_deviations(0.05, 0.5, 0.0, 0.01, 0.0)
    }

    /// The errors of magnets from a shop that were laid by hand: normal errors of 0.15 mm in
    /// position, 1.5 degrees about each axis, 0.05 mm in size, 3 % in strength, and 2 degrees in
    /// the direction of J.
    pub fn by_hand() -> TileErrors {
        of_deviations(0.15, 1.5, 0.05, 0.03, 2.0)
    }

    /// The errors of ground magnets of one batch in a milled frame: normal errors of 0.02 mm in
    /// position, 0.2 degrees about each axis, 0.02 mm in size, 1 % in strength, and 1 degree in the
    /// direction of J.
    pub fn jig() -> TileErrors {
        of_deviations(0.02, 0.2, 0.02, 0.01, 1.0)
    }
}

/// Normal errors, the same along and about each axis.
fn of_deviations(position_mm: f64, rotation_deg: f64, size_mm: f64, strength: f64, direction_deg: f64) -> TileErrors {
    let turn = |degrees: f64| Distribution::normal(degrees.to_radians());
    TileErrors {
        position_mm: [position_mm; 3].map(Distribution::normal),
        rotation_rad: [rotation_deg; 3].map(turn),
        size_mm: [size_mm; 3].map(Distribution::normal),
        strength: Distribution::normal(strength),
        direction_rad: [direction_deg; 2].map(turn),
    }
}
