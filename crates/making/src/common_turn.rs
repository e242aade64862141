//! A turn that all measured tiles of a part have in common.

use std::fmt;

use glam::DVec3;

use crate::assignment::PlaceGroup;

/// Least number of tiles that agree by more than chance.
const LEAST_TILES: usize = 4;

/// Least turn, in degrees: a batch of magnets may be magnetized some degrees off.
const LEAST_DEG: f64 = 5.0;

/// Least turn over the scatter of the tiles.
const OVER_SCATTER: f64 = 3.0;

/// A turn of the polarization of all tiles of a part: the frame or the unit of the measurement is
/// another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonTurn {
    /// Sides of the part.
    pub size_mm: DVec3,
    /// Number of its tiles.
    pub tiles: usize,
    /// Angle between the mean polarization and the ordered one.
    pub angle_deg: f64,
    /// Root mean square angle between each polarization and the mean.
    pub scatter_deg: f64,
}

impl CommonTurn {
    /// The common turn of the tiles of a part. `None` where they have none beyond their scatter.
    pub fn of(group: &PlaceGroup) -> Option<CommonTurn> {
        let directions = group.tiles.iter().filter_map(|tile| tile.polarization_t.try_normalize());
        let directions: Vec<DVec3> = directions.collect();
        let (mean, ordered) =
            (directions.iter().sum::<DVec3>().try_normalize()?, group.polarization_t.try_normalize()?);
        let angle_deg = |one: DVec3, other: DVec3| one.angle_between(other).to_degrees();
        let squares: f64 = directions.iter().map(|direction| angle_deg(*direction, mean).powi(2)).sum();
        let turn = CommonTurn {
            size_mm: group.size_mm,
            tiles: directions.len(),
            angle_deg: angle_deg(mean, ordered),
            scatter_deg: (squares / directions.len() as f64).sqrt(),
        };
        let is_large = turn.angle_deg > LEAST_DEG.max(OVER_SCATTER * turn.scatter_deg);
        (turn.tiles >= LEAST_TILES && is_large).then_some(turn)
    }
}

impl fmt::Display for CommonTurn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let CommonTurn { size_mm: DVec3 { x, y, z }, tiles, angle_deg, scatter_deg } = self;
        write!(
            f,
            "J of the {tiles} tiles of {x} x {y} x {z} mm is {angle_deg:.1} deg from the ordered direction and scatters by \
             {scatter_deg:.1} deg: the axes of the measurement are turned against the sides of the tiles, or the angles \
             have another unit"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assignment::CutTile;

    fn group(degrees: &[f64]) -> PlaceGroup {
        let tile = |angle: &f64| CutTile {
            name: String::new(),
            polarization_t: 0.12 * DVec3::new(angle.to_radians().cos(), angle.to_radians().sin(), 0.0),
            size_mm: DVec3::ONE,
        };
        let tiles = degrees.iter().map(tile).collect();
        PlaceGroup { size_mm: DVec3::ONE, polarization_t: 0.12 * DVec3::X, places: Vec::new(), tiles }
    }

    #[test]
    fn tiles_that_agree_have_a_common_turn() {
        let found = CommonTurn::of(&group(&[28.0, 30.0, 32.0, 30.0])).expect("a turn");
        assert!(
            (found.angle_deg - 30.0).abs() < 1e-9 && (found.scatter_deg - 2.0_f64.sqrt()).abs() < 1e-3,
            "{found:?}"
        );
        assert!(found.to_string().starts_with("J of the 4 tiles of 1 x 1 x 1 mm is 30.0 deg from the ordered"));
        // Few tiles, a small turn, and a turn within the scatter.
        for none in [&[30.0; 3][..], &[4.0; 9], &[20.0, -8.0, 14.0, 2.0]] {
            assert_eq!(CommonTurn::of(&group(none)), None);
        }
    }
}
