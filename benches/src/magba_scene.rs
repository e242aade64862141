//! A scene in the types of magba, evaluated by its fastest call.

use std::hint::black_box;

use glam::{DQuat, DVec3};
use magba::fields::cuboid_B_batch;
use magsplice::field::Tile;
use nalgebra::{Point3, Quaternion, UnitQuaternion, Vector3};

/// Tiles and points in the types of magba.
pub struct Magba {
    points: Vec<Point3<f64>>,
    tiles: Vec<MagbaTile>,
}

/// Position, orientation, polarization and size.
type MagbaTile = (Point3<f64>, UnitQuaternion<f64>, Vector3<f64>, Vector3<f64>);

impl Magba {
    /// A scene of `tiles`, evaluated at `points`.
    pub fn new(tiles: &[Tile], points: &[DVec3]) -> Magba {
        let vector = |v: DVec3| Vector3::new(v.x, v.y, v.z);
        let turn = |q: DQuat| UnitQuaternion::new_unchecked(Quaternion::new(q.w, q.x, q.y, q.z));
        let tile =
            |t: &Tile| (vector(t.position()).into(), turn(t.rotation()), vector(t.polarization_t()), vector(t.size()));
        Magba { points: points.iter().map(|p| vector(*p).into()).collect(), tiles: tiles.iter().map(tile).collect() }
    }

    /// Writes B in tesla at every point to `sum`, by the batch call of magba for one tile after the
    /// other.
    pub fn field(&self, sum: &mut [Vector3<f64>]) {
        sum.fill(Vector3::zeros());
        let mut field = vec![Vector3::zeros(); sum.len()];
        for (position, orientation, polarization, size) in &self.tiles {
            cuboid_B_batch(black_box(&self.points), *position, *orientation, *polarization, *size, &mut field);
            sum.iter_mut().zip(&field).for_each(|(total, b)| *total += b);
        }
    }
}
