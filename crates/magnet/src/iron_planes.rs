//! The iron around tiles, and the images of tiles between its planes.

use std::f64::consts::PI;

use glam::DVec3;
use thiserror::Error;

use crate::bounding_box::BoundingBox;
use crate::iron_plane::IronPlane;
use crate::reflection::Reflection;
use crate::tile::{Tile, TileFaults};
use crate::tolerances::{OVERLAP_ROUNDINGS, UNIT_ROUNDOFF};

/// Sine of the angle between two planes up to which they count as parallel: round-off of normals
/// that were converted from angles.
const PARALLEL: f64 = 64.0 * UNIT_ROUNDOFF;

/// Flux density of all omitted images that ends the series of two planes, in tesla: a hundredth of
/// a microtesla, of which a Hall sensor resolves some tenths.
const NEGLIGIBLE_T: f64 = 1e-8;

/// Largest number of successive reflections: 256 images of each tile. The largest error that then
/// remains is part of the result.
const MOST_REFLECTIONS: u32 = 128;

/// The iron around a scene: no plane, one, or two that face each other.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct IronPlanes {
    planes: Vec<IronPlane>,
    /// Depth by which tiles may reach into the iron.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "is_zero"))]
    allowed_depth: f64,
}

#[cfg(feature = "serde")]
fn is_zero(depth: &f64) -> bool {
    *depth == 0.0
}

/// A rule that planes of iron break together, by their indices. Messages count planes from 1.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum IronPlanesFault {
    /// Images in planes at other angles have images behind both, in a series without end.
    #[error(
        "planes {} and {} are not parallel, must be: the images of tiles in planes at an angle are no field of the space \
         between them, except at some angles", .0 + 1, .1 + 1
    )]
    NotParallel(usize, usize),
    /// One plane is behind the other.
    #[error("plane {} is behind plane {} and has no effect there: leave it out", .1 + 1, .0 + 1)]
    Behind(usize, usize),
    /// No space remains between two planes.
    #[error("no space remains between planes {} and {}", .0 + 1, .1 + 1)]
    NoSpace(usize, usize),
}

/// A tile that is not before all planes.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("tile {tile} reaches {depth} into the iron of plane {}, must be before it", plane + 1)]
pub struct TileBehindPlane {
    /// Index of the tile.
    pub tile: usize,
    /// Index of the plane.
    pub plane: usize,
    /// How far it reaches into the iron; infinite where its image is out of the range of tiles.
    pub depth: f64,
}

/// The images of tiles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileImages {
    /// The images.
    pub tiles: Vec<Tile>,
    /// The index of the tile of each image.
    pub owners: Vec<usize>,
    /// Largest flux density of the images that are left out, at any point before the planes; 0 with
    /// one plane.
    pub truncation_error_t: f64,
}

impl IronPlanes {
    /// Checks planes against each other.
    ///
    /// # Errors
    /// The first broken rule.
    pub fn new(planes: Vec<IronPlane>) -> Result<IronPlanes, IronPlanesFault> {
        for (second, other) in planes.iter().enumerate() {
            for (first, one) in planes[..second].iter().enumerate() {
                if one.normal().cross(other.normal()).length() > PARALLEL {
                    return Err(IronPlanesFault::NotParallel(first, second));
                }
                if one.normal().dot(other.normal()) > 0.0 {
                    let is_behind = other.distance(one.point()) >= 0.0;
                    let (before, behind) = if is_behind { (first, second) } else { (second, first) };
                    return Err(IronPlanesFault::Behind(before, behind));
                }
                if !(one.distance(other.point()) > 0.0) {
                    return Err(IronPlanesFault::NoSpace(first, second));
                }
            }
        }
        Ok(IronPlanes { planes, allowed_depth: 0.0 })
    }

    /// Whether there is no iron.
    pub fn is_empty(&self) -> bool {
        self.planes.is_empty()
    }

    /// The planes.
    pub fn planes(&self) -> &[IronPlane] {
        &self.planes
    }

    /// The same planes after a rigid motion. `placed` moves points, `turned` turns directions.
    pub fn after(&self, placed: impl Fn(DVec3) -> DVec3, turned: impl Fn(DVec3) -> DVec3) -> IronPlanes {
        let planes = self.planes.iter().map(|plane| plane.after(&placed, &turned)).collect();
        IronPlanes { planes, ..*self }
    }

    /// The same planes, into which tiles may reach by a depth, as tiles with errors on a plate do.
    #[must_use]
    pub fn with_allowed_depth(self, allowed_depth: f64) -> IronPlanes {
        IronPlanes { allowed_depth, ..self }
    }

    /// How far tiles reach into the iron, 0 if they do not.
    pub fn depth_of<'t>(&self, tiles: impl IntoIterator<Item = &'t Tile>) -> f64 {
        let corners = tiles.into_iter().flat_map(Tile::corners_mm);
        let depth = |corner: DVec3| self.planes.iter().map(move |plane| -plane.distance(corner)).fold(0.0, f64::max);
        corners.map(depth).fold(0.0, f64::max)
    }

    /// The plane that a point is on or behind.
    pub fn plane_before(&self, point: DVec3) -> Option<usize> {
        // NaN is behind no plane: it has its own error.
        self.planes.iter().position(|plane| plane.distance(point) <= 0.0)
    }

    /// Checks that tiles are before all planes, up to round-off and the allowed depth.
    ///
    /// # Errors
    /// The first tile that is not.
    pub fn check(&self, tiles: &[Tile]) -> Result<(), TileBehindPlane> {
        for (number, plane) in self.planes.iter().enumerate() {
            for (index, tile) in tiles.iter().enumerate() {
                let corners = tile.corners_mm();
                let largest = corners.iter().fold(plane.point().abs(), |largest, corner| largest.max(corner.abs()));
                let round_off = OVERLAP_ROUNDINGS * UNIT_ROUNDOFF * largest.element_sum();
                let depth = corners.map(|corner| -plane.distance(corner)).into_iter().fold(f64::NEG_INFINITY, f64::max);
                if depth > round_off.max(self.allowed_depth) {
                    return Err(TileBehindPlane { tile: index, plane: number, depth });
                }
            }
        }
        Ok(())
    }

    /// Number of reflections of the images of tiles, and the largest flux density of all others,
    /// which is to be at most `negligible_t`.
    fn series(&self, tiles: &[Tile], negligible_t: f64) -> (u32, f64) {
        let (one, other) = match &self.planes[..] {
            [] => return (0, 0.0),
            [_] => return (1, 0.0),
            [one, other, ..] => (one, other),
        };
        let omitted = OmittedImages::new(one, other, tiles);
        let is_enough = |reflections: &u32| omitted.bound_t(*reflections) <= negligible_t;
        let reflections = (2..MOST_REFLECTIONS).find(is_enough).unwrap_or(MOST_REFLECTIONS);
        (reflections, omitted.bound_t(reflections))
    }

    /// [`TileImages::truncation_error_t`], without making the images.
    pub fn truncation_error_t(&self, tiles: &[Tile]) -> f64 {
        self.series(tiles, NEGLIGIBLE_T).1
    }

    /// The reflections that make the images of tiles, in the order of [`IronPlanes::images`].
    pub fn reflections(&self, tiles: &[Tile]) -> Vec<Reflection> {
        self.successive(tiles, NEGLIGIBLE_T, Reflection::NONE, |last, plane| Some(last.then(plane)))
    }

    /// The images of tiles, whose field adds to theirs. Images in two planes have images again; the
    /// series ends where the omitted images have less than 1e-8 T, or after 128 reflections.
    ///
    /// # Errors
    /// As [`IronPlanes::check`].
    pub fn images(&self, tiles: &[Tile]) -> Result<TileImages, TileBehindPlane> {
        self.check(tiles)?;
        let truncation_error_t = self.truncation_error_t(tiles);
        // The only fault left: an image that is out of the range of tiles.
        let out_of_range = |_| TileBehindPlane { tile: 0, plane: 0, depth: f64::INFINITY };
        let reflected = self.reflected(tiles).map_err(out_of_range)?;
        let owners = (0..reflected.len()).map(|image| image % tiles.len()).collect();
        Ok(TileImages { tiles: reflected, owners, truncation_error_t })
    }

    /// The images of tiles that may reach into the iron, such as tiles with errors on a back plate,
    /// in the order of [`IronPlanes::reflections`].
    ///
    /// # Errors
    /// The faults of an image that is out of the range of tiles.
    pub fn reflected(&self, tiles: &[Tile]) -> Result<Vec<Tile>, TileFaults> {
        Ok(self.reflected_beyond(tiles, NEGLIGIBLE_T)?.into_iter().flat_map(|(_, images)| images).collect())
    }

    /// The images of tiles by each reflection, except those with a flux density of at most
    /// `negligible_t` together, and those of more than 128 reflections.
    ///
    /// # Errors
    /// As [`IronPlanes::reflected`].
    pub fn reflected_beyond(
        &self,
        tiles: &[Tile],
        negligible_t: f64,
    ) -> Result<Vec<(Reflection, Vec<Tile>)>, TileFaults> {
        let none = Ok((Reflection::NONE, tiles.to_vec()));
        let images = self.successive(tiles, negligible_t, none, |last, plane| {
            let (reflection, tiles) = last.as_ref().ok()?;
            let images = tiles.iter().map(|tile| plane.image(tile)).collect::<Result<_, _>>();
            Some(images.map(|images| (reflection.then(plane), images)))
        });
        images.into_iter().collect()
    }

    /// What successive planes make of `none`, begun by each plane in turn. The series ends where
    /// the images of tiles are negligible, and at `None`.
    fn successive<T: Clone>(
        &self,
        tiles: &[Tile],
        negligible_t: f64,
        none: T,
        next: impl Fn(&T, &IronPlane) -> Option<T>,
    ) -> Vec<T> {
        let (most, _) = self.series(tiles, negligible_t);
        let from = |first: usize| {
            let planes = self.planes.iter().cycle().skip(first).take(most as usize);
            planes.scan(none.clone(), |last, plane| {
                *last = next(last, plane)?;
                (plane.image_factor() != 0.0).then(|| last.clone())
            })
        };
        (0..self.planes.len()).flat_map(from).collect()
    }
}

/// The images between two planes that a series leaves out.
struct OmittedImages {
    /// Distance of the planes.
    gap: f64,
    factors: [f64; 2],
    /// Sum of |J| V over all tiles, and magnitude of their sum.
    moments: [f64; 2],
    /// Largest distance of a point of a tile from the centre of all.
    reach: f64,
}

impl OmittedImages {
    fn new(one: &IronPlane, other: &IronPlane, tiles: &[Tile]) -> OmittedImages {
        let moment = |tile: &Tile| tile.scene_polarization_t() * tile.size().element_product();
        let sum: DVec3 = tiles.iter().map(moment).sum();
        OmittedImages {
            gap: one.distance(other.point()),
            factors: [one, other].map(IronPlane::image_factor),
            moments: [tiles.iter().map(|tile| moment(tile).length()).sum(), sum.length()],
            reach: if tiles.is_empty() { 0.0 } else { BoundingBox::from_tiles(tiles).half_size().length() },
        }
    }

    /// Upper bound of the flux density of all images after more than so many reflections, at least
    /// 2, anywhere between the planes.
    ///
    /// Images after k reflections are (k - 1) gaps or more from every point between the planes. At
    /// a distance r their field is at most that of their dipole at the centre of the film, |sum of
    /// J V| / (2 pi r^3), and the change of the fields of dipoles that are displaced by the reach
    /// of the film, sum of |J| V 3 reach / (2 pi r^4). Sums over k are below integrals, and below
    /// geometric series.
    fn bound_t(&self, reflections: u32) -> f64 {
        let k = f64::from(reflections);
        let [a, b] = self.factors;
        let pair = a * b;
        let next = reflections + 1;
        // The largest of both series, with an even or odd number of reflections.
        let factor = pair.powi((next / 2) as i32) * if next % 2 == 1 { a.max(b) } else { 1.0 };
        let sum = |power: i32| {
            let of_integral = 1.0 / k.powi(power) + k.powi(1 - power) / f64::from(power - 1);
            let of_series = 2.0 / (1.0 - pair) / k.powi(power);
            of_integral.min(of_series)
        };
        let [each, all] = self.moments;
        let dipoles = all * sum(3) / self.gap.powi(3);
        let others = 3.0 * each * self.reach * sum(4) / self.gap.powi(4);
        // Two series, each begun by one of the planes.
        2.0 * factor * (dipoles + others) / (2.0 * PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::iron_plane::IronPlaneFault;

    fn plane(z: f64, up: f64, mu_r: f64) -> IronPlane {
        IronPlane::new(DVec3::new(0.0, 0.0, z), DVec3::new(0.0, 0.0, up), mu_r).unwrap()
    }

    fn tile() -> Tile {
        Tile::new(DVec3::new(1.0, 2.0, 0.5), DVec3::new(3.0, 2.0, 1.0), DVec3::new(0.1, 0.2, 0.3)).unwrap()
    }

    #[test]
    fn images_are_mirrored_and_weakened() {
        let above = IronPlanes::new(vec![plane(2.0, -1.0, 3.0)]).unwrap();
        let images = above.images(&[tile()]).unwrap();
        let expected = Tile::new(DVec3::new(1.0, 2.0, 3.5), tile().size(), DVec3::new(-0.05, -0.1, 0.15)).unwrap();
        assert_eq!((images.tiles, images.owners, images.truncation_error_t), (vec![expected], vec![0], 0.0));
        let air = IronPlanes::new(vec![plane(2.0, -1.0, 1.0)]).unwrap();
        assert_eq!(air.images(&[tile()]).unwrap(), TileImages::default());
    }

    /// An oblique plane mirrors every corner onto a corner, and J as a reversed polar vector.
    #[test]
    fn oblique_planes_mirror_corners() {
        let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 0.7);
        let tile = tile().rotated(turn).unwrap();
        for normal in [DVec3::new(0.3, -0.2, -1.0), DVec3::new(-5.0, 0.1, 0.2), turn * DVec3::Y, -(turn * DVec3::Z)] {
            let plane = IronPlane::new(-4.0 * normal.normalize(), normal, f64::INFINITY).unwrap();
            let image = plane.image(&tile).unwrap();
            let mirrored = |point: DVec3| point - 2.0 * plane.distance(point) * plane.normal();
            for corner in tile.corners_mm() {
                let found = image.corners_mm().into_iter().map(|other| (other - mirrored(corner)).length());
                assert!(found.fold(f64::INFINITY, f64::min) < 1e-14, "{normal}");
            }
            let j_t = tile.scene_polarization_t();
            let expected_t = -(j_t - 2.0 * j_t.dot(plane.normal()) * plane.normal());
            assert!((image.scene_polarization_t() - expected_t).length() < 1e-15, "{normal}");
        }
    }

    #[test]
    fn planes_move_as_rigid_bodies() {
        let turn = glam::DQuat::from_rotation_x(0.3);
        let moved = |point: DVec3| DVec3::new(1.0, 0.0, 2.0) + turn * point;
        let planes = IronPlanes::new(vec![plane(2.0, -1.0, 3.0), plane(-1.0, 1.0, 9.0)]).unwrap();
        let after = planes.after(moved, |direction| turn * direction);
        let image = |planes: &IronPlanes, tile: &Tile| planes.planes()[0].image(tile).unwrap().position();
        let tile_after = Tile::new(moved(tile().position()), tile().size(), DVec3::Z).unwrap();
        assert!(image(&after, &tile_after).distance(moved(image(&planes, &tile()))) < 1e-14);
        assert_eq!(IronPlanes::new(after.planes().to_vec()), Ok(after));
    }

    #[test]
    fn planes_that_have_no_series_of_images_are_refused() {
        let tilted = IronPlane::new(DVec3::ZERO, DVec3::new(0.0, 1e-6, 1.0), 100.0).unwrap();
        let below = plane(-1.0, 1.0, 100.0);
        assert_eq!(IronPlanes::new(vec![below, tilted]), Err(IronPlanesFault::NotParallel(0, 1)));
        assert_eq!(IronPlanes::new(vec![below, plane(-2.0, 1.0, 9.0)]), Err(IronPlanesFault::Behind(0, 1)));
        assert_eq!(IronPlanes::new(vec![below, plane(0.0, 1.0, 9.0)]), Err(IronPlanesFault::Behind(1, 0)));
        assert_eq!(IronPlanes::new(vec![below, plane(-1.0, -1.0, 9.0)]), Err(IronPlanesFault::NoSpace(0, 1)));
        let planes = IronPlanes::new(vec![below, plane(0.8, -1.0, 9.0)]).unwrap();
        let behind = planes.images(&[tile()]).unwrap_err();
        assert!((behind.tile, behind.plane) == (0, 1) && (behind.depth - 0.2).abs() < 1e-15);
        assert_eq!(
            [-2.0, -1.0, 0.0, 0.9].map(|z| planes.plane_before(DVec3::new(9.0, 0.0, z))),
            [Some(0), Some(0), None, Some(1)]
        );
        let fault = |point: DVec3, normal, mu_r| IronPlane::new(point, normal, mu_r).unwrap_err();
        assert_eq!(fault(DVec3::NAN, DVec3::Z, 2.0), IronPlaneFault::Point);
        assert_eq!(fault(DVec3::ZERO, DVec3::ZERO, 2.0), IronPlaneFault::Normal);
        assert_eq!(fault(DVec3::ZERO, DVec3::Z, 0.9), IronPlaneFault::Permeability(0.9));
    }
}
