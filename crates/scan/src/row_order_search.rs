//! Positions and readings of a scan that are not in step.

use glam::DVec3;
use magsplice_magnet::Axis;
use magsplice_sensor::SensedField;

use crate::exclusion::Exclusion;
use crate::fit::{centred, fit_from, root_mean_square};
use crate::least_squares::{MADE_RESIDUAL, ScanFit};
use crate::parameters::FreeParameters;
use crate::row_order::RowOrder;
use crate::starts::Start;

/// Most rows by which readings are tried to be late or early.
const MOST_SHIFT: usize = 3;

/// Least number of readings, of which most fit by no accident.
const LEAST_READINGS: usize = 16;

/// Share of outliers above which another order is looked for: wild readings are fewer.
const MANY: f64 = 0.05;

/// Outliers over those of the order as it is, up to which another order explains them. Those at the
/// ends of a shifted scan remain.
const FEW: f64 = 0.25;

/// Residual over that of the order as it is, with outliers or without, up to which another order
/// explains it.
const HALF: f64 = 0.5;

/// Whether so many readings are outliers that another order is worth looking for.
pub fn is_row_order_likely(exclusions: &[Option<Exclusion>]) -> bool {
    exclusions.len() >= LEAST_READINGS && outliers(exclusions) > MANY * exclusions.len() as f64
}

/// The order in which the film explains the readings far better than in the order as it is, which
/// has the fit `given` of these parameters, if any. `centre` is the likely place of the middle of
/// the scan.
pub fn find_row_order(
    field: &SensedField,
    points: &[DVec3],
    readings_t: &[DVec3],
    given: Option<(&ScanFit, FreeParameters)>,
    centre: Option<DVec3>,
) -> Option<RowOrder> {
    if points.len() < LEAST_READINGS {
        return None;
    }
    let sensor = *field.sensor();
    let field = field.without_gain_and_offset();
    let unusable = |readings_t: &[DVec3]| -> Vec<Option<Exclusion>> {
        readings_t.iter().map(|reading_t| Exclusion::of_reading(&sensor, *reading_t)).collect()
    };
    let free = given.map_or(FreeParameters::HELD_STRENGTH, |(_, free)| free);
    let given = given.map(|(fit, _)| fit);
    let explains = |points: &[DVec3], readings_t: &[DVec3]| -> Option<f64> {
        let unusable = unusable(readings_t);
        let readings_t: Vec<DVec3> =
            readings_t.iter().map(|reading_t| (*reading_t - sensor.offset_t) / sensor.gain).collect();
        let starts = [given.map(ScanFit::start), Some(Start::PERFECT), centred(points, centre)];
        let fit = |start: Start| fit_from(&field, points, &readings_t, &unusable, free, &start).ok();
        let fits = starts.into_iter().flatten().filter_map(fit);
        let likely = fits.filter(|fit| match given {
            Some(given) => {
                // Outliers of a shifted scan are near the film, so that the rest has less noise.
                let has_few = is_row_order_likely(&given.exclusions)
                    && outliers(&fit.exclusions) <= FEW * outliers(&given.exclusions);
                has_few && squares(fit) <= HALF * HALF * squares(given)
                    || outliers(&fit.exclusions) <= outliers(&given.exclusions) && fit.noise_t <= HALF * given.noise_t
            }
            None => {
                let is_small = fit.noise_t <= MADE_RESIDUAL * root_mean_square(fit, &readings_t);
                is_small && !is_row_order_likely(&fit.exclusions)
            }
        });
        likely.map(|fit| fit.noise_t * (1.0 + outliers(&fit.exclusions))).min_by(f64::total_cmp)
    };
    if given.is_none() && explains(points, readings_t).is_some() {
        return None;
    }
    let found = orders(points, readings_t).into_iter();
    let found = found.filter_map(|(order, points, readings_t)| Some((order, explains(&points, &readings_t)?)));
    found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(order, _)| order)
}

/// Positions and readings in each other order.
fn orders(points: &[DVec3], readings_t: &[DVec3]) -> Vec<(RowOrder, Vec<DVec3>, Vec<DVec3>)> {
    let last = points.len();
    let mut all = Vec::new();
    for rows in 1..=MOST_SHIFT {
        let signed = rows as i64;
        all.push((RowOrder::Late(signed), points[..last - rows].to_vec(), readings_t[rows..].to_vec()));
        all.push((RowOrder::Late(-signed), points[rows..].to_vec(), readings_t[..last - rows].to_vec()));
    }
    for axis in Axis::ALL {
        let shifted = |of: &[DVec3], by: &[DVec3]| -> Vec<DVec3> {
            of.iter().zip(by).map(|(of, by)| *of + (*by - *of) * axis.unit()).collect()
        };
        let (but_first, but_last) = (&points[1..], &points[..last - 1]);
        all.push((RowOrder::LateCoordinate { axis, rows: 1 }, shifted(but_first, but_last), readings_t[1..].to_vec()));
        all.push((
            RowOrder::LateCoordinate { axis, rows: -1 },
            shifted(but_last, but_first),
            readings_t[..last - 1].to_vec(),
        ));
        let reversed = reversed(points, axis).into_iter();
        all.extend(reversed.map(|points| (RowOrder::ToAndFro(axis), points, readings_t.to_vec())));
    }
    all
}

/// Mean square of the residuals of all readings, also of outliers.
fn squares(fit: &ScanFit) -> f64 {
    let finite = || fit.residuals_t.iter().filter(|residual_t| residual_t.is_finite());
    finite().map(|residual_t| residual_t.length_squared()).sum::<f64>() / finite().count().max(1) as f64
}

fn outliers(exclusions: &[Option<Exclusion>]) -> f64 {
    exclusions.iter().filter(|exclusion| **exclusion == Some(Exclusion::Outlier)).count() as f64
}

/// The positions with a coordinate reversed in some parts of a scan: in those that run against the
/// first, or else in every second part, of the scan or of each of its planes. Nothing for a
/// coordinate that no other one waits for.
fn reversed(points: &[DVec3], axis: Axis) -> Vec<Vec<DVec3>> {
    let changes = |axis: usize| points.windows(2).filter(|pair| pair[0][axis] != pair[1][axis]).count();
    let slower: Vec<usize> = (0..3).filter(|other| changes(*other) < changes(axis.index())).collect();
    let is_same_part = |a: &DVec3, b: &DVec3| slower.iter().all(|other| a[*other] == b[*other]);
    let parts: Vec<&[DVec3]> = points.chunk_by(is_same_part).collect();
    let Some(slowest) = slower.into_iter().min_by_key(|other| changes(*other)) else { return Vec::new() };
    if parts.len() < 2 || parts.len() > points.len() / 2 {
        return Vec::new();
    }
    let along = |point: &DVec3| point[axis.index()];
    let runs_up = |part: &[DVec3]| along(&part[part.len() - 1]) > along(&part[0]);
    let against: Vec<bool> = parts.iter().map(|part| runs_up(part) != runs_up(parts[0])).collect();
    let every_second: Vec<bool> = (0..parts.len()).map(|number| number % 2 == 1).collect();
    let planes = parts.chunk_by(|a, b| a[0][slowest] == b[0][slowest]);
    let of_planes: Vec<bool> = planes.flat_map(|parts| (0..parts.len()).map(|number| number % 2 == 1)).collect();
    let chosen = match against.contains(&true) {
        true => vec![against],
        false => vec![every_second, of_planes],
    };
    let ends = points.iter().map(along).fold(f64::INFINITY, f64::min)
        + points.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let reverse = |chosen: &[bool], others: bool| -> Vec<DVec3> {
        let of_part = |(part, is_chosen): (&&[DVec3], &bool)| -> Vec<DVec3> {
            let change = |of: &DVec3| if *is_chosen != others { ends - 2.0 * along(of) } else { 0.0 };
            part.iter().map(|of| *of + change(of) * axis.unit()).collect()
        };
        parts.iter().zip(chosen).flat_map(of_part).collect()
    };
    chosen.iter().flat_map(|chosen| [reverse(chosen, false), reverse(chosen, true)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_reversed_in_every_second_part() {
        let point = |n: i32| DVec3::new(f64::from(n / 6), f64::from(n / 2 % 3), f64::from(n % 2) - 4.0);
        let points: Vec<DVec3> = (0..18).map(point).collect();
        let found = reversed(&points, Axis::Y);
        let y = |of: &[DVec3]| of.iter().map(|of| of.y).collect::<Vec<_>>();
        let (up, down) = ([0.0, 0.0, 1.0, 1.0, 2.0, 2.0], [2.0, 2.0, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!((y(&found[0]), y(&found[1])), ([up, down, up].concat(), [down, up, down].concat()));
        // Positions that run to and fro become those of one way.
        let one_way = reversed(&found[0], Axis::Y);
        assert_eq!((one_way.len(), y(&one_way[0])), (2, [up, up, up].concat()));
        let z = |of: &[DVec3]| of[..8].iter().map(|of| of.z + 4.0).collect::<Vec<_>>();
        let found = reversed(&points, Axis::Z);
        assert_eq!(z(&found[0]), [0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
        // Each plane begins anew.
        assert_eq!(z(&found[2]), [0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0]);
        assert!(reversed(&points, Axis::X).is_empty());
        assert!(reversed(&points.iter().map(|of| DVec3::splat(of.x)).collect::<Vec<_>>(), Axis::Y).is_empty());
    }
}
