//! The table `[[lattice]]`.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::tables::material::RecoilPermeability;

/// A film cut along lines parallel to x and y. Each cell holds one tile, unless its pattern is zero
/// along both axes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LatticeTable {
    /// First part of the names of its tiles, as in NAME-x2-y1. Default: lattice-1, lattice-2 and so
    /// on, numbered in the order of the file.
    pub(crate) name: Option<String>,
    /// Lower corner, in mm.
    #[schemars(extend("example" = "[-10.0, -10.0, 0.0]"))]
    pub(crate) start_mm: [f64; 3],
    /// Height along z, in mm.
    pub(crate) height_mm: f64,
    /// Magnitude of every tile's polarization, in T. Give either this or component_t.
    pub(crate) strength_t: Option<f64>,
    /// Factor of the pattern, in T: the polarization is this times the pattern. Give either this or
    /// strength_t.
    pub(crate) component_t: Option<f64>,
    /// Relative recoil permeability of its tiles. Default: that of [material].
    pub(crate) recoil_permeability: Option<RecoilPermeability>,
    /// Intervals along x.
    #[schemars(extend("example" = "[{ widths_mm = [3.3, 1.7], pattern = [1, 0] }]"))]
    pub(crate) x: Vec<LatticeSection>,
    /// Intervals along y. Default: the intervals along x.
    #[schemars(extend("example" = "[{ widths_mm = [3.3, 1.7], pattern = [1, 0] }]"))]
    pub(crate) y: Option<Vec<LatticeSection>>,
}

/// Consecutive intervals along one axis of a lattice.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LatticeSection {
    /// Widths of the intervals, in mm.
    #[schemars(extend("example" = "[3.3, 1.7]"))]
    pub(crate) widths_mm: Vec<f64>,
    /// For each interval the component of the polarization's direction along this axis.
    #[schemars(extend("example" = "[1, 0]"))]
    pub(crate) pattern: Vec<f64>,
    /// How many times the section is repeated. Default: 1.
    pub(crate) times: Option<usize>,
}
