//! The mean of the readings of a sensor at rest.

use glam::DVec3;

/// Number of standard deviations from the median beyond which a reading is an outlier.
const OUTLIER: f64 = 6.0;

/// Share of normal errors within one standard deviation. A sixth of the readings may be outliers,
/// and readings that are rounded to few counts still have a deviation.
const WITHIN_DEVIATION: f64 = 0.682_689_492_137_086;

/// Least number of readings of which one can be an outlier. Of two readings, neither is nearer to
/// the truth.
const LEAST_READINGS: usize = 5;

/// The mean of the readings of a sensor at rest, without readings that are not finite. `None` if
/// none is finite. The mean along an axis is without the components farther from their median than
/// six standard deviations, if there are five readings or more.
///
/// The standard deviation is the distance from the median that 68 % of the components do not
/// exceed.
pub fn mean_at_rest(readings_t: &[DVec3]) -> Option<DVec3> {
    let finite: Vec<DVec3> = readings_t.iter().copied().filter(|reading| reading.is_finite()).collect();
    let mean = |axis: usize| {
        let mut components: Vec<f64> = finite.iter().map(|reading| reading[axis]).collect();
        if components.len() >= LEAST_READINGS {
            let median = quantile(&mut components.clone(), 0.5);
            let mut distances: Vec<f64> = components.iter().map(|value| (value - median).abs()).collect();
            let limit = OUTLIER * quantile(&mut distances, WITHIN_DEVIATION);
            components.retain(|value| (value - median).abs() <= limit);
        }
        components.iter().sum::<f64>() / components.len() as f64
    };
    (!finite.is_empty()).then(|| DVec3::from([0, 1, 2].map(mean)))
}

/// The value that this share of the values does not exceed.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(share * (values.len() - 1) as f64) as usize]
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
        assert!((mean_at_rest(&readings).unwrap() - clean).length() < 1e-6);
        // Of two readings that differ along all axes, none is an outlier.
        let two = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 1.0, 4.0)];
        assert_eq!(mean_at_rest(&two), Some(DVec3::new(1.5, 1.5, 3.5)));
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
