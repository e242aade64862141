//! The mean of the readings of a sensor at rest.

use glam::DVec3;

/// Number of standard deviations from the median beyond which a reading is an outlier.
const OUTLIER: f64 = 6.0;

/// Share of normal errors within one standard deviation. A sixth of the readings may be outliers,
/// and readings that are rounded to few counts still have a deviation.
const WITHIN_DEVIATION: f64 = 0.682_689_492_137_086;

/// The mean of the readings of a sensor at rest, without readings that are not finite, and without
/// readings farther from the median than six standard deviations along any axis. `None` if none is
/// finite.
///
/// The standard deviation is the distance from the median that 68 % of the readings do not exceed.
pub fn mean_at_rest(readings_t: &[DVec3]) -> Option<DVec3> {
    let finite: Vec<DVec3> = readings_t.iter().copied().filter(|reading| reading.is_finite()).collect();
    let quantile = |values: &mut Vec<f64>, share: f64| {
        values.sort_by(f64::total_cmp);
        values[(share * (values.len() - 1) as f64) as usize]
    };
    if finite.is_empty() {
        return None;
    }
    let component = |axis: usize| -> Vec<f64> { finite.iter().map(|reading| reading[axis]).collect() };
    let median = DVec3::from([0, 1, 2].map(|axis| quantile(&mut component(axis), 0.5)));
    let limit = DVec3::from([0, 1, 2].map(|axis| {
        let mut distances: Vec<f64> = component(axis).iter().map(|value| (value - median[axis]).abs()).collect();
        OUTLIER * quantile(&mut distances, WITHIN_DEVIATION)
    }));
    let kept: Vec<DVec3> = finite.into_iter().filter(|reading| (*reading - median).abs().cmple(limit).all()).collect();
    Some(kept.iter().sum::<DVec3>() / kept.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_has_neither_wild_nor_missing_readings() {
        let noisy = |n: usize| DVec3::new(1e-3 + 1e-6 * (n % 3) as f64, -2e-3, 4e-3 + 1e-6 * (n % 2) as f64);
        let mut readings: Vec<DVec3> = (0..12).map(noisy).collect();
        let clean = mean_at_rest(&readings).unwrap();
        assert!((clean - readings.iter().sum::<DVec3>() / 12.0).length() < 1e-18);
        readings.push(DVec3::new(f64::NAN, 0.0, 0.0));
        readings.push(DVec3::new(1e-3, -2e-3, 0.05));
        assert_eq!(mean_at_rest(&readings), Some(clean));
        assert_eq!(mean_at_rest(&readings[12..13]), None);
        assert_eq!(mean_at_rest(&readings[13..]), Some(readings[13]));
    }

    /// Of readings rounded to counts, none is an outlier.
    #[test]
    fn counts_are_no_outliers() {
        let readings: Vec<DVec3> = (0..10).map(|n| DVec3::splat(if n < 6 { 1.0 } else { 2.0 })).collect();
        assert!((mean_at_rest(&readings).unwrap() - DVec3::splat(1.4)).length() < 1e-15);
    }
}
