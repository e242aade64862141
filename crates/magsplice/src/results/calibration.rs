//! The stiffness of the elastic layer, from forces and readings.

use glam::DVec3;
use magsplice_decouple::PerAxis;
use magsplice_magnet::Axis;
use magsplice_scan::Exclusion;
use magsplice_sensor::{LocateError, Located, Stiffness, StiffnessError};
use serde::Serialize;

use super::force_log::LogFault;
use super::head_fits::HeadFits;
use super::readings::FilmReadings;
use super::scan::ExcludedReadings;
use super::significant::number;
use super::source::Source;
use crate::film_error::FilmError;

/// Largest ratio of the stiffness to that of Hooke's law, or of that to it: moduli of elastomers
/// are known to a factor of ten, and units of forces differ by a hundred or a thousand.
const MOST_RATIO: f64 = 50.0;

/// Distance from the reference point, in millimetres, from which on a film without a force was
/// moved by an offset. Shims set heights to some hundredths of a millimetre.
const MOST_AT_REST_MM: f64 = 0.1;

/// What the intervals of a film with errors of its tiles lack. For ten films made by hand they held
/// the stiffness in 0 to 5 of 10 cases, and it was off by up to 10 %.
const ERRORS_OF_TILES: &str = "the intervals do not contain the errors of the tiles that [tolerance] states: the layout \
                               of the film as made, by `diagnose --scan ... -o found.toml`, has its displacements";

/// The reason for no stiffness along an axis without a column of forces.
const NO_FORCES: &str = "no force along this axis";

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
    /// Faults of the log of forces and readings.
    #[serde(skip)]
    pub log_faults: Vec<LogFault>,
    /// Readings that the fit of an axis does not use, though it has other forces.
    pub excluded: ExcludedReadings,
    /// Other axes or another unit with which readings without a position have one.
    #[serde(skip)]
    pub hint: Option<String>,
    /// Whether the reference point is taken for the position at rest, without readings there.
    #[serde(skip)]
    pub assumes_rest: bool,
    /// Whether the layout states errors of its tiles, which the intervals do not contain.
    #[serde(skip)]
    pub states_errors: bool,
    /// Remarks on the readings of all sensors of a head.
    #[serde(skip)]
    pub of_head: Vec<String>,
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
        let fit = |displacements_mm: &[DVec3]| {
            Axis::ALL.map(|axis| {
                // The film moves by the opposite of the sensor's displacement.
                let displacements: Vec<f64> = displacements_mm.iter().map(|moved| -moved[axis.index()]).collect();
                let forces: Vec<f64> = forces_n.iter().map(|force| force[axis.index()]).collect();
                Stiffness::fit(&displacements, &forces)
            })
        };
        let by_field = fit(&self.displacement_mm()).map(|fitted| {
            fitted.map(|(line, outliers)| {
                for reading in outliers {
                    exclusions[reading].get_or_insert(Exclusion::Outlier);
                }
                line
            })
        });
        // Its outliers are errors of the closed form, not of forces.
        let line = |fitted: Result<(Stiffness, Vec<usize>), StiffnessError>| fitted.map(|(line, _)| line);
        let by_closed_form = self.closed_form_mm.as_deref().map(|moved_mm| fit(moved_mm).map(line));
        let displacements_mm = self.displacement_mm();
        let log_faults = LogFault::of_log(forces_n, &displacements_mm);
        if let Some((axis, error)) = first_error(&by_field) {
            let hint = log_faults.first().map(ToString::to_string).or(self.hint.clone());
            return Err(FilmError::Stiffness { axis, error, hint });
        }
        let per_axis = |[x, y, z]: [Result<Stiffness, StiffnessError>; 3]| PerAxis { x: x.ok(), y: y.ok(), z: z.ok() };
        let reason = |axis: usize| {
            let error = by_field[axis].err()?;
            Some(if is_measured[axis] { error.to_string() } else { NO_FORCES.to_owned() })
        };
        let [x, y, z] = [0, 1, 2].map(reason);
        Ok(FilmCalibration {
            source: self.source.clone(),
            readings: forces_n.len(),
            hooke_n_per_mm: self.elastomer.map(|layer| layer.hooke_n_per_mm()),
            by_field: per_axis(by_field),
            by_closed_form: by_closed_form.map(per_axis),
            without_stiffness: PerAxis { x, y, z },
            log_faults,
            excluded: ExcludedReadings::new(&exclusions, numbers),
            hint: self.hint.clone(),
            assumes_rest: self.assumes_rest,
            states_errors: self.states_errors,
            of_head: self.of_head.as_ref().map_or_else(Vec::new, HeadFits::remarks),
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

    /// The axes whose stiffness is 0 within its error.
    fn undetermined(&self) -> impl Iterator<Item = Axis> {
        let axes = [self.by_field.x, self.by_field.y, self.by_field.z];
        let has_zero = |line: &Stiffness| line.stiffness.abs() <= line.stiffness_95;
        Axis::ALL.into_iter().filter(move |axis| axes[axis.index()].as_ref().is_some_and(has_zero))
    }

    /// Words for a film that is not at the reference point without a force, where rest is assumed.
    fn not_at_rest(&self) -> Option<String> {
        let at_rest = |axis: Axis| {
            let line = [self.by_field.x, self.by_field.y, self.by_field.z][axis.index()]?;
            let [moved_mm, error_mm] = [-line.force_at_rest, line.force_at_rest_95.abs()].map(|n| n / line.stiffness);
            let is_sure = line.stiffness_95 < line.stiffness.abs() && error_mm.abs() < moved_mm.abs();
            (is_sure && moved_mm.abs() > MOST_AT_REST_MM).then_some((axis, moved_mm))
        };
        let moved = Axis::ALL.into_iter().filter_map(at_rest);
        let (axis, moved_mm) = moved.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).filter(|_| self.assumes_rest)?;
        Some(format!(
            "without a force the film is {} mm along {axis} from where the sensor is at its reference point: the sensor or \
             the load cell has an offset, the tiles have errors, or the film rests elsewhere, and the stiffness has an error; give readings at \
             rest, and set the load cell to zero",
            number(moved_mm)
        ))
    }

    /// Faults of the log, a film that is not at rest where it is assumed to be, and axes with no
    /// stiffness, a negative one, or one of 0 within its error, one sentence each.
    pub fn remarks(&self) -> Vec<String> {
        let hint = self.hint.iter().cloned();
        let reasons = [&self.without_stiffness.x, &self.without_stiffness.y, &self.without_stiffness.z];
        let without = Axis::ALL.into_iter().zip(reasons);
        let without = without
            .filter_map(|(axis, reason)| Some((axis, reason.as_ref().filter(|reason| *reason != NO_FORCES)?)))
            .map(|(axis, reason)| format!("no stiffness along {axis}: {reason}"));
        let undetermined = self.undetermined().map(|axis| {
            format!(
                "the stiffness along {axis} is 0 within its error: the film hardly moves along {axis}, or the forces are not \
                 those of the readings"
            )
        });
        let log = self.log_faults.iter().map(ToString::to_string);
        let errors = self.states_errors.then(|| ERRORS_OF_TILES.to_owned());
        let negative = self.negative().into_iter().map(|axis| {
            format!(
                "the stiffness along {axis} is negative: the force is positive where the film moves along -{axis}; \
                 reverse the sign of the forces, or check the axes of the sensor"
            )
        });
        let stiffness = |line: &Option<Stiffness>| line.as_ref().map_or(f64::NAN, |line| line.stiffness);
        let PerAxis { x, y, z } = &self.by_field;
        let ratios = self.hooke_n_per_mm.map(|hooke| DVec3::new(stiffness(x), stiffness(y), stiffness(z)) / hooke);
        let unit =
            ratios.and_then(|of| of.abs().to_array().into_iter().find(|of| *of > MOST_RATIO || *of < 1.0 / MOST_RATIO));
        let unit = unit.map(|ratio| {
            format!(
                "the stiffness is {} times that of Hooke's law with the layer of the layout: the forces have another unit, or \
                 [elastomer] is of another layer",
                number(ratio)
            )
        });
        let of_axes = without.chain(undetermined).chain(negative);
        hint.chain(self.of_head.iter().cloned())
            .chain(log)
            .chain(self.not_at_rest())
            .chain(errors)
            .chain(unit)
            .chain(of_axes)
            .collect()
    }
}
