//! The search for a turn of a film about z against the positions of its scan.

use glam::DVec3;

use crate::exclusion::Exclusion;
use crate::fit::{ScanField, fit_from};
use crate::parameters::{FreeParameters, ScanParameters};
use crate::starts::{Start, oriented, sparse};
use crate::turned_film::{FilmTurn, middle};

/// Largest turn that is searched, in degrees. Larger ones are an exchange of axes and the rest.
const MOST_DEG: f64 = 45.0;

/// Distance of neighbouring turns that are compared, in degrees. Tiles 10 mm from the axis move by
/// 0.5 mm, far less than a quarter of a wavelength.
const STEP_DEG: f64 = 3.0;

/// Turns to both sides of 0 that are compared.
const STEPS: i32 = (MOST_DEG / STEP_DEG) as i32;

/// Smallest turn that is reported, in degrees. Films are mounted to about as much, and errors of
/// tiles look like less.
const LEAST_DEG: f64 = 0.5;

/// Number of turns whose neighbourhoods are searched.
const REFINED: usize = 2;

/// Number of readings by which turns are compared.
const COMPARED: usize = 100;

/// Golden sections of a neighbourhood of 6 degrees, which leave 0.02 degrees.
const SECTIONS: usize = 12;

/// Share of an interval that a golden section keeps.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The turn of a film with which it explains a scan best, if that is no turn of less than 0.5
/// degrees. The sensor may be turned and have an offset, and the scan may start elsewhere; the
/// strength is held.
///
/// # Panics
/// If the numbers of points and readings differ.
pub fn film_turn<'a>(field: impl Into<ScanField<'a>>, points: &[DVec3], readings_t: &[DVec3]) -> Option<FilmTurn> {
    assert_eq!(points.len(), readings_t.len(), "one reading per point");
    let ScanField { exact, rough } = field.into();
    let sensor = *exact.sensor();
    let unusable: Vec<Option<Exclusion>> =
        readings_t.iter().map(|reading_t| Exclusion::of_reading(&sensor, *reading_t)).collect();
    let readings_t: Vec<DVec3> =
        readings_t.iter().map(|reading_t| (*reading_t - sensor.offset_t) / sensor.gain).collect();
    let field = rough.unwrap_or(exact).without_gain_and_offset();
    let middle = middle(points);
    let free = FreeParameters::HELD_STRENGTH;
    let placed = |angle_deg: f64, points: &[DVec3]| -> Vec<DVec3> {
        let back = FilmTurn::back(angle_deg);
        points.iter().map(|point| middle + back * (*point - middle)).collect()
    };
    let sensor_turn = |angle_deg: f64| ScanParameters {
        rotation_rad: DVec3::new(0.0, 0.0, -angle_deg.to_radians()),
        ..ScanParameters::PERFECT
    };
    let (few_points, few_t) = sparse(points, &readings_t, &unusable, COMPARED);
    let compared = |step: i32| {
        let angle_deg = f64::from(step) * STEP_DEG;
        let (error, _) = oriented(&field.readings_t(&placed(angle_deg, &few_points)).ok()?, &few_t, free)?;
        Some((error, angle_deg))
    };
    let mut turns: Vec<(f64, f64)> = (-STEPS..=STEPS).filter_map(compared).collect();
    turns.sort_by(|a, b| a.0.total_cmp(&b.0));
    let residual_t = |angle_deg: f64| -> f64 {
        let start = Start { parameters: sensor_turn(angle_deg), ..Start::PERFECT };
        let fit = fit_from(&field, &placed(angle_deg, points), &readings_t, &unusable, free, &start);
        fit.map_or(f64::INFINITY, |fit| fit.noise_t)
    };
    let unturned_t = residual_t(0.0);
    let fitted = |angle_deg: f64| FilmTurn { angle_deg, residual_t: residual_t(angle_deg), unturned_t };
    let refined = turns.into_iter().take(REFINED).map(|(_, angle_deg)| least(angle_deg, fitted));
    let best = refined.min_by(|a, b| a.residual_t.total_cmp(&b.residual_t))?;
    (best.residual_t.is_finite() && best.angle_deg.abs() >= LEAST_DEG).then_some(best)
}

/// The turn of least residual within a step of an angle, by golden sections.
fn least(angle_deg: f64, fitted: impl Fn(f64) -> FilmTurn) -> FilmTurn {
    let (mut lower, mut upper) = (angle_deg - STEP_DEG, angle_deg + STEP_DEG);
    let inner = |lower: f64, upper: f64| GOLDEN * (upper - lower);
    let (mut left, mut right) = (fitted(upper - inner(lower, upper)), fitted(lower + inner(lower, upper)));
    for _ in 0..SECTIONS {
        if left.residual_t < right.residual_t {
            (upper, right) = (right.angle_deg, left);
            left = fitted(upper - inner(lower, upper));
        } else {
            (lower, left) = (left.angle_deg, right);
            right = fitted(lower + inner(lower, upper));
        }
    }
    if left.residual_t < right.residual_t { left } else { right }
}
