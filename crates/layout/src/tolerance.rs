//! What a film that is made differs by from its layout: errors of tiles, of groups of tiles, and of
//! the surroundings.

use magsplice_magnet::Tile;

use crate::distribution::Distribution;

/// The errors of the films that are made from a layout. The default is none.
///
/// # Units
/// Lengths in millimetres, angles in radians, flux densities in tesla; strengths and gains are
/// fractions.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmTolerance {
    /// The errors of each tile, independent of those of other tiles. Empty, or one for each tile.
    pub tiles: Vec<TileErrors>,
    /// Groups of tiles that move or change together.
    pub groups: Vec<ErrorGroup>,
    /// Errors that all tiles share, and those of the surroundings and of the sensor.
    pub common: CommonErrors,
    /// Number of samples that are evaluated unless another number is asked for.
    pub samples: u64,
    /// Seed of the random numbers unless another one is asked for.
    pub seed: u64,
}

impl Default for FilmTolerance {
    fn default() -> FilmTolerance {
        let (tiles, groups, common) = (Vec::new(), Vec::new(), CommonErrors::default());
        FilmTolerance { tiles, groups, common, samples: 1000, seed: 1 }
    }
}

impl FilmTolerance {
    /// The same errors for each of this many tiles, and no others.
    pub fn of_tiles(errors: &TileErrors, count: usize) -> FilmTolerance {
        FilmTolerance { tiles: vec![errors.clone(); count], ..FilmTolerance::default() }
    }
}

/// Distributions of the errors of one tile, all independent. The default is a tile without errors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileErrors {
    /// Error of the centre along each axis of the layout.
    pub position_mm: [Distribution; 3],
    /// Components along the axes of the layout of the rotation vector by which the tile is turned
    /// about its centre.
    pub rotation_rad: [Distribution; 3],
    /// Error of each side, along the tile's own axes.
    pub size_mm: [Distribution; 3],
    /// Error of |J|, as a fraction of it.
    pub strength: Distribution,
    /// Angles by which J is turned within the tile: in the plane of the film, about the part of its
    /// normal that is normal to J; and out of it, about the axis normal to both.
    pub direction_rad: [Distribution; 2],
}

/// Tiles with errors in common, such as a row laid along one ruler or a batch magnetized together.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorGroup {
    /// Name, unique within the layout.
    pub name: String,
    /// Indices of its tiles.
    pub tiles: Vec<usize>,
    /// The errors, in addition to those of each tile. The group moves and turns as a rigid body, about
    /// the mean of the centres of its tiles. Errors of size, strength and direction are the same for
    /// all its tiles.
    pub errors: TileErrors,
}

/// Errors that all tiles share, and those of the surroundings and of the sensor.
///
/// Displacements are measured from a reference point, where the sensor has been read once. All errors
/// are already there at that time, unless they are said to come later.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CommonErrors {
    /// Pose of the film against the sensor.
    pub film: FilmPose,
    /// A uniform field from elsewhere, such as that of the earth.
    pub stray_field: Option<StrayField>,
    /// Another film nearby.
    pub neighbour: Option<Neighbour>,
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
    /// Its rotation about the axes of the layout, as written: a rotation vector.
    pub rotation_rad: [f64; 3],
    /// Whether it comes after the reading at the reference point.
    pub later: bool,
}

/// A change of temperature after the reading at the reference point.
#[derive(Clone, Debug, PartialEq)]
pub struct Temperature {
    /// The change, in kelvin.
    pub change_k: Distribution,
    /// Relative change of the strength of all tiles per kelvin.
    pub strength_per_k: f64,
}

/// Errors of the sensor. It reads `gain * B + offset + noise` of the components of B along its axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SensorErrors {
    /// Offset along each axis.
    pub offset_t: [Distribution; 3],
    /// Components of the rotation vector of its axes.
    pub rotation_rad: [Distribution; 3],
    /// Error of the gain along each axis, as a fraction.
    pub gain: [Distribution; 3],
    /// Noise along each axis, independent in every reading.
    pub noise_t: [Distribution; 3],
}

impl TileErrors {
    /// The errors of tiles that were cut and laid with care: normal errors of 0.05 mm in position along
    /// each axis, 0.5 degrees about each axis, and 1 % in strength.
    pub fn workshop() -> TileErrors {
        let turn = Distribution::normal(0.5_f64.to_radians());
        TileErrors {
            position_mm: [const { Distribution::normal(0.05) }; 3],
            rotation_rad: [turn.clone(), turn.clone(), turn],
            strength: Distribution::normal(0.01),
            ..TileErrors::default()
        }
    }

    /// All errors: three each of position, rotation and size, one of strength, and two of direction.
    pub fn all(&self) -> [&Distribution; TileErrors::COUNT] {
        let TileErrors { position_mm: p, rotation_rad: r, size_mm: s, strength, direction_rad: d } = self;
        [&p[0], &p[1], &p[2], &r[0], &r[1], &r[2], &s[0], &s[1], &s[2], strength, &d[0], &d[1]]
    }

    /// Number of errors of a tile.
    pub const COUNT: usize = 12;
}
