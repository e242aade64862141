//! The changes of the readings by the parameters of a scan, to first order.

use glam::{DMat3, DVec3};
use nalgebra::{DMatrix, DVector};

use crate::parameters::{FreeParameters, ScanParameter};

/// Eigenvalue of the scaled normal matrix, over the largest, from which on a combination of the
/// parameters of the scan changes the field.
const DETERMINED: f64 = 1e-12;

/// The space of the changes of readings that the free parameters of a scan explain.
pub(crate) struct ScanColumns {
    /// An orthonormal basis.
    basis: DMatrix<f64>,
}

impl ScanColumns {
    /// `field_t` and `gradients` are those at the places of the sensor; `reading` gives its reading
    /// without offset from the field.
    pub(crate) fn new(field_t: &[DVec3], gradients: &[DMat3], reading: DMat3, free: FreeParameters) -> ScanColumns {
        let of_scan: Vec<DVector<f64>> = ScanParameter::ALL
            .into_iter()
            .filter(|parameter| free.contains(*parameter))
            .filter_map(|parameter| {
                let of_place = |place: usize| match parameter {
                    ScanParameter::Strength => reading * field_t[place],
                    ScanParameter::Offset(axis) => axis.unit(),
                    ScanParameter::Rotation(axis) => reading * field_t[place].cross(axis.unit()),
                    ScanParameter::Start(axis) => reading * gradients[place].col(axis.index()),
                };
                column((0..field_t.len()).map(of_place)).try_normalize(0.0)
            })
            .collect();
        if of_scan.is_empty() {
            return ScanColumns { basis: DMatrix::zeros(3 * field_t.len(), 0) };
        }
        let of_scan = DMatrix::from_columns(&of_scan);
        let normal = (of_scan.transpose() * &of_scan).symmetric_eigen();
        let least = DETERMINED * normal.eigenvalues.max();
        let determined = |(vector, value): (nalgebra::DVectorView<f64>, &f64)| {
            (*value > least).then(|| &of_scan * vector / value.sqrt())
        };
        let basis: Vec<DVector<f64>> =
            normal.eigenvectors.column_iter().zip(&normal.eigenvalues).filter_map(determined).collect();
        ScanColumns { basis: DMatrix::from_columns(&basis) }
    }

    /// The part of a change that the parameters do not explain.
    pub(crate) fn unexplained(&self, of: DVector<f64>) -> DVector<f64> {
        let along = self.basis.tr_mul(&of);
        of - &self.basis * along
    }
}

/// Vectors as one column.
pub(crate) fn column(vectors: impl Iterator<Item = DVec3>) -> DVector<f64> {
    DVector::from_vec(vectors.flat_map(|vector| vector.to_array()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_that_change_no_reading_explain_nothing() {
        let of = |field_t: DVec3, free| ScanColumns::new(&[field_t; 2], &[DMat3::ZERO; 2], DMat3::IDENTITY, free);
        let change = || DVector::from_element(6, 1.0);
        let (strength, all) = (FreeParameters { strength: true, ..FreeParameters::NONE }, FreeParameters::ALL);
        assert_eq!(of(DVec3::ZERO, strength).unexplained(change()), change());
        assert!(of(DVec3::ONE, strength).unexplained(change()).norm() < 1e-15);
        assert!(of(DVec3::ZERO, all).unexplained(change()).norm() < 1e-15);
    }
}
