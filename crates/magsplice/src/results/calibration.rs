//! The stiffness of the elastic layer, from forces and readings.

use glam::DVec3;
use magsplice_decouple::PerAxis;
use magsplice_magnet::Axis;
use magsplice_scan::Exclusion;
use magsplice_sensor::{LocateError, Located, Stiffness, StiffnessError};
use serde::Serialize;

use super::readings::FilmReadings;
use super::scan::ExcludedReadings;
use super::source::Source;
use crate::film_error::FilmError;

/// The stiffness along x, y, z, in N/mm and N. An axis without forces or without displacements has
/// none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmCalibration {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of readings.
    pub readings: usize,
    /// Stiffness of the elastic layer of the layout by Hooke's law. `None` without one.
    pub hooke_n_per_mm: Option<DVec3>,
    /// By displacements from the field of the layout.
    pub by_field: PerAxis<Option<Stiffness>>,
    /// By those of the closed form. `None` without an ideal film.
    pub by_closed_form: Option<PerAxis<Option<Stiffness>>>,
    /// The reasons why axes have no stiffness by the field of the layout.
    pub without_stiffness: PerAxis<Option<String>>,
    /// Readings that the fit of an axis does not use, though it has other forces.
    pub excluded: ExcludedReadings,
}

impl FilmReadings {
    /// The stiffness that these readings give, of films under forces in newton, for readings with
    /// `numbers`, such as lines of a file. A component of a force may be missing: it is NaN.
    /// Readings without a position are not used.
    ///
    /// # Errors
    /// [`FilmError::Stiffness`] if no axis has a stiffness.
    ///
    /// # Panics
    /// If there are not as many forces and numbers as readings.
    pub fn calibrate(&self, forces_n: &[DVec3], numbers: &[u64]) -> Result<FilmCalibration, FilmError> {
        assert_eq!(numbers.len(), forces_n.len(), "a number for each reading");
        let is_measured = Axis::ALL.map(|axis| forces_n.iter().any(|force_n| force_n[axis.index()].is_finite()));
        let lacks = |force_n: &DVec3| (0..3).any(|axis| is_measured[axis] && !force_n[axis].is_finite());
        let mut exclusions: Vec<Option<Exclusion>> = self
            .found
            .iter()
            .zip(forces_n)
            .map(|(found, force_n)| match found {
                Err(LocateError::Saturated) => Some(Exclusion::Saturated),
                found if Located::of(found).is_none() || lacks(force_n) => Some(Exclusion::Incomplete),
                _ => None,
            })
            .collect();
        let mut fit = |displacements_mm: &[DVec3]| {
            Axis::ALL.map(|axis| {
                // The film moves by the opposite of the sensor's displacement.
                let displacements: Vec<f64> = displacements_mm.iter().map(|moved| -moved[axis.index()]).collect();
                let forces: Vec<f64> = forces_n.iter().map(|force| force[axis.index()]).collect();
                Stiffness::fit(&displacements, &forces).map(|(line, outliers)| {
                    for reading in outliers {
                        exclusions[reading].get_or_insert(Exclusion::Outlier);
                    }
                    line
                })
            })
        };
        let by_field = fit(&self.displacement_mm());
        let by_closed_form = self.closed_form_mm.as_deref().map(&mut fit);
        if let Some((axis, error)) = first_error(&by_field) {
            return Err(FilmError::Stiffness { axis, error });
        }
        let per_axis = |[x, y, z]: [Result<Stiffness, StiffnessError>; 3]| PerAxis { x: x.ok(), y: y.ok(), z: z.ok() };
        let [x, y, z] = by_field.map(|of_axis| of_axis.err().map(|error| error.to_string()));
        Ok(FilmCalibration {
            source: self.source.clone(),
            readings: forces_n.len(),
            hooke_n_per_mm: self.elastomer.map(|layer| layer.hooke_n_per_mm()),
            by_field: per_axis(by_field),
            by_closed_form: by_closed_form.map(per_axis),
            without_stiffness: PerAxis { x, y, z },
            excluded: ExcludedReadings::new(&exclusions, numbers),
        })
    }
}

/// The error of the first axis, if all have one.
fn first_error(axes: &[Result<Stiffness, StiffnessError>; 3]) -> Option<(Axis, StiffnessError)> {
    let errors = Axis::ALL.into_iter().zip(axes).map(|(axis, of)| of.as_ref().err().map(|error| (axis, *error)));
    let errors: Vec<(Axis, StiffnessError)> = errors.collect::<Option<_>>()?;
    errors.first().copied()
}

impl FilmCalibration {
    /// The axes along which the film is pulled the more the more it moves: their forces or readings
    /// have the wrong sign, or belong to other axes.
    pub fn negative(&self) -> Vec<Axis> {
        let axes = [self.by_field.x, self.by_field.y, self.by_field.z];
        let is_negative = |line: &Stiffness| line.stiffness + line.stiffness_95 < 0.0;
        Axis::ALL.into_iter().filter(|axis| axes[axis.index()].as_ref().is_some_and(is_negative)).collect()
    }

    /// Axes without a stiffness or with a negative one, one sentence each.
    pub fn remarks(&self) -> Vec<String> {
        let reasons = [&self.without_stiffness.x, &self.without_stiffness.y, &self.without_stiffness.z];
        let without = Axis::ALL.into_iter().zip(reasons);
        let without = without
            .filter_map(|(axis, reason)| reason.as_ref().map(|reason| format!("no stiffness along {axis}: {reason}")));
        let negative = self.negative().into_iter().map(|axis| {
            format!(
                "the stiffness along {axis} is negative: the force is positive where the film moves along -{axis}; \
                 reverse the sign of the forces, or check the axes of the sensor"
            )
        });
        without.chain(negative).collect()
    }
}
