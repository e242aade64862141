//! The unknowns of a scan as one list, and their prior deviations.

use magsplice_layout::FilmTolerance;
use magsplice_magnet::{PerTileError, TileError};
use magsplice_tolerance::mean_square;
use nalgebra::DVector;

use crate::diagnosis::candidate::{Candidate, ErrorKind};
use crate::parameters::{FreeParameters, ScanParameter, ScanParameters};

/// Prior deviation of the components of an identified error. It is far above the resolution of the
/// scan, but small enough that unresolved components stay in the range of the model. A strength has
/// that of a reversed tile: with 0.5, reversed tiles of films made by hand, read from afar, would
/// be 8 % too near to the ordered strength.
const WIDE: PerTileError<f64> =
    PerTileError { position: [0.5; 3], rotation: [0.2; 3], size: [0.5; 3], strength: 2.0, direction: [0.2; 2] };

/// Prior deviation of the strength of all tiles.
const WIDE_STRENGTH: f64 = 1.0;
/// Prior deviation of the offset, in tesla: a hundred times the field of the earth.
const WIDE_OFFSET_T: f64 = 5e-3;
/// Prior deviation of the rotation of the sensor, in radians.
const WIDE_ROTATION_RAD: f64 = 0.3;
/// Prior deviation of the start of the scan, in millimetres.
const WIDE_START_MM: f64 = 1.0;

/// One unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unknown {
    /// An error of a tile.
    Tile { tile: usize, error: TileError },
    /// An error of a group of tiles.
    Group { group: usize, error: TileError },
    /// A parameter of the scan.
    Scan(ScanParameter),
}

/// All unknowns with their expected deviations.
#[derive(Clone, Debug)]
pub(crate) struct Unknowns {
    pub(crate) list: Vec<Unknown>,
    /// Standard deviation of each unknown in a film without faults; 0 for unknowns exactly as
    /// ordered.
    pub(crate) expected: Vec<f64>,
}

impl Unknowns {
    /// The unknowns of a number of tiles with these expected errors.
    pub(crate) fn new(tiles: usize, expected: &FilmTolerance, free: FreeParameters) -> Unknowns {
        let (mut list, mut deviations) = (Vec::new(), Vec::new());
        let mut add = |unknown, deviation| {
            list.push(unknown);
            deviations.push(deviation);
        };
        for tile in 0..tiles {
            let errors = expected.tiles.get(tile);
            for error in TileError::ALL {
                let deviation = errors.map_or(0.0, |errors| mean_square(&errors[error]).sqrt());
                if deviation > 0.0 || ErrorKind::of_component(error).is_some() {
                    add(Unknown::Tile { tile, error }, deviation);
                }
            }
        }
        for (group, errors) in expected.groups.iter().enumerate() {
            for (error, distribution) in errors.errors.iter() {
                let deviation = mean_square(distribution).sqrt();
                if deviation > 0.0 {
                    add(Unknown::Group { group, error }, deviation);
                }
            }
        }
        for parameter in ScanParameter::ALL.into_iter().filter(|parameter| free.contains(*parameter)) {
            let deviation = match parameter {
                ScanParameter::Strength => WIDE_STRENGTH,
                ScanParameter::Offset(_) => WIDE_OFFSET_T,
                ScanParameter::Rotation(_) => WIDE_ROTATION_RAD,
                ScanParameter::Start(_) => WIDE_START_MM,
            };
            add(Unknown::Scan(parameter), deviation);
        }
        Unknowns { list, expected: deviations }
    }

    /// The indices of the components of an error of a tile.
    pub(crate) fn of_error(&self, Candidate { tile, kind }: Candidate) -> Vec<usize> {
        let is_part = |unknown: Unknown| match unknown {
            Unknown::Tile { tile: other, error } => other == tile && ErrorKind::of_component(error) == Some(kind),
            _ => false,
        };
        (0..self.list.len()).filter(|index| is_part(self.list[*index])).collect()
    }

    /// The deviations if these errors of tiles may have any value.
    pub(crate) fn with_detected(&self, detected: &[Candidate]) -> Vec<f64> {
        let mut deviations = self.expected.clone();
        for candidate in detected {
            for index in self.of_error(*candidate) {
                if let Unknown::Tile { error, .. } = self.list[index] {
                    deviations[index] = WIDE[error];
                }
            }
        }
        deviations
    }

    /// Deviations with those of expected errors over a factor. Identified errors and parameters of
    /// the scan keep theirs.
    pub(crate) fn with_expected_over(&self, deviations: &[f64], factor: f64) -> Vec<f64> {
        let all = self.list.iter().zip(&self.expected).zip(deviations);
        all.map(|((unknown, expected), deviation)| match unknown {
            Unknown::Tile { .. } | Unknown::Group { .. } if expected == deviation => deviation / factor,
            _ => *deviation,
        })
        .collect()
    }

    /// The sum of the squares of values over their deviations.
    pub(crate) fn sum_of_squares(values: &DVector<f64>, deviations: &[f64]) -> f64 {
        let expected = values.iter().zip(deviations).filter(|(_, deviation)| **deviation > 0.0);
        expected.map(|(value, deviation)| (value / deviation).powi(2)).sum()
    }

    /// Whether tiles or groups have expected errors.
    pub(crate) fn expects_errors(&self) -> bool {
        let mut all = self.list.iter().zip(&self.expected);
        all.any(|(unknown, deviation)| !matches!(unknown, Unknown::Scan(_)) && *deviation > 0.0)
    }

    /// Number of unknowns of the scan.
    pub(crate) fn of_scan(&self) -> usize {
        self.list.iter().filter(|unknown| matches!(unknown, Unknown::Scan(_))).count()
    }
}

/// A value of every error of a film and parameter of a scan.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct State {
    pub(crate) tiles: Vec<PerTileError<f64>>,
    pub(crate) groups: Vec<PerTileError<f64>>,
    /// Strength minus 1, offset, rotation, start.
    pub(crate) scan: [f64; ScanParameter::ALL.len()],
}

impl State {
    /// The nominal film in this scan.
    pub(crate) fn nominal(tiles: usize, groups: usize, scan: &ScanParameters) -> State {
        let mut values = ScanParameter::ALL.map(|parameter| scan.get(parameter));
        values[0] -= 1.0;
        let none = PerTileError::default();
        State { tiles: vec![none; tiles], groups: vec![none; groups], scan: values }
    }

    pub(crate) fn get(&self, unknown: Unknown) -> f64 {
        match unknown {
            Unknown::Tile { tile, error } => self.tiles[tile][error],
            Unknown::Group { group, error } => self.groups[group][error],
            Unknown::Scan(parameter) => self.scan[parameter.index()],
        }
    }

    pub(crate) fn set(&mut self, unknown: Unknown, value: f64) {
        match unknown {
            Unknown::Tile { tile, error } => self.tiles[tile][error] = value,
            Unknown::Group { group, error } => self.groups[group][error] = value,
            Unknown::Scan(parameter) => self.scan[parameter.index()] = value,
        }
    }

    /// The parameters of the scan.
    pub(crate) fn scan_parameters(&self) -> ScanParameters {
        let found = ScanParameters::from_fn(|parameter| self.scan[parameter.index()]);
        ScanParameters { strength: 1.0 + found.strength, ..found }
    }
}
