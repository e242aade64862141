//! The places of boards that people build.

use glam::DVec3;

/// A board of several Hall sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Board {
    /// Two sensors, the second one spacing further from the film.
    PairZ,
    /// Two sensors, the second one spacing away along x and along y.
    PairXy,
    /// Five sensors: one in the centre, four at the corners of a square of two spacings.
    Cross,
}

impl Board {
    /// Every board.
    pub const ALL: [Board; 3] = [Board::PairZ, Board::PairXy, Board::Cross];

    /// The name in a layout.
    pub const fn name(self) -> &'static str {
        match self {
            Board::PairZ => "pair-z",
            Board::PairXy => "pair-xy",
            Board::Cross => "cross",
        }
    }

    /// The places of the sensors on the board. The film lies towards +z.
    pub fn places(self, spacing: f64) -> Vec<DVec3> {
        let at = |x: f64, y: f64, z: f64| spacing * DVec3::new(x, y, z);
        match self {
            Board::PairZ => vec![DVec3::ZERO, at(0.0, 0.0, -1.0)],
            Board::PairXy => vec![DVec3::ZERO, at(1.0, 1.0, 0.0)],
            Board::Cross => {
                vec![DVec3::ZERO, at(-1.0, -1.0, 0.0), at(1.0, -1.0, 0.0), at(-1.0, 1.0, 0.0), at(1.0, 1.0, 0.0)]
            }
        }
    }
}
