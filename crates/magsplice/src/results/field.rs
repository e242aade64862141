//! The field at points.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{PointErrors, Quantity, Tile};
use serde::Serialize;

use super::source::Source;
use super::table::ColumnQuantity;
use crate::film::Film;

/// Units of round-off of coordinates up to which a point is on a face but for round-off: sums of
/// decimal numbers differ by a few.
const FACE_ROUNDINGS: f64 = 16.0;

/// Most pairs of a point and a tile that are searched for points on faces: a tenth of a second.
const MOST_PAIRS: usize = 10_000_000;

impl Film {
    /// Words for points that are on a face or an edge of a tile but for round-off, where B jumps or
    /// is unbounded. `None` without such points. Of many points, the first are searched.
    pub fn remark_on_faces(&self, points_mm: &[DVec3]) -> Option<String> {
        let tiles = &self.layout().tiles;
        let searched = points_mm.iter().take(MOST_PAIRS / tiles.len().max(1));
        let at_face =
            |point: &DVec3| Some((*point, tiles.iter().find(|named| is_nearly_on_face(&named.tile, *point))?));
        let mut found = searched.filter_map(at_face);
        let (point, named) = found.next()?;
        let points = match found.count() {
            0 => "1 point is".to_owned(),
            others => format!("{} points are", others + 1),
        };
        Some(format!(
            "{points} on a face or an edge of a tile but for round-off, such as ({}, {}, {}) mm of \"{}\": B there is that \
             of either side of the face, and near an edge it has no limit; move the point by 1e-9 mm",
            point.x, point.y, point.z, named.name
        ))
    }
}

/// Whether a point is on a face of a tile but for round-off, and not exactly.
fn is_nearly_on_face(tile: &Tile, point: DVec3) -> bool {
    let (position, half) = (tile.position(), 0.5 * tile.size());
    let local = tile.rotation().inverse() * (point - position);
    let from_face = local.abs() - half;
    let largest = point.abs().max(position.abs()).max(half).max_element();
    let round_off = FACE_ROUNDINGS * f64::EPSILON * largest;
    let is_face = |axis: usize| {
        let is_exact = tile.rotation() == DQuat::IDENTITY
            && [-half[axis], half[axis]].iter().any(|side| position[axis] + side == point[axis]);
        from_face[axis].abs() <= round_off && !is_exact
    };
    from_face.max_element() <= round_off && (0..3).any(is_face)
}

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
