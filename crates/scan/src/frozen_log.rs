//! A log that repeats one row.

use glam::DVec3;
use thiserror::Error;

/// Least number of successive equal rows, and least share of all rows, that a log repeats only when
/// it is frozen. Sensors have noise, and a stage moves.
const LEAST_RUN: (usize, f64) = (12, 0.1);

/// Successive rows that are equal in all components.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("rows {} to {} are equal in all components", first + 1, first + count)]
pub struct FrozenLog {
    /// Index of the first of these rows.
    pub first: usize,
    /// Their number.
    pub count: usize,
}

impl FrozenLog {
    /// The longest run of equal rows. Missing components are equal.
    pub fn among(rows: &[DVec3]) -> Option<FrozenLog> {
        let is_equal = |a: &DVec3, b: &DVec3| (0..3).all(|i| a[i] == b[i] || a[i].is_nan() && b[i].is_nan());
        let is_missing = |row: &DVec3| row.to_array().iter().all(|value| value.is_nan());
        let mut end = 0;
        let runs = rows.chunk_by(is_equal).map(|run| {
            end += run.len();
            (FrozenLog { first: end - run.len(), count: run.len() }, is_missing(&run[0]))
        });
        let (least, share) = LEAST_RUN;
        let is_long = |run: &FrozenLog| run.count >= least && run.count as f64 >= share * rows.len() as f64;
        let frozen = runs.filter(|(run, is_missing)| !is_missing && is_long(run) && run.count < rows.len());
        frozen.map(|(run, _)| run).max_by_key(|run| run.count)
    }

    /// The indices of its rows.
    pub fn rows(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_runs_of_equal_rows_are_frozen() {
        let row = |n: usize| DVec3::new(n.min(20) as f64, f64::NAN, 1.0);
        let of = |count: usize| FrozenLog::among(&(0..count).map(row).collect::<Vec<_>>());
        assert_eq!([of(31), of(32)], [None, Some(FrozenLog { first: 20, count: 12 })]);
        assert_eq!(of(32).expect("frozen").to_string(), "rows 21 to 32 are equal in all components");
        assert_eq!(FrozenLog::among(&[DVec3::ONE; 30]), None);
        assert_eq!(FrozenLog::among(&[&[DVec3::ONE; 3][..], &[DVec3::NAN; 20]].concat()), None);
    }
}
