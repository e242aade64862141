//! The field at points.

use glam::{DMat3, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{PointErrors, Quantity};
use serde::Serialize;

use super::source::Source;
use super::table::ColumnQuantity;

/// A field at points, whose values are in the columns of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldAtPoints {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of points.
    pub points: usize,
}

/// A quantity at points: a field, or the gradient of B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointQuantity {
    /// A vector.
    Field(Quantity),
    /// The nine derivatives of B, those of one component together.
    Gradient,
}

impl PointQuantity {
    /// B.
    pub const FLUX_DENSITY: PointQuantity = PointQuantity::Field(Quantity::FluxDensity);

    /// Whether it may be computed to a tolerance. Others are always exact.
    pub fn has_accuracy(self) -> bool {
        !matches!(self, PointQuantity::Field(Quantity::Polarization) | PointQuantity::Gradient)
    }

    /// The columns of the quantity, named with their units; `values` point by point.
    pub fn columns(self, values: Vec<f64>) -> ColumnQuantity {
        let (name, components): (_, &[_]) = match self {
            PointQuantity::Field(Quantity::FieldStrength) => ("h_a_per_m", &["hx_a_per_m", "hy_a_per_m", "hz_a_per_m"]),
            PointQuantity::Field(Quantity::Polarization) => ("j_t", &["jx_t", "jy_t", "jz_t"]),
            PointQuantity::Field(_) => ("b_t", &["bx_t", "by_t", "bz_t"]),
            PointQuantity::Gradient => (
                "gradient_b_t_per_mm",
                &[
                    "dbx_dx_t_per_mm",
                    "dbx_dy_t_per_mm",
                    "dbx_dz_t_per_mm",
                    "dby_dx_t_per_mm",
                    "dby_dy_t_per_mm",
                    "dby_dz_t_per_mm",
                    "dbz_dx_t_per_mm",
                    "dbz_dy_t_per_mm",
                    "dbz_dz_t_per_mm",
                ],
            ),
        };
        ColumnQuantity { name, components, values, is_whole: false }
    }

    /// The values at points, for [`PointQuantity::columns`], and the points without a field, which
    /// have NaN.
    pub fn values(self, scene: &Scene, points: &[DVec3]) -> (Vec<f64>, Result<(), PointErrors>) {
        match self {
            PointQuantity::Field(quantity) => {
                let mut field = vec![DVec3::ZERO; points.len()];
                let evaluated = scene.field_into(quantity, points, &mut field);
                (field.iter().flat_map(DVec3::to_array).collect(), evaluated)
            }
            PointQuantity::Gradient => {
                let mut gradient = vec![DMat3::ZERO; points.len()];
                let evaluated = scene.gradient_into(Quantity::FluxDensity, points, &mut gradient);
                (gradient.iter().flat_map(|g| g.transpose().to_cols_array()).collect(), evaluated)
            }
        }
    }
}
