//! The stiffness of the elastic layer, from forces and readings.

use glam::{DMat3, DVec3};
use magsplice_decouple::PerAxis;
use magsplice_magnet::Axis;
use magsplice_scan::Exclusion;
use magsplice_sensor::{LocateError, Located, Stiffness, StiffnessError};
use serde::Serialize;

use super::head_fits::HeadFits;
use super::readings::FilmReadings;
use super::scan::ExcludedReadings;
use super::significant::number;
use super::source::Source;
use crate::film_error::FilmError;

/// Largest ratio of the stiffness to that of Hooke's law, or of that to it: moduli of elastomers
/// are known to a factor of ten, and units of forces differ by a hundred or a thousand.
const MOST_RATIO: f64 = 50.0;

/// Least share of the coefficients of a force, in the fit to displacements along all three axes,
/// that its own axis has: axes turned by 60 degrees have it. Axes along which the film moves alike
/// have a half each.
const OWN_SHARE: f64 = 0.25;

/// Least share of the variation of a force that the fit explains: other forces are noise.
const EXPLAINED: f64 = 0.5;

/// Least deviation of the displacement along an axis over the largest, without which a force along
/// it tells nothing.
const LEAST_MOTION: f64 = 0.2;

/// Added to the correlations of the displacements, so that those along a line have a fit too, with
/// equal shares: far above round-off and the noise of a sensor, far below a measured correlation.
const RIDGE: f64 = 1e-3;

/// Most rows by which forces are tried to be late or early against the readings.
const MOST_SHIFT: i64 = 10;

/// Least number of pairs for which another shift of the rows is no accident.
const LEAST_SHIFTED: usize = 12;

/// Unexplained share of the forces over that with the rows as they are, below which a shift of the
/// rows is named: the residual is half.
const SHIFTED: f64 = 0.25;

/// Unexplained share of the forces up to which no shift is looked for: a residual of a tenth.
const GOOD: f64 = 0.01;

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
    /// Axes whose force follows displacements along other axes, if the film moves along all.
    #[serde(skip)]
    pub exchanged: Vec<Axis>,
    /// Rows by which the forces are later than the readings, if they fit them far better so.
    #[serde(skip)]
    pub late_rows: Option<i64>,
    /// Readings that the fit of an axis does not use, though it has other forces.
    pub excluded: ExcludedReadings,
    /// Other axes or another unit with which readings without a position have one.
    #[serde(skip)]
    pub hint: Option<String>,
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
            return Err(FilmError::Stiffness { axis, error, hint: self.hint.clone() });
        }
        let per_axis = |[x, y, z]: [Result<Stiffness, StiffnessError>; 3]| PerAxis { x: x.ok(), y: y.ok(), z: z.ok() };
        let displacements_mm = self.displacement_mm();
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
            exchanged: exchanged(forces_n, &displacements_mm),
            late_rows: late_rows(forces_n, &displacements_mm),
            excluded: ExcludedReadings::new(&exclusions, numbers),
            hint: self.hint.clone(),
            of_head: self.of_head.as_ref().map_or_else(Vec::new, HeadFits::remarks),
        })
    }
}

/// Axes whose force follows displacements along other axes.
fn exchanged(forces_n: &[DVec3], displacements_mm: &[DVec3]) -> Vec<Axis> {
    let pairs = || forces_n.iter().zip(displacements_mm).filter(|(of, by)| of.is_finite() && by.is_finite());
    let count = pairs().count().max(1) as f64;
    let mean = |of: &dyn Fn(&DVec3, &DVec3) -> DVec3| pairs().map(|(force, by)| of(force, by)).sum::<DVec3>() / count;
    let (force, moved) = (mean(&|force, _| *force), mean(&|_, by| *by));
    // In units of their deviations, so that coefficients are comparable.
    let deviation = mean(&|_, by| (*by - moved).powf(2.0)).map(f64::sqrt);
    let unit = |by: &DVec3| (*by - moved) / deviation;
    let correlations = DMat3::from_cols_array_2d(&[0, 1, 2].map(|j| mean(&|_, by| unit(by)[j] * unit(by)).to_array()));
    let inverse = (correlations + DMat3::from_diagonal(DVec3::splat(RIDGE))).inverse();
    let is_exchanged = |axis: &Axis| {
        let i = axis.index();
        let covariances = mean(&|of, by| (of - force)[i] * unit(by));
        let fitted = inverse * covariances;
        let explained = fitted.dot(covariances) / mean(&|of, _| (of - force).powf(2.0))[i];
        let own_share = fitted[i].powi(2) / fitted.length_squared();
        deviation[i] > LEAST_MOTION * deviation.max_element() && explained > EXPLAINED && own_share < OWN_SHARE
    };
    Axis::ALL.into_iter().filter(is_exchanged).collect()
}

/// Rows by which forces are later than the displacements of a film, negative if earlier. `None` if
/// no shift halves the residual of straight lines.
fn late_rows(forces_n: &[DVec3], displacements_mm: &[DVec3]) -> Option<i64> {
    let (rows, as_they_are) = (forces_n.len() as i64, unexplained(forces_n, displacements_mm, 0)?);
    let of_shift = |shift: i64| Some((shift, unexplained(forces_n, displacements_mm, shift)?));
    let tried = (-MOST_SHIFT..=MOST_SHIFT).filter(|shift| shift.abs() < rows).filter_map(of_shift);
    let (shift, least) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (as_they_are > GOOD && least < SHIFTED * as_they_are).then_some(shift)
}

/// The share of the variation of the forces along all axes that straight lines do not explain,
/// where each force belongs to the displacement `shift` rows before. `None` for too few pairs.
fn unexplained(forces_n: &[DVec3], displacements_mm: &[DVec3], shift: i64) -> Option<f64> {
    let (mut sum, mut axes) = (0.0, 0);
    for axis in 0..3 {
        let displacement = |row: usize| displacements_mm.get(usize::try_from(row as i64 - shift).ok()?);
        let pair = |(row, force): (usize, &DVec3)| Some((displacement(row)?[axis], force[axis]));
        let pairs = forces_n.iter().enumerate().filter_map(pair).filter(|(d, f)| d.is_finite() && f.is_finite());
        let pairs: Vec<(f64, f64)> = pairs.collect();
        if pairs.len() < LEAST_SHIFTED {
            continue;
        }
        let count = pairs.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
        let (d, f) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
        let (dd, ff) = (mean(&|pair| (pair.0 - d).powi(2)), mean(&|pair| (pair.1 - f).powi(2)));
        let df = mean(&|pair| (pair.0 - d) * (pair.1 - f));
        if dd * ff > 0.0 {
            sum += 1.0 - df * df / (dd * ff);
            axes += 1;
        }
    }
    (axes > 0).then(|| sum / f64::from(axes))
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

    /// Exchanged axes, rows that are shifted, and axes with no stiffness, a negative one, or one of
    /// 0 within its error, one sentence each.
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
        let late = self.late_rows.map(|rows| {
            let (count, when) = (rows.abs(), if rows > 0 { "before" } else { "after" });
            let rows = if count == 1 { "row" } else { "rows" };
            format!(
                "the forces fit the readings {count} {rows} {when} far better than those of their own rows: forces and \
                 readings are not in step, or the layer creeps; move the columns against each other"
            )
        });
        let negative = self.negative().into_iter().map(|axis| {
            format!(
                "the stiffness along {axis} is negative: the force is positive where the film moves along -{axis}; \
                 reverse the sign of the forces, or check the axes of the sensor"
            )
        });
        let exchanged = self.exchanged.iter().map(|axis| {
            format!(
                "the force along {axis} follows displacements along other axes, not along {axis}: the columns of the \
                 forces or of the sensor are exchanged"
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
        let of_axes = exchanged.chain(without).chain(undetermined).chain(negative);
        hint.chain(self.of_head.iter().cloned()).chain(late).chain(unit).chain(of_axes).collect()
    }
}
