//! The places of boards that people build.

use glam::DVec3;

/// Distance of the outer sensors of the board of ReSkin from its centre, along x and along y, in
/// millimetres.
const RESKIN_MM: f64 = 7.594;

/// A board of several Hall sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema), schemars(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Board {
    /// Two sensors, the second one spacing further from the film.
    PairZ,
    /// Two sensors, the second one spacing away along x and along y.
    PairXy,
    /// Five sensors: one in the centre, four at the corners of a square of two spacings.
    Cross,
    /// The five sensors of the boards of ReSkin, AnySkin and eFlesh, a cross with a spacing of
    /// 7.594 mm (R. Bhirangi et al., Conference on Robot Learning 2021).
    Reskin,
}

impl Board {
    /// Every board.
    pub const ALL: [Board; 4] = [Board::PairZ, Board::PairXy, Board::Cross, Board::Reskin];

    /// The name in a layout.
    pub const fn name(self) -> &'static str {
        match self {
            Board::PairZ => "pair-z",
            Board::PairXy => "pair-xy",
            Board::Cross => "cross",
            Board::Reskin => "reskin",
        }
    }

    /// The spacing in millimetres of a board that exists. `None` for boards of any spacing.
    pub const fn own_spacing_mm(self) -> Option<f64> {
        match self {
            Board::Reskin => Some(RESKIN_MM),
            Board::PairZ | Board::PairXy | Board::Cross => None,
        }
    }

    /// The places of the sensors on the board. The film lies towards +z.
    pub fn places(self, spacing: f64) -> Vec<DVec3> {
        let at = |x: f64, y: f64, z: f64| spacing * DVec3::new(x, y, z);
        match self {
            Board::PairZ => vec![DVec3::ZERO, at(0.0, 0.0, -1.0)],
            Board::PairXy => vec![DVec3::ZERO, at(1.0, 1.0, 0.0)],
            Board::Cross | Board::Reskin => {
                vec![DVec3::ZERO, at(-1.0, -1.0, 0.0), at(1.0, -1.0, 0.0), at(-1.0, 1.0, 0.0), at(1.0, 1.0, 0.0)]
            }
        }
    }
}
