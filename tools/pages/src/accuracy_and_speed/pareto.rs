//! The Pareto front: contenders that no other beats in both time and error.

use super::measure::{Measured, Measurements};

/// The kind of error for comparisons.
pub(crate) type ErrorMeasure = fn(&Measured) -> f64;

/// The largest and the median error.
pub(crate) const ERROR_MEASURES: [(&str, ErrorMeasure); 2] = [("largest", |m| m.worst), ("median", |m| m.median)];

/// The front, from the smallest to the largest error. Contenders that refuse at least half of the
/// points are excluded.
pub(crate) fn pareto_front(at: &Measurements, error: ErrorMeasure) -> Vec<&Measured> {
    let mut all: Vec<&Measured> = at.measured.iter().filter(|m| m.refused < 0.5).collect();
    all.sort_by(|a, b| error(a).total_cmp(&error(b)).then(a.ns.total_cmp(&b.ns)));
    let mut fastest = f64::INFINITY;
    all.retain(|m| {
        let better = m.ns < fastest;
        fastest = fastest.min(m.ns);
        better
    });
    all
}

/// Peers on the front, where no method of magsplice is both as fast and as exact.
pub(crate) fn peers_in_front(at: &Measurements, error: ErrorMeasure) -> Vec<&Measured> {
    pareto_front(at, error).into_iter().filter(|m| !m.contender.is_magsplice()).collect()
}
