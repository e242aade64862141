//! Films that are shifted, turned and bent. Tiles follow as rigid bodies.

use std::error::Error;
use std::fmt;

use glam::{DQuat, DVec3};

use crate::bounding_box::BoundingBox;
use crate::height_map::HeightMap;
use crate::iron_planes::IronPlanes;
use crate::tile::{Tile, TileFaults};

/// The shape of a bent film.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Bend {
    /// A cylinder. The middle plane of the film keeps its length.
    Cylinder {
        /// The axis along which the film curves: 0 for x, 1 for y.
        along: usize,
        /// Radius of the middle plane. The ends of the film rise if it is positive, away from a
        /// sensor below.
        radius: f64,
    },
    /// The heights z(x, y) of the middle plane above the middle plane of the flat film. Tiles keep
    /// x and y of their centres, which assumes that squares of slopes are negligible.
    Heights(HeightMap),
}

/// A bend of a film, then a rotation about the centre of its bounding box, then a shift.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deformation {
    /// The shape. `None` for a flat film.
    pub bend: Option<Bend>,
    /// Rotation vector, in radians.
    pub rotation_rad: DVec3,
    /// Shift along x, y, z.
    pub shift: DVec3,
}

/// The reason why a film cannot have this shape.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum DeformationError {
    /// The radius is below half the thickness of the film, or the film would close to a tube.
    Radius {
        /// The smallest radius.
        least: f64,
    },
    /// A tile is outside the grid of heights.
    OutsideHeights {
        /// Its index.
        tile: usize,
    },
    /// A deformed tile is invalid.
    Tile {
        /// Its index.
        tile: usize,
        /// The rules that it breaks.
        faults: TileFaults,
    },
    /// Flat iron does not bend with the film.
    BentIron,
}

impl Deformation {
    /// The tiles of the deformed film.
    ///
    /// # Errors
    /// See [`DeformationError`].
    pub fn apply(&self, tiles: &[Tile]) -> Result<Vec<Tile>, DeformationError> {
        if tiles.is_empty() {
            return Ok(Vec::new());
        }
        let whole = Deformation::whole(tiles);
        if let Some(Bend::Cylinder { along, radius }) = self.bend {
            // Half a turn at most at both ends.
            let least = whole.half_size().z.max(whole.half_size()[along] / std::f64::consts::PI);
            if !(radius.abs() > least && radius.is_finite()) {
                return Err(DeformationError::Radius { least });
            }
        }
        let turn = DQuat::from_scaled_axis(self.rotation_rad);
        let moved = |(tile, of): (usize, &Tile)| {
            let (place, bent) = match &self.bend {
                None => (of.position(), DQuat::IDENTITY),
                Some(bend) => {
                    bend.placed(of.position(), whole.centre()).ok_or(DeformationError::OutsideHeights { tile })?
                }
            };
            let place = whole.centre() + turn * (place - whole.centre()) + self.shift;
            Tile::new(place, of.size(), of.polarization_t())
                .and_then(|new| new.rotated((turn * bent * of.rotation()).normalize()))
                .map_err(|faults| DeformationError::Tile { tile, faults })
        };
        tiles.iter().enumerate().map(moved).collect()
    }

    /// Flat iron that moves with a film of these tiles.
    ///
    /// # Errors
    /// [`DeformationError::BentIron`] if the film bends.
    pub fn apply_to_iron(&self, iron: &IronPlanes, tiles: &[Tile]) -> Result<IronPlanes, DeformationError> {
        if iron.is_empty() || tiles.is_empty() {
            return Ok(iron.clone());
        } else if self.bend.is_some() {
            return Err(DeformationError::BentIron);
        }
        let (centre, turn) = (Deformation::whole(tiles).centre(), DQuat::from_scaled_axis(self.rotation_rad));
        Ok(iron.after(|point| centre + turn * (point - centre) + self.shift, |direction| turn * direction))
    }

    /// The box around the boxes of all tiles.
    fn whole(tiles: &[Tile]) -> BoundingBox {
        let boxes = tiles.iter().map(BoundingBox::from_tile);
        let corners: Vec<DVec3> =
            boxes.flat_map(|of| [of.centre() - of.half_size(), of.centre() + of.half_size()]).collect();
        BoundingBox::from_points(&corners)
    }
}

impl Bend {
    /// The new position of a point of the flat film, and the rotation of its surroundings. `None`
    /// outside the grid of heights.
    fn placed(&self, point: DVec3, centre: DVec3) -> Option<(DVec3, DQuat)> {
        let from = point - centre;
        match self {
            Bend::Cylinder { along, radius } => {
                let (sin, cos) = (from[*along] / radius).sin_cos();
                let mut place = point;
                place[*along] = centre[*along] + (radius - from.z) * sin;
                place.z = centre.z + radius - (radius - from.z) * cos;
                // Along a rising film x turns towards z about -y, y towards z about x.
                let axis = if *along == 0 { -DVec3::Y } else { DVec3::X };
                Some((place, DQuat::from_axis_angle(axis, from[*along] / radius)))
            }
            Bend::Heights(heights) => {
                let (height, [by_x, by_y]) = heights.at(point.x, point.y)?;
                let normal = DVec3::new(-by_x, -by_y, 1.0).normalize();
                let turn = DQuat::from_rotation_arc(DVec3::Z, normal);
                let middle = DVec3::new(point.x, point.y, centre.z + height);
                Some((middle + from.z * normal, turn))
            }
        }
    }
}

impl fmt::Display for DeformationError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            DeformationError::BentIron => {
                f.write_str("flat iron does not bend with the film: leave out the planes of iron or the bend")
            }
            DeformationError::Radius { least } => {
                write!(f, "the radius must be above {least}: the film is too thick or too long for it")
            }
            DeformationError::OutsideHeights { tile } => {
                write!(f, "the centre of tile number {} is beyond the heights", tile + 1)
            }
            DeformationError::Tile { tile, faults } => write!(f, "tile number {}: {faults}", tile + 1),
        }
    }
}

impl Error for DeformationError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::iron_plane::IronPlane;

    fn tile(position: DVec3) -> Tile {
        Tile::new(position, DVec3::new(2.0, 1.0, 1.0), DVec3::new(0.1, 0.02, -0.05)).unwrap()
    }

    fn row() -> Vec<Tile> {
        [-8.0, -3.0, 0.0, 3.0, 8.0].map(|x| tile(DVec3::new(x, 0.5 * x, 0.5))).into()
    }

    #[test]
    fn film_moves_as_a_rigid_body() {
        let deformation =
            Deformation { bend: None, rotation_rad: DVec3::new(0.1, -0.2, 0.3), shift: DVec3::new(1.0, 2.0, -3.0) };
        let (before, after) = (row(), deformation.apply(&row()).unwrap());
        let turn = DQuat::from_scaled_axis(DVec3::new(0.1, -0.2, 0.3));
        for (one, other) in before.iter().zip(&after) {
            assert!((other.scene_polarization_t() - turn * one.scene_polarization_t()).length() < 1e-15);
            let from = turn * (one.position() - before[2].position());
            assert!((other.position() - after[2].position() - from).length() < 1e-14);
        }
        // The middle tile is at the centre of the box.
        assert!((after[2].position() - before[2].position() - deformation.shift).length() < 1e-14);
    }

    /// The image of a moved tile in iron that moves with it is the moved image.
    #[test]
    fn iron_moves_with_the_film() {
        let plane = IronPlane::new(DVec3::new(0.0, 0.0, 1.5), -DVec3::Z, 3.0).unwrap();
        let iron = IronPlanes::new(vec![plane]).unwrap();
        let rigid =
            Deformation { bend: None, rotation_rad: DVec3::new(0.1, -0.2, 0.3), shift: DVec3::new(1.0, 2.0, -3.0) };
        let moved = rigid.apply_to_iron(&iron, &row()).unwrap();
        let images = moved.images(&rigid.apply(&row()).unwrap()).unwrap().tiles;
        let known = rigid.apply(&[row(), iron.images(&row()).unwrap().tiles].concat()).unwrap();
        let offset = images[2].position() - known[7].position();
        for (image, known) in images.iter().zip(&known[5..]) {
            assert!((image.scene_polarization_t() - known.scene_polarization_t()).length() < 1e-15);
            // Their boxes have other centres, about which they turn.
            assert!((image.position() - known.position() - offset).length() < 1e-14);
        }
        let bent = Deformation { bend: Some(Bend::Cylinder { along: 0, radius: 20.0 }), ..Deformation::default() };
        assert_eq!(bent.apply_to_iron(&iron, &row()), Err(DeformationError::BentIron));
        assert_eq!(bent.apply_to_iron(&IronPlanes::default(), &row()), Ok(IronPlanes::default()));
    }

    /// A film on a cylinder: centres are on it, tiles are tangent to it, and arcs are as long as
    /// the film.
    #[test]
    fn film_lies_on_a_cylinder() {
        for (along, radius) in [(0, 20.0), (1, 20.0), (0, -15.0)] {
            let deformation = Deformation { bend: Some(Bend::Cylinder { along, radius }), ..Deformation::default() };
            let (before, after) = (row(), deformation.apply(&row()).unwrap());
            let axis = DVec3::new(0.0, 0.0, 0.5 + radius);
            for (one, other) in before.iter().zip(&after) {
                let mut from = other.position() - axis;
                from[1 - along] = 0.0;
                assert!((from.length() - radius.abs()).abs() < 1e-13);
                let angle = one.position()[along] / radius;
                assert!((from[along] - radius * angle.sin()).abs() < 1e-13);
                // The upper side looks at the axis if the ends rise.
                let upwards = other.rotation() * DVec3::Z;
                assert!((upwards + from / radius).length() < 1e-13, "{upwards}");
                let mut tangent = DVec3::ZERO;
                tangent[along] = angle.cos();
                tangent.z = angle.sin();
                assert!((other.rotation() * DVec3::AXES[along] - tangent).length() < 1e-13);
            }
        }
        let thick = Deformation { bend: Some(Bend::Cylinder { along: 0, radius: 0.4 }), ..Deformation::default() };
        assert!(matches!(thick.apply(&row()), Err(DeformationError::Radius { .. })));
    }

    /// Heights x^2 / (2 R) are a cylinder to the second order: within x^3 / R^2 here.
    #[test]
    fn heights_are_a_cylinder_for_small_slopes() {
        let at: Vec<f64> = (-20..=20).map(|n| 0.5 * f64::from(n)).collect();
        let heights: Vec<f64> = at.iter().flat_map(|x| at.iter().map(move |_| x * x / 2000.0)).collect();
        let map = HeightMap::new(at.clone(), at, heights).unwrap();
        let by_heights = Deformation { bend: Some(Bend::Heights(map)), ..Deformation::default() };
        let cylinder = Bend::Cylinder { along: 0, radius: 1000.0 };
        let by_radius = Deformation { bend: Some(cylinder), ..Deformation::default() };
        for (one, other) in by_heights.apply(&row()).unwrap().iter().zip(by_radius.apply(&row()).unwrap()) {
            assert!((one.position() - other.position()).length() < 5.2e-4, "{}", one.position());
            assert!(one.rotation().angle_between(other.rotation()) < 1e-6);
        }
        let far = [tile(DVec3::new(12.0, 0.0, 0.5))];
        assert_eq!(by_heights.apply(&far), Err(DeformationError::OutsideHeights { tile: 0 }));
    }
}
