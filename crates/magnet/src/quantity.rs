//! Field quantities and the vacuum permeability.

/// A field quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Quantity {
    /// Flux density B = mu0 H + J, in tesla.
    FluxDensity,
    /// Field strength H, in ampere per metre.
    FieldStrength,
    /// Polarization J = mu0 M of the tile that owns the point, in tesla; zero outside all tiles.
    Polarization,
}

/// Vacuum permeability in T m / A (CODATA 2022).
pub const MU_0: f64 = 1.256_637_061_27e-6;
