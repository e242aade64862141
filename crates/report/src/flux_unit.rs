//! Units of flux density in which numbers have few digits.

use glam::DVec3;

/// A unit of flux density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FluxUnit {
    pub(crate) name: &'static str,
    /// How many of this unit are one tesla.
    pub(crate) per_t: f64,
}

const UNITS: [FluxUnit; 4] = [
    FluxUnit { name: "T", per_t: 1.0 },
    FluxUnit { name: "mT", per_t: 1e3 },
    FluxUnit { name: "\u{b5}T", per_t: 1e6 },
    FluxUnit { name: "nT", per_t: 1e9 },
];

/// The largest component of the finite ones of these fields, in tesla.
pub(crate) fn largest_component_t(fields_t: impl Iterator<Item = DVec3>) -> f64 {
    fields_t.filter(|b| b.is_finite()).map(|b| b.abs().max_element()).fold(0.0, f64::max)
}

/// The largest unit in which `most_t` is at least 0.5, or nT.
pub(crate) fn flux_unit(most_t: f64) -> FluxUnit {
    UNITS.into_iter().find(|unit| most_t * unit.per_t >= 0.5).unwrap_or(UNITS[3])
}
