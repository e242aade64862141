//! Errors that the scan does not resolve: hardly narrowed errors and similar errors.

use magsplice_magnet::TileError;

use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::model::Linearized;
use crate::diagnosis::prior_fit::PriorFit;
use crate::diagnosis::unknowns::{Unknown, Unknowns};

/// Ratio of the standard deviations after and before the scan above which an error is unresolved.
const HARDLY_NARROWED: f64 = 0.5;

/// Correlation of the effects of two errors on the readings above which they are similar. A tenth
/// of the signal of one then remains beside the other.
const ALIKE: f64 = 0.995;

/// An error of a tile, with its standard deviations before and after the scan.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct NarrowedError {
    /// Index of the tile.
    pub tile: usize,
    /// The error.
    pub error: TileError,
    /// Standard deviation before the scan, in mm, radians, or as a fraction.
    pub before: f64,
    /// Standard deviation after the scan.
    pub after: f64,
}

/// Two errors with similar effects on the readings.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SimilarErrors {
    /// Index of the first tile, and its error.
    pub first: (usize, TileError),
    /// Index of the second tile, and its error.
    pub second: (usize, TileError),
    /// Correlation of their effects on the readings, over the noise.
    pub correlation: f64,
}

/// The errors of all tiles with their standard deviations before and after the scan, if all have
/// expected errors of these deviations.
pub(crate) fn narrowed(
    at: &Linearized,
    unknowns: &Unknowns,
    before: &[f64],
) -> Result<Vec<NarrowedError>, DiagnosisError> {
    let projected = nalgebra::DVector::zeros(before.len());
    let after = PriorFit::new(&at.gram, &projected, before)?.deviations();
    let errors = unknowns.list.iter().zip(before).zip(after.iter());
    Ok(errors
        .filter_map(|((unknown, before), after)| match unknown {
            Unknown::Tile { tile, error } if *before > 0.0 => {
                Some(NarrowedError { tile: *tile, error: *error, before: *before, after: *after })
            }
            _ => None,
        })
        .collect())
}

impl NarrowedError {
    /// Standard deviation after the scan over the standard deviation before.
    pub fn ratio(&self) -> f64 {
        self.after / self.before
    }

    /// Whether the scan hardly narrows the error.
    pub fn is_unresolved(&self) -> bool {
        self.ratio() > HARDLY_NARROWED
    }
}

/// All pairs of similar errors of tiles, the most similar first.
pub(crate) fn similar(at: &Linearized, unknowns: &Unknowns) -> Vec<SimilarErrors> {
    let errors: Vec<(usize, (usize, TileError))> = unknowns
        .list
        .iter()
        .enumerate()
        .filter_map(|(index, unknown)| match unknown {
            Unknown::Tile { tile, error } => Some((index, (*tile, *error))),
            _ => None,
        })
        .collect();
    let mut pairs = Vec::new();
    for (number, (j, second)) in errors.iter().enumerate() {
        for (i, first) in &errors[..number] {
            let correlation = at.gram[(*i, *j)] / (at.gram[(*i, *i)] * at.gram[(*j, *j)]).sqrt();
            if correlation.abs() > ALIKE {
                pairs.push(SimilarErrors { first: *first, second: *second, correlation });
            }
        }
    }
    pairs.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    pairs
}
