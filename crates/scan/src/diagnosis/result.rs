//! Errors that are named, and what else a scan tells of a film.

use glam::DVec3;
use magsplice_magnet::{PerTileError, Tile, TileError};

use crate::diagnosis::candidate::Candidate;
use crate::diagnosis::unresolved::{NarrowedError, SimilarErrors};
use crate::parameters::ScanParameters;

/// An error with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct FittedError {
    /// The error.
    pub error: TileError,
    /// The error, in mm, radians, or as a fraction.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// An error that neither noise nor expected errors explain.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct NamedError {
    /// The tile and what is wrong with it.
    #[serde(flatten)]
    pub candidate: Candidate,
    /// Its components.
    pub components: Vec<FittedError>,
    /// What chi squared rises by without it.
    pub chi_squared: f64,
    /// The natural logarithm of the probability that chance gives as much for one error.
    pub ln_probability: f64,
    /// Errors that explain the readings nearly as well in its place, the best first.
    pub alternatives: Vec<Candidate>,
}

/// Value of a component over its deviation from which on it is no noise.
const SIGNIFICANT: f64 = 2.0;

impl FittedError {
    /// Whether the value is more than noise: beyond two deviations.
    pub fn is_significant(&self) -> bool {
        self.value.abs() > SIGNIFICANT * self.deviation
    }
}

impl NamedError {
    /// The magnitude: the error of strength itself, or the length of the vector of all components
    /// that are more than noise. The scan may hardly tell one of them, such as a turn about J.
    pub fn magnitude(&self) -> f64 {
        let length =
            |parts: &mut dyn Iterator<Item = &FittedError>| parts.map(|of| of.value.powi(2)).sum::<f64>().sqrt();
        match &self.components[..] {
            [one] => one.value,
            several if several.iter().any(FittedError::is_significant) => {
                length(&mut several.iter().filter(|estimate| estimate.is_significant()))
            }
            several => length(&mut several.iter()),
        }
    }
}

/// What a scan tells of a film.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The errors that are named, the surest first.
    pub named: Vec<NamedError>,
    /// Whether all significant errors are named. Where a film has more than 16 of them, it is
    /// another film, or its tiles have expected errors that were not stated.
    pub is_complete: bool,
    /// The film that explains the readings: named errors without components that are noise, and the
    /// most probable expected ones.
    pub tiles: Vec<Tile>,
    /// The errors of each tile in this film, in mm, radians, or as fractions.
    pub errors: Vec<PerTileError<f64>>,
    /// The parameters of the scan.
    pub scan: ScanParameters,
    /// Readings less those of the film that was found, in tesla.
    pub residuals_t: Vec<DVec3>,
    /// Sum of the squares of residuals over those of the noise, and of expected errors over their
    /// deviations.
    pub chi_squared: f64,
    /// Its expectation: the number of readings less that of the free numbers.
    pub degrees_of_freedom: usize,
    /// The natural logarithm of the probability of a larger one.
    pub ln_probability: f64,
    /// Standard deviations of all errors of tiles before and after the scan.
    pub narrowed: Vec<NarrowedError>,
    /// Pairs of errors that look alike, the most alike first.
    pub similar: Vec<SimilarErrors>,
}

/// Probability of a residual below which noise and expected errors do not explain it.
const IMPLAUSIBLE: f64 = 1e-4;

impl Diagnosis {
    /// Whether the residual is too large for the noise: the film has errors of another kind, or the
    /// noise is larger than stated.
    pub fn is_residual_too_large(&self) -> bool {
        self.ln_probability < IMPLAUSIBLE.ln()
    }

    /// Root mean square of the residual of a component, in tesla.
    pub fn residual_t(&self) -> f64 {
        let squares: f64 = self.residuals_t.iter().map(|residual| residual.length_squared()).sum();
        (squares / (3 * self.residuals_t.len().max(1)) as f64).sqrt()
    }
}
