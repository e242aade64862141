//! Why a film could not be evaluated.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_decouple::{DecouplingError, Parameter};
use magsplice_expect::PointsMismatch;
use magsplice_force::{FilmForcesError, OrderError};
use magsplice_ideal::ComparisonError;
use magsplice_layout::Layout;
use magsplice_magnet::{Axis, PointErrors};
use magsplice_making::AssignmentError;
use magsplice_recoil::tolerances::{MAX_CELLS, MOST_PERMEABILITY_OF_TREE};
use magsplice_recoil::{RecoilError, RefinementError};
use magsplice_scan::{DiagnosisError, ScanError};
use magsplice_sensor::{LocateError, PolynomialError, SensedFieldError, StiffnessError};
use magsplice_tolerance::SampleError;

/// Why a film could not be evaluated.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FilmError {
    /// The layout lacks this table, which the evaluation needs.
    Missing(&'static str),
    /// The field does not exist at some points.
    Points(PointErrors),
    /// This point of the volume, in millimetres, is not below the film, where Eq. 2 of Dai 2024
    /// holds.
    NotBelow(DVec3),
    /// The field cannot be compared with the ideal one.
    Comparison(ComparisonError),
    /// The decoupling parameters cannot be evaluated.
    Decoupling(DecouplingError),
    /// There is no baseline to compare the field with.
    NoBaseline,
    /// The baseline has other points than the working volume.
    PointsMismatch(PointsMismatch),
    /// There are no tiles.
    NoTiles,
    /// The grid has one point in each plane normal to the axis of this parameter, so that its
    /// uniformity has no meaning.
    OnePointPlanes(Parameter),
    /// A film that is made has no errors.
    Sample {
        /// Number of the sample.
        sample: u64,
        /// Why.
        error: SampleError,
    },
    /// The sensor cannot read the field.
    Sensor(SensedFieldError),
    /// The mean of the readings of the sensor at rest has no position.
    AtRest(LocateError),
    /// This reading, counted from 0, has two positions or none.
    NoPosition {
        /// Its index.
        reading: usize,
    },
    /// Forces and displacements along an axis give no stiffness.
    Stiffness {
        /// The axis.
        axis: Axis,
        /// Why.
        error: StiffnessError,
    },
    /// The noise of readings, which a diagnosis needs, is not known.
    NoNoise,
    /// A scan cannot be fitted.
    Scan(ScanError),
    /// A scan cannot be diagnosed.
    Diagnosis(DiagnosisError),
    /// Measured tiles cannot be assigned.
    Assignment {
        /// Why.
        error: AssignmentError,
        /// Name of the tile that the error is about, if it is about one.
        tile: String,
        /// Sides in millimetres of each part, and the number of its places that are free.
        groups: Vec<(DVec3, usize)>,
    },
    /// Tiles of samples cannot be sorted.
    Sorting(AssignmentError),
    /// Steps of an experiment in millimetres that are not above 0, or too small for the working
    /// volume.
    ExperimentStep(DVec3),
    /// The polarization of tiles with a recoil permeability is not known.
    Recoil {
        /// Why.
        error: RefinementError,
        /// Names of the tiles that the error is about.
        tiles: Vec<String>,
    },
    /// The forces of the tiles on each other are not known.
    Forces {
        /// Why. Tiles with a recoil permeability are divided into cells, which it counts.
        error: FilmForcesError,
        /// Names of the tiles that the error is about.
        tiles: Vec<String>,
    },
    /// A placement order does not have each tile once.
    Order(OrderError),
    /// The displacement of the sensor is no polynomial of the parameters.
    Polynomial(PolynomialError),
    /// This number of samples cannot break any bound of the percentile with the confidence stated.
    TooFewSamples(usize),
}

impl FilmError {
    /// The failure of a refinement, with the names of the tiles that it is about.
    pub fn from_recoil(error: RefinementError, layout: &Layout) -> FilmError {
        let indices = match &error {
            RefinementError::Recoil(RecoilError::Overlap { first, second }) => vec![*first, *second],
            RefinementError::Recoil(RecoilError::Cell { tile, .. }) => vec![*tile],
            RefinementError::Recoil(RecoilError::Turned { receiver, source_tile, .. }) => vec![*receiver, *source_tile],
            _ => Vec::new(),
        };
        FilmError::Recoil { error, tiles: names(layout, &indices) }
    }

    /// The failure of forces, with the names of the tiles that it is about.
    pub(crate) fn from_forces(error: FilmForcesError, layout: &Layout) -> FilmError {
        let indices = match &error {
            FilmForcesError::Pair { first, second, .. } => vec![*first, *second],
            _ => Vec::new(),
        };
        FilmError::Forces { error, tiles: names(layout, &indices) }
    }
}

fn names(layout: &Layout, tiles: &[usize]) -> Vec<String> {
    tiles.iter().map(|&tile| layout.tiles[tile].name.clone()).collect()
}

/// A failure of a refinement in the words of a layout.
fn recoil_words(error: &RefinementError, tiles: &[String], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match (error, tiles) {
        (RefinementError::Recoil(RecoilError::Overlap { .. }), [first, second]) => write!(
            f,
            "tiles \"{first}\" and \"{second}\" overlap, and tiles with a recoil permeability must not: move one, or \
             remove recoil_permeability"
        ),
        (RefinementError::Recoil(RecoilError::Cell { source, .. }), [tile]) => {
            write!(f, "tile \"{tile}\" cannot be divided into cells: {source}")
        }
        (RefinementError::Recoil(RecoilError::Turned { source, .. }), [first, second]) => {
            write!(f, "tiles \"{first}\" and \"{second}\": {source}")
        }
        (RefinementError::NotConverged { best: None, most_cells, needed_cells, .. }, _) => write!(
            f,
            "tiles with a recoil permeability have {needed_cells} cells at the least, must have at most {most_cells}: \
             take fewer tiles"
        ),
        (RefinementError::NotConverged { best: Some(best), tolerance, reached, most_cells, needed_cells }, _) => {
            write!(
                f,
                "the error of recoil in B is {:.1} times the allowed error with {} cells; about {needed_cells:.0e} cells are \
             needed, at most {most_cells} are possible: raise recoil_error in [material], or take points farther \
             from the tiles",
                reached / tolerance,
                best.magnetization.cells().len(),
                needed_cells = *needed_cells as f64
            )
        }
        (RefinementError::Recoil(RecoilError::TooPermeable { permeability, cells }), _) => write!(
            f,
            "recoil_permeability = {permeability}, must be at most {MOST_PERMEABILITY_OF_TREE} with the {cells} cells of so \
             small an error: lower it, or raise recoil_error in [material]"
        ),
        (RefinementError::Recoil(RecoilError::TooManyCells { count }), _) => write!(
            f,
            "tiles with a recoil permeability have {count} cells, must have at most {MAX_CELLS}: raise recoil_error in \
             [material], or take fewer tiles"
        ),
        (error, _) => write!(f, "{error}"),
    }
}

/// A failure of an assignment in the words of a layout.
fn assignment_words(
    error: &AssignmentError,
    tile: &str,
    groups: &[(DVec3, usize)],
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    match error {
        AssignmentError::TooFew { group, places, tiles } => {
            let (DVec3 { x, y, z }, number) = (groups[*group].0, group + 1);
            let of_places = if *places == 1 { "1 place".to_owned() } else { format!("{places} places") };
            write!(
                f,
                "part {number} ({x} x {y} x {z} mm, {of_places}) has {tiles} of the measured tiles: measure more, or give \
                 the tiles already placed"
            )
        }
        AssignmentError::NoOrientation { .. } => {
            write!(f, "place \"{tile}\": its tile must be turned over: allow tiles to be turned over")
        }
        AssignmentError::Shim { .. } => {
            write!(f, "shim \"{tile}\": its effect cannot be separated from the other shims: choose another place")
        }
        error => write!(f, "{error}"),
    }
}

impl fmt::Display for FilmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FilmError::Missing(table) => write!(f, "the layout has no [{table}] table, which this needs: add one"),
            FilmError::Points(errors) => errors.fmt(f),
            FilmError::NotBelow(p) => write!(
                f,
                "the point ({}, {}, {}) mm of the working volume is not below the film, and Eq. 2 of the ideal film holds \
                 only for z < 0: lower z_mm or reference_mm of [volume]",
                p.x, p.y, p.z
            ),
            FilmError::Comparison(error) => error.fmt(f),
            FilmError::Decoupling(error) => error.fmt(f),
            FilmError::NoBaseline => f.write_str("there is no baseline to compare the field with"),
            FilmError::PointsMismatch(error) => error.fmt(f),
            FilmError::NoTiles => f.write_str("there are no tiles"),
            FilmError::Sample { sample, error } => write!(f, "sample {sample} of [tolerance]: {error}"),
            FilmError::Sensor(error) => error.fmt(f),
            FilmError::NoNoise => {
                f.write_str("the layout has no noise: give the noise of the readings, or noise_ut or part in [sensor]")
            }
            FilmError::NoPosition { reading } => write!(f, "reading {reading} has two positions or none"),
            FilmError::Stiffness { axis, error } => write!(f, "along {axis}: {error}"),
            FilmError::Scan(error) => error.fmt(f),
            FilmError::Diagnosis(error) => error.fmt(f),
            FilmError::Sorting(error) => error.fmt(f),
            FilmError::Assignment { error, tile, groups } => assignment_words(error, tile, groups, f),
            FilmError::AtRest(error) => write!(f, "the mean of the readings at rest: {error}"),
            FilmError::Recoil { error, tiles } => recoil_words(error, tiles, f),
            FilmError::Forces { error: FilmForcesError::Pair { source, .. }, tiles } => write!(
                f,
                "tiles \"{}\": their force has an error of {:.1e}, must have at most {:.1e}: leave a gap between them, or \
                 allow a larger error",
                tiles.join("\" and \""),
                source.reached,
                source.tolerance
            ),
            FilmError::Forces { error, .. } => error.fmt(f),
            FilmError::Order(error) => error.fmt(f),
            FilmError::Polynomial(error) => error.fmt(f),
            FilmError::ExperimentStep(step) => write!(
                f,
                "steps of ({}, {}, {}) mm: each must be above 0 and give at most 100000 steps in the working volume",
                step.x, step.y, step.z
            ),
            FilmError::TooFewSamples(samples) => {
                write!(f, "{samples} samples are too few to test the percentile of [expect.made]: set more samples")
            }
            FilmError::OnePointPlanes(parameter) => write!(
                f,
                "the grid has one point in each plane normal to {}, and the uniformity RMSE compares the points of a \
                 plane: use a smaller step_mm in [volume]",
                parameter.axis()
            ),
        }
    }
}

impl Error for FilmError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            FilmError::Points(errors) => Some(errors),
            FilmError::Comparison(error) => Some(error),
            FilmError::Decoupling(error) => Some(error),
            FilmError::PointsMismatch(error) => Some(error),
            FilmError::Sample { error, .. } => Some(error),
            FilmError::Sensor(error) => Some(error),
            FilmError::AtRest(error) => Some(error),
            FilmError::Stiffness { error, .. } => Some(error),
            FilmError::Scan(error) => Some(error),
            FilmError::Diagnosis(error) => Some(error),
            FilmError::Sorting(error) => Some(error),
            FilmError::Assignment { error, .. } => Some(error),
            FilmError::Recoil { error, .. } => Some(error),
            FilmError::Forces { error, .. } => Some(error),
            FilmError::Order(error) => Some(error),
            FilmError::Polynomial(error) => Some(error),
            _ => None,
        }
    }
}
