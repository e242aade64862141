//! Units of flux density in which numbers have few digits.

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

/// The largest unit in which `most_t` is at least 0.5, or nT.
pub(crate) fn flux_unit(most_t: f64) -> FluxUnit {
    UNITS.into_iter().find(|unit| most_t * unit.per_t >= 0.5).unwrap_or(UNITS[3])
}
