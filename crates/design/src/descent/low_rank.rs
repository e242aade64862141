//! Matrices of few rows: residuals of many points, most of which say the same.

use crate::tolerances::{SMALLEST_FACTOR, SMALLEST_ROW};

/// Rows R with R^T R equal to F^T F up to [`SMALLEST_ROW`], where the columns are measured in
/// `units`. `rows` are the rows of F, one after the other, as long as `units`.
///
/// This is a QR decomposition with column pivoting. It costs the number of rows of F times that of
/// R for each column.
pub(crate) fn reduced(rows: &[f64], units: &[f64]) -> Vec<f64> {
    let n = units.len();
    let height = rows.len() / n.max(1);
    // By columns, in units of the variables.
    let mut columns = vec![0.0; rows.len()];
    for (row, values) in rows.chunks_exact(n).enumerate() {
        values.iter().zip(units).enumerate().for_each(|(i, (value, unit))| columns[i * height + row] = value * unit);
    }
    let square = |column: &[f64]| column.iter().map(|c| c * c).sum::<f64>();
    let mut first = None;
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut reduced = Vec::new();
    while basis.len() < height.min(n) {
        let squares = columns.chunks_exact(height).map(square);
        let Some((pivot, largest)) = squares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if !(largest > SMALLEST_ROW * SMALLEST_ROW * *first.get_or_insert(largest)) {
            break;
        }
        let mut unit = columns[pivot * height..][..height].to_vec();
        // Round-off has left components along the earlier vectors.
        for earlier in &basis {
            add(&mut unit, -dot(earlier, &columns[pivot * height..][..height]), earlier);
        }
        let length = square(&unit).sqrt();
        unit.iter_mut().for_each(|c| *c /= length);
        for (column, scale) in columns.chunks_exact_mut(height).zip(units) {
            let along = dot(&unit, column);
            add(column, -along, &unit);
            reduced.push(along / scale);
        }
        basis.push(unit);
    }
    reduced
}

/// Rows R and a diagonal D so that R^T R + D is near a positive semidefinite matrix: equal on the
/// diagonal, and off it up to [`SMALLEST_FACTOR`] in `units` of the columns.
///
/// This is a Cholesky decomposition with pivoting, whose remainder is left out except for its
/// diagonal.
pub(crate) fn factored(matrix: &[f64], units: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = units.len();
    let mut rest: Vec<f64> = (0..n).map(|i| matrix[i * n + i]).collect();
    let mut rows: Vec<f64> = Vec::new();
    let scaled = |rest: &[f64], i: usize| rest[i] * units[i] * units[i];
    let first = (0..n).map(|i| scaled(&rest, i)).fold(0.0, f64::max);
    while rows.len() < n * n {
        let Some(pivot) = (0..n).max_by(|&a, &b| scaled(&rest, a).total_cmp(&scaled(&rest, b))) else { break };
        if !(scaled(&rest, pivot) > SMALLEST_FACTOR * SMALLEST_FACTOR * first) {
            break;
        }
        let root = rest[pivot].sqrt();
        let mut row = matrix[pivot * n..][..n].to_vec();
        rows.chunks_exact(n).for_each(|earlier| add(&mut row, -earlier[pivot], earlier));
        row.iter_mut().for_each(|value| *value /= root);
        rest.iter_mut().zip(&row).for_each(|(rest, value)| *rest = (*rest - value * value).max(0.0));
        rest[pivot] = 0.0;
        rows.extend(row);
    }
    (rows, rest)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four sums, so that the compiler uses vectors.
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a4.zip(b4) {
        (0..4).for_each(|i| sums[i] += a[i] * b[i]);
    }
    sums.iter().sum::<f64>() + rest
}

fn add(into: &mut [f64], factor: f64, row: &[f64]) {
    into.iter_mut().zip(row).for_each(|(sum, value)| *sum += factor * value);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_rows_have_the_same_squares_as_many() {
        // Twelve rows that are combinations of three, in columns of different units.
        let base = |k: usize, i: usize| ((k * k + 2) as f64 * (i as f64 + 0.3)).sin();
        let units: Vec<f64> = (0..5).map(|i| 10_f64.powi(i - 2)).collect();
        let rows: Vec<f64> = (0..12)
            .flat_map(|row| {
                (0..5).map(move |i| (0..3).map(|k| base(k, i) * ((row * (k + 1)) as f64).cos()).sum::<f64>())
            })
            .enumerate()
            .map(|(at, value)| value / units[at % 5])
            .collect();
        let found = reduced(&rows, &units);
        assert_eq!(found.len(), 3 * 5);
        let gram = |rows: &[f64], i: usize, k: usize| rows.chunks_exact(5).map(|row| row[i] * row[k]).sum::<f64>();
        for (i, k) in (0..5).flat_map(|i| (0..5).map(move |k| (i, k))) {
            let (wanted, found) = (gram(&rows, i, k), gram(&found, i, k));
            assert!((wanted - found).abs() * units[i] * units[k] < 1e-12, "{i}, {k}: {wanted}, {found}");
        }
        assert!(reduced(&[0.0; 10], &units).is_empty());
    }

    /// A matrix of rank two with a small diagonal: two rows hold the first part, and the diagonal
    /// the second up to the square of [`SMALLEST_FACTOR`].
    #[test]
    fn a_matrix_is_few_rows_and_a_diagonal() {
        let units: Vec<f64> = (0..6).map(|i| 10_f64.powi(i - 3)).collect();
        let base = |k: usize, i: usize| ((k + 1) as f64 * (i as f64 + 0.3)).sin();
        let small = 0.1 * SMALLEST_FACTOR * SMALLEST_FACTOR;
        let element = |i: usize, k: usize| {
            let product = (0..2).map(|row| base(row, i) * base(row, k)).sum::<f64>();
            (product + if i == k { small } else { 0.0 }) / units[i] / units[k]
        };
        let matrix: Vec<f64> = (0..36).map(|at| element(at / 6, at % 6)).collect();
        let (rows, rest) = factored(&matrix, &units);
        assert_eq!(rows.len(), 2 * 6);
        for (i, k) in (0..6).flat_map(|i| (0..6).map(move |k| (i, k))) {
            let found =
                rows.chunks_exact(6).map(|row| row[i] * row[k]).sum::<f64>() + if i == k { rest[i] } else { 0.0 };
            let error = (found - matrix[i * 6 + k]).abs() * units[i] * units[k];
            assert!(error < 10.0 * small, "{i}, {k}: {error}");
        }
    }
}
