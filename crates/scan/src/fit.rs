//! Least-squares fit of the unknown parameters of a measured scan to the field of the tiles.

use std::ops::RangeInclusive;

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_sensor::SensedField;

use crate::exclusion::{Exclusion, Plateau};
use crate::fit_error::ScanError;
use crate::least_squares::{MADE_RESIDUAL, Scan, ScanFit};
use crate::parameters::{FreeParameters, ScanParameter, ScanParameters};
use crate::signed_axes::SignedAxes;
use crate::starts::{SIMILAR, Search, Start, starts};
use crate::units::{FLUX_DENSITIES, LENGTHS};

/// Number of standard deviations from the fit beyond which a component is an outlier. Among a
/// million normal errors, one exceeds five standard deviations in half of all scans, and six in one
/// scan of 500.
pub(crate) const OUTLIER: f64 = 6.0;

/// The standard deviation of normal errors over the median of their magnitudes.
pub(crate) const DEVIATION_OVER_MEDIAN: f64 = 1.482_602_218_505_602;

/// Smallest assumed noise, as a fraction of the root mean square of the readings. Computed readings
/// have six digits or more, and the rounding of the last one has no outliers; no sensor is better.
const LEAST_NOISE: f64 = 1e-6;

/// Largest number of rounds that search and exclude outliers.
const OUTLIER_ROUNDS: usize = 20;

/// Largest share of outliers. Beyond it the scan belongs to another film.
pub(crate) const MOST_OUTLIERS: f64 = 0.2;

/// Residual over the noise of the sensor, and over the root mean square of the readings, up to
/// which other starts are not tried.
const EXPECTED_RESIDUAL: f64 = 3.0;
const SMALL_RESIDUAL: f64 = 0.01;

/// Residual over the noise of the sensor up to which it may be noise: datasheets state noise to a
/// factor of two.
pub const KNOWN_NOISE: f64 = 2.0;

/// Differences of strength, and rotation in radians, of a fit close to the perfect scan. Its
/// residual may be that of a film as made.
const CLOSE: f64 = 0.3;

/// Residual of a fit from another start, over the residual from a perfect scan, above which the
/// scan has no exchanged axes: they are a strong claim.
const BETTER: f64 = 0.5;

/// Largest residual over the root mean square of the readings. A film as made has a few per cent,
/// a film of the same wavelength with other tiles from ten. No parameters are reported beyond it.
const MOST_RESIDUAL: f64 = 0.2;

/// Residual with the strength held, over the residual with the strength fitted, up to which the
/// strength is held. Another strength alone leaves more than this of a film as ordered, whose
/// residual is the noise.
const HELD: f64 = 1.5;

/// Share of the readings up to which a residual is round-off, of readings with six digits.
pub const ROUND_OFF: f64 = 1e-6;

/// Offset over the root mean square of the readings up to which the strength is held. A larger one
/// makes up for readings in another unit.
const MOST_OFFSET: f64 = 0.5;

/// Strengths of a film that was made, over the strength of its layout: magnets of half or twice the
/// strength were not ordered.
pub const PLAUSIBLE_STRENGTHS: RangeInclusive<f64> = 0.5..=2.0;

/// The field of a film for the fit of a scan.
#[derive(Clone, Debug)]
pub struct ScanField<'a> {
    /// The field that is fitted.
    pub exact: SensedField<'a>,
    /// A faster one, right to some per cent, with which starts are searched. `None` for the same.
    pub rough: Option<SensedField<'a>>,
}

impl<'a> From<SensedField<'a>> for ScanField<'a> {
    fn from(exact: SensedField<'a>) -> ScanField<'a> {
        ScanField { exact, rough: None }
    }
}

impl<'a> From<&'a Scene> for ScanField<'a> {
    fn from(scene: &'a Scene) -> ScanField<'a> {
        SensedField::from(scene).into()
    }
}

/// Fits the parameters of a scan: readings of a sensor, in tesla, at positions of the scan.
///
/// Gauss-Newton steps use the exact field and its gradient. They begin with the orientation that
/// explains the readings best, found by linear regression, else with the perfect scan. Readings
/// farther from the fit than six standard deviations are excluded and the rest is fitted anew,
/// until no further reading is excluded. The median of the residuals gives the standard deviation.
/// Readings that are not finite, or at the limit of the sensor's range, are excluded from the
/// beginning.
///
/// Unless the fit is as expected (its residual is the noise of the sensor or 1 % of the readings;
/// or 10 %, with nearly the strength of the layout), other starts are searched, as far as `free`
/// has rotation and start: the 48 signed exchanges of the axes of the stage, then shifts of the
/// scan about `centre`, the likely place of its middle, and nearer to the film. A start with more
/// changes is reported if it fits twice as well. Where z counted downwards brings the scan nearer
/// to `centre`, this is tried first: below a symmetric film, one plane looks like one of a sensor
/// with a reversed axis.
///
/// # Errors
/// See [`ScanError`].
///
/// # Panics
/// If the numbers of points and readings differ.
pub fn fit_scan<'a>(
    field: impl Into<ScanField<'a>>,
    points: &[DVec3],
    readings_t: &[DVec3],
    free: FreeParameters,
    centre: Option<DVec3>,
) -> Result<ScanFit, ScanError> {
    assert_eq!(points.len(), readings_t.len(), "one reading per point");
    let ScanField { exact: field, rough } = field.into();
    let sensor = *field.sensor();
    let unusable: Vec<Option<Exclusion>> =
        readings_t.iter().map(|reading_t| Exclusion::of_reading(&sensor, *reading_t)).collect();
    let usable = unusable.iter().filter(|exclusion| exclusion.is_none()).count();
    let needed = free.count().div_ceil(3) + 1;
    if usable < needed {
        return Err(ScanError::TooFew { readings: usable, needed, excluded: readings_t.len() - usable });
    }
    let readings_t: Vec<DVec3> =
        readings_t.iter().map(|reading_t| (*reading_t - sensor.offset_t) / sensor.gain).collect();
    let field = field.without_gain_and_offset();
    let rough = rough.map(|rough| rough.without_gain_and_offset());
    let searched = rough.as_ref().unwrap_or(&field);
    let fit_of = |field: &SensedField, start: &Start| fit_from(field, points, &readings_t, &unusable, free, start);
    let from = |start: &Start| fit_of(&field, start);
    let expected_t = EXPECTED_RESIDUAL * (sensor.deviation_t() / sensor.gain.abs()).max_element();
    let is_expected = |fit: &ScanFit| is_expected(fit, &readings_t, expected_t);
    let found = |search: Search| -> Option<ScanFit> {
        let starts = match search.is_free(free) {
            true => starts(search, searched, points, &readings_t, &unusable, free, centre),
            false => Vec::new(),
        };
        let fits: Vec<ScanFit> = starts.iter().filter_map(|start| fit_of(searched, start).ok()).collect();
        let least_t = fits.iter().map(|fit| fit.noise_t).fold(f64::INFINITY, f64::min);
        let best = fits.into_iter().find(|fit| fit.noise_t <= SIMILAR * least_t)?;
        if rough.is_some() { from(&best.start()).ok() } else { Some(best) }
    };
    let down = downwards(points, centre).filter(|_| free.start).and_then(|start| from(&start).ok());
    if let Some(fit) = down.as_ref().filter(|fit| is_expected(fit)) {
        // A film that is scanned from its other side, as stated, has no reversed strength.
        let stated = from(&Start::PERFECT).ok().filter(|stated| {
            stated.parameters.strength > 0.0 && is_expected(stated) && stated.noise_t <= SIMILAR * fit.noise_t
        });
        return Ok(stated.unwrap_or_else(|| fit.clone()));
    }
    let oriented = found(Search::Sensor);
    let mut best = match oriented {
        Some(fit) if is_expected(&fit) && fit.sensor_axes == SignedAxes::SAME => Ok(fit),
        // The axes of the stage look like those of the sensor below a nearly symmetric film.
        Some(fit) if is_expected(&fit) => better(Ok(fit), found(Search::Stage)),
        oriented => better(from(&Start::PERFECT), oriented),
    };
    // With the strength held, errors of the tiles do not look like another unit.
    let held = FreeParameters { strength: false, ..free };
    let fits = |lengths: f64, unit: f64, most_t: f64| -> Option<f64> {
        let points: Vec<DVec3> = points.iter().map(|point| lengths * *point).collect();
        let readings_t: Vec<DVec3> = readings_t.iter().map(|reading_t| unit * *reading_t).collect();
        let starts = [Some(Start::PERFECT), centred(&points, centre)].into_iter().flatten();
        let fits = starts.filter_map(|start| fit_from(searched, &points, &readings_t, &unusable, held, &start).ok());
        let plausible = fits.filter(|fit| is_plausible(fit, &readings_t, unit * most_t));
        plausible.map(|fit| fit.noise_t / unit).min_by(f64::total_cmp)
    };
    if !best.as_ref().is_ok_and(is_expected) && free.start {
        let most_t = best.as_ref().map_or(f64::INFINITY, |fit| BETTER * fit.noise_t);
        let unit = LENGTHS.into_iter().find(|(_, length)| fits(*length, 1.0, most_t).is_some());
        if let Some((unit, length)) = unit {
            return Err(ScanError::Unit { unit, length });
        }
    }
    if !best.as_ref().is_ok_and(|fit| PLAUSIBLE_STRENGTHS.contains(&fit.parameters.strength)) {
        let most_t = best.as_ref().map_or(f64::INFINITY, |fit| HELD * fit.noise_t);
        // As large as the field where a scan likely was: another film may fit at another height.
        let places = [Some(Start::PERFECT), centred(points, centre)].into_iter().flatten();
        let fields_t = places.filter_map(|start| {
            let places: Vec<DVec3> = points.iter().map(|point| *point + start.parameters.start).collect();
            searched.readings_t(&places).ok().map(|field_t| rms_t(&field_t))
        });
        let fields_t: Vec<f64> = fields_t.collect();
        let is_as_large = |unit: f64| {
            let read_t = unit * rms_t(&readings_t);
            fields_t.iter().any(|field_t| PLAUSIBLE_STRENGTHS.contains(&(read_t / field_t)))
        };
        let units = FLUX_DENSITIES.into_iter().filter(|(unit, _)| is_as_large(*unit));
        let fitting = units.filter_map(|of| Some((of, fits(1.0, of.0, most_t)?)));
        if let Some(((unit, example), _)) = fitting.min_by(|a, b| a.1.total_cmp(&b.1)) {
            return Err(ScanError::ReadingUnit { unit, example });
        }
    }
    for search in [Search::Stage, Search::Shifts] {
        if !best.as_ref().is_ok_and(is_expected) {
            best = better(best, found(search));
        }
    }
    // A symmetric film looks alike from both sides, and errors of the tiles leave a residual in
    // both.
    let is_as_good = |down: &ScanFit| {
        best.as_ref().ok().is_none_or(|fit| {
            // A film has no reversed strength.
            let is_likelier = down.parameters.strength > 0.0 || fit.parameters.strength <= 0.0;
            is_likelier && down.noise_t <= SIMILAR * fit.noise_t
        })
    };
    let fit = match down.filter(is_as_good) {
        Some(down) => down,
        None => best?,
    };
    let reading_t = root_mean_square(&fit, &readings_t);
    if free == FreeParameters::ALL && fit.noise_t > MOST_RESIDUAL * reading_t {
        return Err(ScanError::Misfit { residual_t: fit.noise_t, reading_t });
    }
    let used = readings_t.iter().zip(&fit.exclusions).filter(|(_, exclusion)| exclusion.is_none());
    let largest_t = used.map(|(reading_t, _)| reading_t.abs().max_element()).fold(0.0, f64::max);
    let offset_t = fit.parameters.offset_t.abs().max_element();
    if offset_t > largest_t {
        return Err(ScanError::Offset { offset_t, largest_t });
    }
    Ok(fit)
}

/// The start that brings the middle of the scan to `centre`.
pub(crate) fn centred(points: &[DVec3], centre: Option<DVec3>) -> Option<Start> {
    let lower = points.iter().copied().reduce(DVec3::min)?;
    let upper = points.iter().copied().reduce(DVec3::max)?;
    let parameters = ScanParameters { start: centre? - 0.5 * (lower + upper), ..ScanParameters::PERFECT };
    Some(Start { parameters, ..Start::PERFECT })
}

/// The start with z of the stage counted downwards, if the middle of the scan then is nearer to
/// `centre`.
fn downwards(points: &[DVec3], centre: Option<DVec3>) -> Option<Start> {
    let z = || points.iter().map(|point| point.z);
    let middle = 0.5 * (z().fold(f64::INFINITY, f64::min) + z().fold(f64::NEG_INFINITY, f64::max));
    let is_nearer = (-middle - centre?.z).abs() < (middle - centre?.z).abs();
    is_nearer.then_some(Start { stage_axes: SignedAxes::DOWNWARDS, ..Start::PERFECT })
}

/// Fits all parameters or, where errors of tiles look like another strength and height, all but the
/// strength, and returns what it fitted.
///
/// The field falls off exponentially from a film, so a change of the strength is nearly a change of
/// the height. Errors of the tiles decide between the two unless the residual is noise: as small as
/// the noise of the sensor or 1 % of the readings, and not smooth along the scan. The strength is
/// held if the fit of all parameters does not converge, does not determine strength or start, or
/// does not explain the scan. It is also held if that fit has the residual of a film as made and
/// hardly a smaller one than with the strength held.
///
/// # Errors
/// As [`fit_scan`].
///
/// # Panics
/// As [`fit_scan`].
pub fn fit_determined<'a>(
    field: impl Into<ScanField<'a>>,
    points: &[DVec3],
    readings_t: &[DVec3],
    centre: Option<DVec3>,
) -> Result<(ScanFit, FreeParameters), ScanError> {
    let field = field.into();
    let sensor = *field.exact.sensor();
    let noise_t = (sensor.deviation_t() / sensor.gain.abs()).max_element();
    let scaled_t: Vec<DVec3> =
        readings_t.iter().map(|reading_t| (*reading_t - sensor.offset_t) / sensor.gain).collect();
    let fitted = |free| fit_scan(field.clone(), points, readings_t, free, centre);
    let share = |fit: &ScanFit| fit.noise_t / root_mean_square(fit, &scaled_t);
    let is_small = |fit: &ScanFit| match noise_t > 0.0 {
        true => fit.noise_t <= KNOWN_NOISE * noise_t,
        false => share(fit) <= SMALL_RESIDUAL,
    };
    let is_noise = |fit: &ScanFit| is_small(fit) && (share(fit) <= ROUND_OFF || !fit.has_smooth_residuals());
    let all = fitted(FreeParameters::ALL);
    // Where strength and height look alike, steps end at a film of no strength far away.
    let is_vague = match &all {
        Err(ScanError::Undetermined(parameters)) => {
            parameters.iter().any(|of| matches!(of, ScanParameter::Strength | ScanParameter::Start(_)))
        }
        of_all => matches!(of_all, Err(ScanError::NoConvergence | ScanError::Misfit { .. })),
    };
    if !is_vague && !matches!(&all, Ok(fit) if !is_noise(fit)) {
        return Ok((all?, FreeParameters::ALL));
    }
    let most_t = all.as_ref().map_or(f64::INFINITY, |fit| HELD * fit.noise_t);
    match fitted(FreeParameters::HELD_STRENGTH) {
        Ok(held) if held.noise_t <= most_t && share(&held) <= MOST_RESIDUAL && has_small_offset(&held, &scaled_t) => {
            Ok((held, FreeParameters::HELD_STRENGTH))
        }
        _ => Ok((all?, FreeParameters::ALL)),
    }
}

/// The fit of less changes, or the other if it fits twice as well.
fn better(fit: Result<ScanFit, ScanError>, other: Option<ScanFit>) -> Result<ScanFit, ScanError> {
    match (fit, other) {
        // A film of negative strength before a rotated sensor is the film before a reflected
        // sensor.
        (Ok(fit), Some(other)) if fit.parameters.strength > 0.0 && other.noise_t >= BETTER * fit.noise_t => Ok(fit),
        (_, Some(other)) => Ok(other),
        (fit, None) => fit,
    }
}

/// Whether a fit leaves no doubt about axes and place of the scan.
fn is_expected(fit: &ScanFit, readings_t: &[DVec3], noise_t: f64) -> bool {
    let residual = fit.noise_t / root_mean_square(fit, readings_t);
    let ScanParameters { strength, rotation_rad, .. } = fit.parameters;
    let is_close = (strength - 1.0).abs() < CLOSE && rotation_rad.length() < CLOSE;
    let is_small = fit.noise_t <= noise_t || residual <= SMALL_RESIDUAL;
    (strength > 0.0 && is_small) || (is_close && residual <= MADE_RESIDUAL)
}

/// Whether a fit in another unit explains the readings, with a residual up to `most_t`, hardly a
/// rotation and no offset in place of the field.
fn is_plausible(fit: &ScanFit, readings_t: &[DVec3], most_t: f64) -> bool {
    fit.parameters.rotation_rad.length() < CLOSE
        && fit.noise_t <= most_t.min(MOST_RESIDUAL * root_mean_square(fit, readings_t))
        && has_small_offset(fit, readings_t)
}

/// Whether the offset of a fit does not make up for readings in another unit.
fn has_small_offset(fit: &ScanFit, readings_t: &[DVec3]) -> bool {
    fit.offset_t().abs().max_element() <= MOST_OFFSET * rms_t(readings_t)
}

/// Root mean square of a component of the finite readings.
fn rms_t(readings_t: &[DVec3]) -> f64 {
    let finite = || readings_t.iter().filter(|reading_t| reading_t.is_finite());
    (finite().map(|reading_t| reading_t.length_squared()).sum::<f64>() / (3 * finite().count().max(1)) as f64).sqrt()
}

/// Root mean square of a component of the readings of a fit, without their offset. An offset that a
/// wrong fit invents does not enlarge it.
pub(crate) fn root_mean_square(fit: &ScanFit, readings_t: &[DVec3]) -> f64 {
    let used = || (0..readings_t.len()).filter(|index| fit.exclusions[*index].is_none());
    let squares = |offset_t: DVec3| used().map(|index| (readings_t[index] - offset_t).length_squared()).sum::<f64>();
    let least = squares(fit.offset_t()).min(squares(DVec3::ZERO));
    (least / (3 * used().count().max(1)) as f64).sqrt()
}

/// The fit from a start, with outliers excluded.
pub(crate) fn fit_from(
    field: &SensedField,
    points: &[DVec3],
    readings_t: &[DVec3],
    unusable: &[Option<Exclusion>],
    free: FreeParameters,
    start: &Start,
) -> Result<ScanFit, ScanError> {
    let scan = Scan::new(field, points, readings_t, unusable, free, start)?;
    let least_noise_t = LEAST_NOISE * scan.field_scale_t;
    let usable = unusable.iter().filter(|exclusion| exclusion.is_none()).count();
    let is_excess = |exclusions: &[Option<Exclusion>]| {
        let count = exclusions.iter().filter(|exclusion| **exclusion == Some(Exclusion::Outlier)).count();
        (count as f64 > MOST_OUTLIERS * usable as f64).then_some(count)
    };
    // Readings far off already at the start would pull the first fit.
    let mut exclusions = with_outliers(&scan.residuals_t(&start.parameters)?, unusable, least_noise_t);
    if is_excess(&exclusions).is_some() {
        exclusions = unusable.to_vec();
    }
    let mut parameters = start.parameters;
    for _ in 0..OUTLIER_ROUNDS {
        let fit = scan.fit(parameters, &exclusions)?;
        parameters = fit.parameters;
        let found = with_outliers(&scan.residuals_t(&parameters)?, unusable, least_noise_t);
        if let Some(outliers) = is_excess(&found) {
            return Err(ScanError::AnotherFilm { outliers, plateau: Plateau::among(readings_t, &found) });
        }
        if found == exclusions {
            return Ok(fit);
        }
        exclusions = found;
    }
    Err(ScanError::NoConvergence)
}

/// The exclusions of unusable readings and of outliers.
fn with_outliers(residuals_t: &[DVec3], unusable: &[Option<Exclusion>], least_noise_t: f64) -> Vec<Option<Exclusion>> {
    let used = residuals_t.iter().zip(unusable).filter(|(_, exclusion)| exclusion.is_none());
    let mut magnitudes: Vec<f64> = used.flat_map(|(residual, _)| residual.abs().to_array()).collect();
    let middle = magnitudes.len() / 2;
    let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
    let limit = OUTLIER * (DEVIATION_OVER_MEDIAN * *median).max(least_noise_t);
    let is_outlier = |residual: &DVec3| residual.abs().max_element() > limit;
    let outlier = |residual| is_outlier(residual).then_some(Exclusion::Outlier);
    residuals_t.iter().zip(unusable).map(|(residual, exclusion)| exclusion.or_else(|| outlier(residual))).collect()
}
