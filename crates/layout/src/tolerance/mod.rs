//! The differences of a film as made from its layout: errors of tiles, of groups of tiles, and of
//! the surroundings.

use std::collections::HashMap;

use glam::DVec3;
use magsplice_magnet::{IronPlane, IronPlaneFault, PerTileError, Tile};

pub use self::distribution::Distribution;
pub use self::presets::Preset;
pub(crate) use self::table::WholeLayout;
use crate::rotation::Rotation;

/// Errors that all tiles share, of the surroundings and of the sensor.
mod common;
/// Distributions of errors.
mod distribution;
/// Groups of tiles.
mod groups;
/// Flat iron near the film.
mod iron;
/// Another film nearby.
mod neighbour;
/// Usual errors of tiles.
mod presets;
/// Tiles by names and kinds.
mod selection;
/// The table as written.
pub(crate) mod table;
/// Measured errors in files and in the layout.
mod tabulated;
/// Errors of tiles in any table.
mod tile_errors;
/// Distributions as written.
mod written;

/// The errors of films as made. The default is none.
///
/// # Units
/// Lengths in millimetres, angles in radians, flux densities in tesla; strengths and gains are
/// fractions.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmTolerance {
    /// The errors of each tile, independent of the other tiles. Empty, or one for each tile.
    pub tiles: Vec<TileErrors>,
    /// Groups of tiles that move or change together.
    pub groups: Vec<ErrorGroup>,
    /// Errors that all tiles share, and errors of the surroundings and of the sensor.
    pub common: CommonErrors,
    /// Number of samples of films to evaluate. Default: 1000.
    pub samples: u64,
    /// Seed of the random numbers. Default: 1.
    pub seed: u64,
}

impl Default for FilmTolerance {
    fn default() -> FilmTolerance {
        // The 95th percentile of 1000 samples has a standard error of 0.7 per cent of the films.
        FilmTolerance { tiles: Vec::new(), groups: Vec::new(), common: CommonErrors::default(), samples: 1000, seed: 1 }
    }
}

impl FilmTolerance {
    /// Leaves out the errors of tiles that are left out of the layout, and groups without a tile.
    /// `is_kept` is whether the tile with an index stays.
    pub fn retain_tiles(&mut self, is_kept: impl Fn(usize) -> bool) {
        let mut index = 0;
        self.tiles.retain(|_| {
            index += 1;
            is_kept(index - 1)
        });
        let count = self.groups.iter().flat_map(|group| &group.tiles).max().map_or(0, |last| last + 1);
        let kept = (0..count).filter(|&index| is_kept(index));
        let new_index: HashMap<usize, usize> = kept.enumerate().map(|(new, old)| (old, new)).collect();
        for group in &mut self.groups {
            group.tiles = group.tiles.iter().filter_map(|tile| new_index.get(tile).copied()).collect();
        }
        self.groups.retain(|group| !group.tiles.is_empty());
    }

    /// The same errors for each of this many tiles, and no others.
    pub fn of_tiles(errors: &TileErrors, count: usize) -> FilmTolerance {
        FilmTolerance { tiles: vec![errors.clone(); count], ..FilmTolerance::default() }
    }
}

/// Distributions of the errors of one tile, all independent, in millimetres, radians, or as
/// fractions of the strength. The default is a tile without errors.
pub type TileErrors = PerTileError<Distribution>;

/// Tiles with errors in common, such as a row placed along one ruler or a batch magnetized
/// together.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorGroup {
    /// Name, unique within the layout.
    pub name: String,
    /// Indices of its tiles.
    pub tiles: Vec<usize>,
    /// The errors, in addition to the errors of each tile. The group moves and turns as a rigid
    /// body, about the mean of the centres of its tiles. Errors of size, strength and direction are
    /// the same for all its tiles.
    pub errors: TileErrors,
}

/// Errors that all tiles share, and errors of the surroundings and of the sensor.
///
/// Displacements are measured from a reference point, where the sensor has been read once. All
/// errors are already there at that time, unless they are marked as later.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CommonErrors {
    /// Pose of the film against the sensor.
    pub film: FilmPose,
    /// A uniform field from elsewhere, such as the earth's.
    pub stray_field: Option<StrayField>,
    /// Another film nearby.
    pub neighbour: Option<Neighbour>,
    /// Flat iron near the film.
    pub iron: Option<NearIron>,
    /// A change of temperature after the reading at the reference point.
    pub temperature: Option<Temperature>,
    /// Errors of the sensor.
    pub sensor: SensorErrors,
}

/// Pose of the film against the sensor. The film turns about the centre of its bounding box.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilmPose {
    /// Error of position along each axis.
    pub position_mm: [Distribution; 3],
    /// Components of the rotation vector.
    pub rotation_rad: [Distribution; 3],
}

/// A uniform field: the sum of one with given components and one of any direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrayField {
    /// Components along x, y, z.
    pub field_t: [Distribution; 3],
    /// Magnitude of a field of any direction of space with equal probability.
    pub any_direction_t: Distribution,
    /// Whether the field comes after the reading at the reference point.
    pub later: bool,
}

/// Another film that stands nearby, such as that of the opposing jaw of a gripper.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbour {
    /// Its tiles, at its place beside the film.
    pub tiles: Vec<Tile>,
    /// The path of its layout, as written.
    pub layout: String,
    /// Its place, as written.
    pub position_mm: [f64; 3],
    /// Its rotation about its own origin, as written.
    pub rotation: Option<Rotation>,
    /// Whether it comes after the reading at the reference point.
    pub later: bool,
}

/// Flat iron near the film: a half space behind a plane that does not move with the film.
#[derive(Clone, Debug, PartialEq)]
pub struct NearIron {
    /// Unit vector out of the iron, towards the film.
    pub normal: DVec3,
    /// Distance of the iron from the nearest corner of the film as ordered.
    pub distance_mm: f64,
    /// Error of this distance, smaller than it in every film.
    pub distance_error_mm: Distribution,
    /// Relative permeability of the iron, which may be infinite.
    pub relative_permeability: f64,
    /// Whether it comes after the reading at the reference point.
    pub later: bool,
}

impl NearIron {
    /// The direction out of iron above a film.
    pub const ABOVE: DVec3 = DVec3::NEG_Z;

    /// The iron beside a film of these tiles, with an error of its distance.
    ///
    /// # Errors
    /// The broken rule of a plane.
    pub fn plane(&self, tiles: &[Tile], error_mm: f64) -> Result<IronPlane, IronPlaneFault> {
        let heights = tiles.iter().flat_map(Tile::corners_mm).map(|corner| -self.normal.dot(corner));
        let film_mm = heights.reduce(f64::max).unwrap_or(0.0);
        let point = -(film_mm + self.distance_mm + error_mm) * self.normal;
        IronPlane::new(point, self.normal, self.relative_permeability)
    }
}

impl Default for NearIron {
    /// Soft iron on the upper face of a film, after the first reading.
    fn default() -> NearIron {
        NearIron {
            normal: NearIron::ABOVE,
            distance_mm: 0.0,
            distance_error_mm: Distribution::NONE,
            relative_permeability: f64::INFINITY,
            later: true,
        }
    }
}

/// A change of temperature after the reading at the reference point.
#[derive(Clone, Debug, PartialEq)]
pub struct Temperature {
    /// The change, in kelvin.
    pub change_k: Distribution,
    /// Relative change of the strength of all tiles per kelvin.
    pub strength_per_k: f64,
}

/// Errors of the sensor, or of each sensor of a head. It reads `gain * B + offset + noise` of the
/// components of B along its axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SensorErrors {
    /// Error of its place along each axis of the film. It does not change what it reads of a
    /// neighbour.
    pub position_mm: [Distribution; 3],
    /// Offset along each axis.
    pub offset_t: [Distribution; 3],
    /// Components of the rotation vector of its axes.
    pub rotation_rad: [Distribution; 3],
    /// Error of the gain along each axis, as a fraction.
    pub gain: [Distribution; 3],
    /// Noise along each axis, independent in every reading.
    pub noise_t: [Distribution; 3],
}
