//! Why a film could not be evaluated.

use glam::DVec3;
use magsplice_decouple::{DecouplingError, Parameter};
use magsplice_expect::PointsMismatch;
use magsplice_force::{FilmForcesError, OrderError};
use magsplice_ideal::ComparisonError;
use magsplice_layout::{Layout, MemoryError};
use magsplice_magnet::{Axis, PointErrors};
use magsplice_making::{AssignmentError, ShortGroup};
use magsplice_recoil::tolerances::{MAX_CELLS, MOST_PERMEABILITY_OF_TREE};
use magsplice_recoil::{RecoilError, RefinementError};
use magsplice_scan::{DiagnosisError, SampleScanError, ScanError};
use magsplice_sensor::{HeadLocatorError, LocateError, PolynomialError, SensedFieldError, StiffnessError};
use magsplice_tolerance::SampleError;
use thiserror::Error;

use crate::results::placement::SensorPlacement;

/// Why a film could not be evaluated.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FilmError {
    /// The layout lacks this table, which the evaluation needs.
    #[error("{}", missing_words(.0))]
    Missing(&'static str),
    /// The layout has a head, and this needs one sensor.
    #[error("{0}: leave out head or [[sensor.element]] of [sensor]")]
    Head(&'static str),
    /// The layout has discs, whose strips do not have errors of their own.
    #[error("errors of the strips of a disc would part it: give them by FilmTolerance::of_whole_discs")]
    StripErrors,
    /// Iron changes the recoil of a film, which is not computed.
    #[error("recoil is computed without the field of iron: leave out recoil_permeability or [tolerance.iron]")]
    RecoilNearIron,
    /// The layout has one sensor, and this needs a head.
    #[error("readings of several sensors need head or [[sensor.element]] in [sensor]")]
    NoHead,
    /// The readings are not one of each sensor.
    #[error("the head has {sensors} sensors, and there are {given} readings: each position needs one of each sensor")]
    SensorReadings {
        /// Number of sensors.
        sensors: usize,
        /// Number of readings, of all or for each position.
        given: usize,
    },
    /// The readings of a head cannot be fitted.
    #[error("{0}")]
    HeadLocator(#[source] HeadLocatorError),
    /// There is not enough memory.
    #[error("{0}")]
    Memory(#[source] MemoryError),
    /// The field does not exist at some points.
    #[error("{0}")]
    Points(#[source] PointErrors),
    /// This point of the volume, in millimetres, is not below the film, where Eq. 2 of Dai 2024
    /// holds.
    #[error(
        "the point ({}, {}, {}) mm of the working volume is not below the film, and Eq. 2 of the ideal film holds only \
         for z < 0: lower z_mm or reference_mm of [volume]",
        .0.x, .0.y, .0.z
    )]
    NotBelow(DVec3),
    /// The field cannot be compared with the ideal one.
    #[error("{0}")]
    Comparison(#[source] ComparisonError),
    /// The decoupling parameters cannot be evaluated.
    #[error("{0}")]
    Decoupling(#[source] DecouplingError),
    /// There is no baseline to compare the field with.
    #[error("there is no baseline to compare the field with")]
    NoBaseline,
    /// The baseline has other points than the working volume.
    #[error("{0}")]
    PointsMismatch(#[source] PointsMismatch),
    /// There are no tiles.
    #[error("there are no tiles")]
    NoTiles,
    /// The grid has one point in each plane normal to the axis of this parameter, so that its
    /// uniformity has no meaning.
    #[error(
        "the grid has one point in each plane normal to {}, and the uniformity RMSE compares the points of a plane: use a \
         smaller step_mm in [volume], or more extent",
        .0.axis()
    )]
    OnePointPlanes(Parameter),
    /// The errors of a sample cannot be computed.
    #[error("sample {sample} of [tolerance]: {error}")]
    Sample {
        /// Number of the sample.
        sample: u64,
        /// Why.
        #[source]
        error: SampleError,
    },
    /// The sensor cannot read the field.
    #[error("{0}")]
    Sensor(#[source] SensedFieldError),
    /// The mean of the readings of the sensor at rest has no position.
    #[error("the mean of the readings at rest: {0}")]
    AtRest(#[source] LocateError),
    /// This reading, counted from 0, has two positions or none.
    #[error("reading {reading} has two positions or none")]
    NoPosition {
        /// Its index.
        reading: usize,
    },
    /// Forces and displacements along an axis give no stiffness.
    #[error("along {axis}: {error}{}", hint.as_ref().map_or(String::new(), |hint| format!("; {hint}")))]
    Stiffness {
        /// The axis.
        axis: Axis,
        /// Why.
        #[source]
        error: StiffnessError,
        /// What is otherwise than stated of readings without a position.
        hint: Option<String>,
    },
    /// The noise of readings, which a diagnosis needs, is not known.
    #[error("the layout has no noise: give the noise of the readings, or noise_ut or part in [sensor]")]
    NoNoise,
    /// A scan cannot be fitted.
    #[error("{0}")]
    Scan(#[source] ScanError),
    /// A scan cannot be fitted, and its readings share an extreme or have no sign.
    #[error("the scan cannot be fitted, and {0}")]
    UnfitReadings(String),
    /// A film as made cannot be scanned.
    #[error("{0}")]
    SampleScan(#[source] SampleScanError),
    /// A scan cannot be diagnosed.
    #[error("{0}")]
    Diagnosis(#[source] DiagnosisError),
    /// The film as ordered explains a scan with another placement of the sensor, so that its errors
    /// of tiles would be wrong.
    #[error("{0}")]
    Misplaced(Box<SensorPlacement>),
    /// Measured tiles cannot be assigned.
    #[error("{}", assignment_words(error, tile, groups))]
    Assignment {
        /// Why.
        #[source]
        error: AssignmentError,
        /// Name of the tile that the error is about, if it is about one.
        tile: String,
        /// Sides in millimetres of each part, and the number of its places that are free.
        groups: Vec<(DVec3, usize)>,
    },
    /// Tiles of samples cannot be sorted.
    #[error("{0}")]
    Sorting(#[source] AssignmentError),
    /// Steps of an experiment in millimetres that are not above 0, or too small for the working
    /// volume.
    #[error(
        "steps of ({}, {}, {}) mm: each must be above 0 and give at most 100000 steps in the working volume and from the \
         reference point to it",
        .0.x, .0.y, .0.z
    )]
    ExperimentStep(DVec3),
    /// The polarization of tiles with a recoil permeability is not known.
    #[error("{}", recoil_words(error, tiles))]
    Recoil {
        /// Why.
        #[source]
        error: RefinementError,
        /// Names of the tiles that the error is about.
        tiles: Vec<String>,
    },
    /// The forces of the tiles on each other are not known.
    #[error("{}", force_words(error, tiles))]
    Forces {
        /// Why. Tiles with a recoil permeability are divided into cells, which it counts.
        #[source]
        error: FilmForcesError,
        /// Names of the tiles that the error is about.
        tiles: Vec<String>,
    },
    /// The working volume is a point, and positions are searched along its extents.
    #[error(
        "[volume] is a point, and positions from readings are searched along its extents: x_mm, y_mm or z_mm needs an \
         extent above 0"
    )]
    PointVolume,
    /// A placement order does not have each tile once.
    #[error("{0}")]
    Order(#[source] OrderError),
    /// The displacement of the sensor is no polynomial of the parameters.
    #[error("{0}")]
    Polynomial(#[source] PolynomialError),
    /// This number of samples is too small to show, with the confidence of the layout, that the
    /// percentile breaks a bound.
    #[error("{0} samples are too few to test the percentile of [expect.made]: set more samples")]
    TooFewSamples(usize),
}

impl FilmError {
    /// The failure of the fit of a head.
    pub(crate) fn of_head(error: HeadLocatorError) -> FilmError {
        match error {
            HeadLocatorError::Points(errors) => FilmError::Points(errors),
            error => FilmError::HeadLocator(error),
        }
    }

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

/// A missing table.
fn missing_words(table: &str) -> String {
    let or = if table == "tolerance" { ", or give a preset" } else { "" };
    format!("the layout has no [{table}] table, which this needs: add one{or}")
}

fn names(layout: &Layout, tiles: &[usize]) -> Vec<String> {
    tiles.iter().map(|&tile| layout.tiles[tile].name.clone()).collect()
}

/// A failure of a refinement in the words of a layout.
fn recoil_words(error: &RefinementError, tiles: &[String]) -> String {
    match (error, tiles) {
        (RefinementError::Recoil(RecoilError::Overlap { .. }), [first, second]) => format!(
            "tiles \"{first}\" and \"{second}\" overlap, and tiles with a recoil permeability must not: move one, or \
             remove recoil_permeability, as from a film as made: what recoil changes is that of the film as ordered"
        ),
        (RefinementError::Recoil(RecoilError::Cell { source, .. }), [tile]) => {
            format!("tile \"{tile}\" cannot be divided into cells: {source}")
        }
        (RefinementError::Recoil(RecoilError::Turned { source, .. }), [first, second]) => {
            format!("tiles \"{first}\" and \"{second}\": {source}")
        }
        (RefinementError::NotConverged { best: None, most_cells, needed_cells, .. }, _) => format!(
            "tiles with a recoil permeability have {needed_cells} cells at the least, must have at most {most_cells}: \
             take fewer tiles"
        ),
        (RefinementError::NotConverged { best: Some(best), tolerance, reached, most_cells, needed_cells }, _) => {
            let (times, cells) = (reached / tolerance, best.magnetization.fields_t().len());
            let needed_cells = *needed_cells as f64;
            format!(
                "the error of recoil in B is {times:.1} times the allowed error with {cells} cells; about \
                 {needed_cells:.0e} cells are needed, at most {most_cells} are possible: raise recoil_error in [material], \
                 or take points farther from the tiles"
            )
        }
        (RefinementError::Recoil(RecoilError::TooPermeable { permeability, cells }), _) => format!(
            "recoil_permeability = {permeability}, must be at most {MOST_PERMEABILITY_OF_TREE} with the {cells} cells of so \
             small an error: lower it, or raise recoil_error in [material]"
        ),
        (RefinementError::Recoil(RecoilError::TooManyCells { count }), _) => format!(
            "tiles with a recoil permeability have {count} cells, must have at most {MAX_CELLS}: raise recoil_error in \
             [material], or take fewer tiles"
        ),
        (error, _) => error.to_string(),
    }
}

/// A failure of forces in the words of a layout.
fn force_words(error: &FilmForcesError, tiles: &[String]) -> String {
    match error {
        FilmForcesError::Pair { source, .. } => format!(
            "tiles \"{}\": their force has an error of {:.1e}, must have at most {:.1e}: leave a gap between them, or \
             allow a larger error",
            tiles.join("\" and \""),
            source.reached,
            source.tolerance
        ),
        error => error.to_string(),
    }
}

/// A failure of an assignment in the words of a layout.
fn assignment_words(error: &AssignmentError, tile: &str, groups: &[(DVec3, usize)]) -> String {
    match error {
        AssignmentError::TooFew(short) => {
            let of_part = |ShortGroup { group, places, tiles }: &ShortGroup| {
                let (DVec3 { x, y, z }, number) = (groups[*group].0, group + 1);
                let of_places = if *places == 1 { "1 place".to_owned() } else { format!("{places} places") };
                format!("part {number} ({x} x {y} x {z} mm, {of_places}) has {tiles} of the measured tiles")
            };
            let parts: Vec<String> = short.iter().map(of_part).collect();
            format!("{}: measure more, or give the tiles already placed", parts.join("; "))
        }
        AssignmentError::NoOrientation { .. } => {
            format!("place \"{tile}\": its tile must be turned over: allow tiles to be turned over")
        }
        AssignmentError::Shim { .. } => {
            format!("shim \"{tile}\": its effect cannot be separated from the other shims: choose another place")
        }
        error => error.to_string(),
    }
}
