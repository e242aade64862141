//! Which models no other is better than, in time and error both.

use crate::measure::{Measured, Measurements};

/// An error that models are compared by.
pub(crate) type Error = fn(&Measured) -> f64;

/// The worst and the middle one.
pub(crate) const ERRORS: [(&str, Error); 2] = [("largest", |m| m.worst), ("median", |m| m.median)];

/// Those that serve most points and than which none is both faster and nearer, from the most to the least exact.
pub(crate) fn front(at: &Measurements, error: Error) -> Vec<&Measured> {
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

/// Peers that are on the front: none of our models is as fast and as near.
pub(crate) fn peers_in_front(at: &Measurements, error: Error) -> Vec<&Measured> {
    front(at, error).into_iter().filter(|m| !m.model.is_ours()).collect()
}
