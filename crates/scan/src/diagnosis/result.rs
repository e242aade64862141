//! Identified errors, and further results of a scan of a film.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use glam::DVec3;
use magsplice_magnet::{PerTileError, Tile, TileError};

use crate::diagnosis::candidate::{Candidate, ErrorKind};
use crate::diagnosis::significance::is_implausible;
use crate::diagnosis::unresolved::{NarrowedError, SimilarErrors};
use crate::exclusion::Exclusion;
use crate::parameters::ScanParameters;

/// An error with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct FittedError {
    /// The error.
    pub error: TileError,
    /// The error, in mm, radians, or as a fraction.
    pub value: f64,
    /// The standard deviation.
    pub deviation: f64,
}

/// An error that neither noise nor expected errors explain.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct DetectedError {
    /// The tile and its fault.
    #[serde(flatten)]
    pub candidate: Candidate,
    /// The components.
    pub components: Vec<FittedError>,
    /// The rise of chi squared without the error.
    pub chi_squared: f64,
    /// The natural logarithm of the probability of as large a rise by chance, for one error.
    pub ln_probability: f64,
    /// Errors that in its place explain the readings nearly as well, the best first.
    pub alternatives: Vec<Candidate>,
}

/// Ratio of a component to its deviation above which it is more than noise.
const SIGNIFICANT: f64 = 2.0;

impl FittedError {
    /// Whether the value exceeds two deviations.
    pub fn is_significant(&self) -> bool {
        self.value.abs() > SIGNIFICANT * self.deviation
    }
}

impl DetectedError {
    /// The magnitude: the error of strength, or the length of the vector of all significant
    /// components. The scan may hardly resolve others, such as a turn about J.
    pub fn magnitude(&self) -> f64 {
        match &self.components[..] {
            [one] => one.value,
            _ => self.counted().map(|of| of.value.powi(2)).sum::<f64>().sqrt(),
        }
    }

    /// The standard deviation of the magnitude, without correlations of the components.
    pub fn magnitude_deviation(&self) -> f64 {
        match &self.components[..] {
            [one] => one.deviation,
            _ => self.counted().map(|of| (of.value * of.deviation).powi(2)).sum::<f64>().sqrt() / self.magnitude(),
        }
    }

    /// The significant components, or all where none is.
    fn counted(&self) -> impl Iterator<Item = &FittedError> {
        let is_any = self.components.iter().any(FittedError::is_significant);
        self.components.iter().filter(move |of| !is_any || of.is_significant())
    }
}

/// The diagnosis of a film from a scan.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The identified errors, the most certain first.
    pub detected: Vec<DetectedError>,
    /// Whether the list has all significant errors. A film with more than 16 is another film, or
    /// its tiles have unspecified expected errors.
    pub is_complete: bool,
    /// Whether expected errors bias the parameters of the scan, because the fit without bias does
    /// not converge.
    pub is_biased: bool,
    /// The film that explains the readings: significant components of the identified errors, and
    /// the most probable expected errors.
    pub tiles: Vec<Tile>,
    /// The errors of each tile in this film, in mm, radians, or as fractions.
    pub errors: Vec<PerTileError<f64>>,
    /// The parameters of the scan.
    pub scan: ScanParameters,
    /// Their standard deviations; 0 for fixed parameters.
    pub scan_deviations: ScanParameters,
    /// Measured readings minus the readings of the found film, in tesla.
    pub residuals_t: Vec<DVec3>,
    /// The reason why a reading is excluded, for each reading.
    pub exclusions: Vec<Option<Exclusion>>,
    /// Sum of the squares of residuals over noise, and of expected errors over their deviations.
    pub chi_squared: f64,
    /// The expectation of chi squared: the number of readings minus the number of free unknowns.
    pub degrees_of_freedom: usize,
    /// The natural logarithm of the probability of a larger chi squared.
    pub ln_probability: f64,
    /// Standard deviations of all errors of tiles before and after the scan.
    pub narrowed: Vec<NarrowedError>,
    /// Pairs of similar errors, the most similar first.
    pub similar: Vec<SimilarErrors>,
}

/// Errors of the strength that a tile may have: from a reversed tile of twice its strength, -3, to
/// a tile of three times its strength.
pub(crate) const STRENGTH_ERRORS: RangeInclusive<f64> = -3.0..=2.0;

impl Diagnosis {
    /// Whether the residual is too large for the noise: the film has errors of another kind, or the
    /// noise is larger than specified.
    pub fn is_residual_too_large(&self) -> bool {
        is_implausible(self.chi_squared, self.degrees_of_freedom)
    }

    /// Whether every identified error is one that a tile can have: a turn by at most half a turn, a
    /// displacement by at most the longest side of the tile, and a strength from that of a reversed
    /// tile of twice its strength to three times the ordered strength, each beside its deviation.
    pub fn has_possible_errors(&self, tiles: &[Tile]) -> bool {
        self.detected.iter().all(|detected| {
            let possible = match detected.candidate.kind {
                ErrorKind::Strength => STRENGTH_ERRORS,
                ErrorKind::Turn | ErrorKind::Direction => -PI..=PI,
                ErrorKind::Displacement => {
                    let side = tiles[detected.candidate.tile].size().max_element();
                    -side..=side
                }
            };
            let beside = SIGNIFICANT * detected.magnitude_deviation();
            (possible.start() - beside..=possible.end() + beside).contains(&detected.magnitude())
        })
    }

    /// Root mean square of the residual of a component, without excluded readings, in tesla.
    pub fn residual_t(&self) -> f64 {
        let used = self.residuals_t.iter().zip(&self.exclusions).filter(|(_, exclusion)| exclusion.is_none());
        let (squares, count) =
            used.fold((0.0, 0), |(squares, count), (of, _)| (squares + of.length_squared(), count + 3));
        (squares / f64::from(count.max(1))).sqrt()
    }
}
