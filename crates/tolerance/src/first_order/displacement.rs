//! Displacement errors as a linear function of small changes of the readings.

use glam::DVec3;
use magsplice_decouple::{Branch, DecouplingError, Parameters, PointDecoupling};
use magsplice_ideal::IdealFilm;

use crate::evaluation_grid::SampleError;

/// Fraction of the root mean square of all sensitivities that their basis may lack. The expected
/// square of the displacement errors, over all axes, lacks at most the square of this fraction.
pub(super) const OMITTED: f64 = 1e-4;

/// The derivatives of the displacement errors by the readings.
#[derive(Clone, Debug)]
pub(crate) struct Displacement {
    /// Derivatives of the parameters over k at each point of the grid, in mm per tesla, with the
    /// signs of displacements along x, y, z.
    rows: Vec<[DVec3; 3]>,
    /// These derivatives at the reference point.
    at_reference: [DVec3; 3],
}

impl Displacement {
    /// The derivatives at the readings of the points of a grid, then of the reference point.
    pub(crate) fn new(points: &[DVec3], read_t: &[DVec3], ideal: &IdealFilm) -> Result<Displacement, SampleError> {
        let last = points.len() - 1;
        let k = ideal.wavenumber();
        let singular = SampleError::Decoupling(DecouplingError::SingularReference { at: points[last] });
        let branch = Branch::from_axis_field(read_t[last]).ok_or(singular.clone())?;
        let row = |b_t: &DVec3| {
            let (_, by_field) = Parameters::with_derivatives(*b_t, branch)?;
            Some([by_field.r_x / -k, by_field.r_y / -k, by_field.s_z / k])
        };
        let at_reference = row(&read_t[last]).ok_or(singular)?;
        let of_point =
            |(b_t, point): (&DVec3, &DVec3)| row(b_t).ok_or_else(|| SampleError::Singular { points: vec![*point] });
        let rows = read_t[..last].iter().zip(points).map(of_point).collect::<Result<_, _>>()?;
        Ok(Displacement { rows, at_reference })
    }

    /// The changes of the displacement errors, x at all points, then y, then z, by changes of the
    /// readings.
    pub(crate) fn changes_mm(&self, changes_t: &[DVec3]) -> Vec<f64> {
        let count = self.rows.len();
        let mut changes = vec![0.0; 3 * count];
        for axis in 0..3 {
            let of_reference = self.at_reference[axis].dot(changes_t[count]);
            for ((change, row), b_t) in changes[axis * count..].iter_mut().zip(&self.rows).zip(changes_t) {
                *change = row[axis].dot(*b_t) - of_reference;
            }
        }
        changes
    }

    /// The change of the displacement error at each point along an axis by a change of the reading
    /// at this point alone.
    pub(crate) fn rows(&self) -> &[[DVec3; 3]] {
        &self.rows
    }
}

/// The displacement errors in millimetres of readings at the points of a grid, then at the
/// reference point: x at all points, then y, then z.
pub(crate) fn displacement_errors_mm(
    points: &[DVec3],
    read_t: &[DVec3],
    ideal: &IdealFilm,
) -> Result<Vec<f64>, SampleError> {
    let last = points.len() - 1;
    let found = PointDecoupling::from_field(&points[..last], &read_t[..last], (points[last], read_t[last]), ideal)
        .map_err(SampleError::Decoupling)?;
    if !found.singular.is_empty() {
        return Err(SampleError::Singular { points: found.singular });
    }
    let k = ideal.wavenumber();
    let at_points: Vec<DVec3> = (0..last).filter_map(|index| found.displacement_error(index, k)).collect();
    Ok((0..3).flat_map(|axis| at_points.iter().map(move |error| error[axis])).collect())
}
