//! Chebyshev polynomials T_k on [-1, 1].

use std::f64::consts::PI;

use super::weighted_sums::padded;

/// The `count` zeros of T_count, in decreasing order.
pub(super) fn nodes(count: usize) -> Vec<f64> {
    (0..count).map(|i| (PI * (i as f64 + 0.5) / count as f64).cos()).collect()
}

/// Row k, entry i: the weight of the value at node i in the coefficient of T_k of the interpolating
/// polynomial.
pub(super) fn transform(count: usize) -> Vec<Vec<f64>> {
    let n = count as f64;
    let cosines: Vec<f64> = (0..4 * count).map(|quarter| (PI * quarter as f64 / (2.0 * n)).cos()).collect();
    let entry = |k: usize, i: usize| {
        let weight = if k == 0 { 1.0 } else { 2.0 };
        // Full turns are removed while the angle is still an integer, which is exact.
        weight / n * cosines[(k * (2 * i + 1)) % (4 * count)]
    };
    (0..count).map(|k| (0..count).map(|i| entry(k, i)).collect()).collect()
}

/// Sets `values` to T_0(x), T_1(x), ...
pub(super) fn polynomials(x: f64, values: &mut [f64]) {
    let (mut last, mut value) = (x, 1.0);
    for entry in values {
        *entry = value;
        (last, value) = (value, 2.0 * x * value - last);
    }
}

/// T_0, T_1, ... below `count` at all places, one padded row for each.
pub(super) fn rows_of_polynomials(places: &[f64], count: usize) -> Vec<f64> {
    let stride = padded(places.len());
    let mut rows = vec![0.0; count * stride];
    for degree in 0..count {
        let (before, row) = rows.split_at_mut(degree * stride);
        match degree {
            0 => row[..places.len()].fill(1.0),
            1 => row[..places.len()].copy_from_slice(places),
            _ => {
                let (last, value) = before[(degree - 2) * stride..].split_at(stride);
                for (((entry, x), value), last) in row.iter_mut().zip(places).zip(value).zip(last) {
                    *entry = 2.0 * x * value - last;
                }
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomial_of_low_degree_is_reproduced() {
        let function = |x: f64| 3.0 - x + 4.0 * x.powi(3);
        let values: Vec<f64> = nodes(6).into_iter().map(function).collect();
        let coefficients: Vec<f64> =
            transform(6).iter().map(|row| row.iter().zip(&values).map(|(a, b)| a * b).sum()).collect();
        // 4 x^3 = T_3 + 3 x
        for (found, exact) in coefficients.iter().zip([3.0, 2.0, 0.0, 1.0, 0.0, 0.0]) {
            assert!((found - exact).abs() < 1e-15);
        }
        let mut t = [0.0; 4];
        polynomials(0.3, &mut t);
        let found: f64 = coefficients.iter().zip(t).map(|(c, t)| c * t).sum();
        assert!((found - function(0.3)).abs() < 2e-15);
    }

    #[test]
    fn rows_equal_the_polynomials_at_each_place() {
        let places = [-1.0, -0.3, 0.0, 0.7, 1.0];
        let rows = rows_of_polynomials(&places, 7);
        for (index, place) in places.into_iter().enumerate() {
            let mut values = [0.0; 7];
            polynomials(place, &mut values);
            let column: Vec<f64> = rows.chunks_exact(padded(places.len())).map(|row| row[index]).collect();
            assert_eq!(column, values);
        }
    }
}
