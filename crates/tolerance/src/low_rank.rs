//! Columns as combinations of a few orthonormal ones.
//!
//! The field in the working volume is smooth, so a few dozen combinations represent the effects of
//! hundreds of errors or variables there. An orthonormal basis is built column by column, each time
//! from the largest remaining one (modified Gram-Schmidt with pivots). It ends at the numeric rank;
//! a complete decomposition of nalgebra would go on through all columns.

use rayon::prelude::*;

/// Columns as combinations of a few orthonormal ones.
#[derive(Clone, Debug, Default)]
pub struct LowRank {
    /// Orthonormal columns, the first from the largest of the given ones.
    pub basis: Vec<Vec<f64>>,
    /// The coordinates of each given column in the basis.
    pub coordinates: Vec<Vec<f64>>,
}

impl LowRank {
    /// The basis of columns of equal lengths. The root mean square of the remainder outside the
    /// basis is at most the fraction `omitted` of the root mean square of the columns.
    pub fn new(mut columns: Vec<Vec<f64>>, omitted: f64) -> LowRank {
        let mut coordinates = vec![Vec::new(); columns.len()];
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut squares: Vec<f64> = columns.iter().map(|column| dot(column, column)).collect();
        let allowed = omitted * omitted * squares.iter().sum::<f64>();
        loop {
            let pivot = (0..columns.len()).max_by(|a, b| squares[*a].total_cmp(&squares[*b]));
            let Some(pivot) = pivot.filter(|_| squares.iter().sum::<f64>() > allowed) else { break };
            let mut next = columns[pivot].clone();
            // Rounding of earlier steps is removed once more.
            for earlier in &basis {
                let along = dot(earlier, &next);
                add(&mut next, -along, earlier);
            }
            let length = dot(&next, &next).sqrt();
            next.iter_mut().for_each(|value| *value /= length);
            let deflate = |((column, coordinates), square): ((&mut Vec<f64>, &mut Vec<f64>), &mut f64)| {
                let along = dot(&next, column);
                add(column, -along, &next);
                coordinates.push(along);
                *square = dot(column, column);
            };
            columns.par_iter_mut().zip(&mut coordinates).zip(&mut squares).for_each(deflate);
            // Its remainder is rounding.
            squares[pivot] = 0.0;
            columns[pivot].fill(0.0);
            basis.push(next);
        }
        LowRank { basis, coordinates }
    }

    /// Number of columns of the basis.
    pub fn rank(&self) -> usize {
        self.basis.len()
    }

    /// The sum of columns times factors, added to `sum`.
    pub(crate) fn add_combination(&self, factors: impl IntoIterator<Item = f64>, sum: &mut [f64]) {
        let mut along = vec![0.0; self.rank()];
        for (factor, coordinates) in factors.into_iter().zip(&self.coordinates) {
            add(&mut along, factor, coordinates);
        }
        for (along, column) in along.iter().zip(&self.basis) {
            add(sum, *along, column);
        }
    }
}

/// The scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four sums, so that additions need not wait for each other.
    let mut sums = [0.0; 4];
    let (a_fours, b_fours) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a_fours.remainder().iter().zip(b_fours.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_fours.zip(b_fours) {
        (0..4).for_each(|i| sums[i] += a[i] * b[i]);
    }
    sums.iter().sum::<f64>() + rest
}

/// Adds a multiple of `b`.
pub(crate) fn add(sum: &mut [f64], factor: f64, b: &[f64]) {
    sum.iter_mut().zip(b).for_each(|(sum, b)| *sum += factor * b);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns that are combinations of three have a basis of three, which gives them back.
    #[test]
    fn combinations_of_three_columns_have_rank_three() {
        let three: Vec<Vec<f64>> =
            (1..4).map(|n| (0..50).map(|i| (f64::from(n) * f64::from(i) * 0.1).sin()).collect()).collect();
        let columns: Vec<Vec<f64>> = (0..20)
            .map(|number| {
                let mut column = vec![0.0; 50];
                (0..3).for_each(|n| add(&mut column, f64::from((number * 7 + n * 5) % 11) - 5.0, &three[n as usize]));
                column
            })
            .collect();
        let found = LowRank::new(columns.clone(), 1e-4);
        assert_eq!(found.rank(), 3);
        for (number, column) in columns.iter().enumerate() {
            let mut sum = vec![0.0; 50];
            found.add_combination((0..20).map(|other| f64::from(u8::from(other == number))), &mut sum);
            assert!(sum.iter().zip(column).all(|(found, wanted)| (found - wanted).abs() < 1e-12));
        }
        assert_eq!(LowRank::new(vec![vec![0.0; 5]; 3], 1e-4).rank(), 0);
    }

    /// Whole numbers, so that every sum is exact; lengths with and without a remainder of four.
    #[test]
    fn scalar_products_have_all_terms() {
        for length in 0..11 {
            let numbers = |step: i32| -> Vec<f64> { (1..=length).map(|n| f64::from(n * step % 7)).collect() };
            let (a, b) = (numbers(3), numbers(5));
            let known: f64 = (0..length as usize).map(|i| a[i] * b[i]).sum();
            assert_eq!(dot(&a, &b), known, "{length}");
            let mut sum = a.clone();
            add(&mut sum, -2.0, &b);
            assert!((0..length as usize).all(|i| sum[i] == a[i] - 2.0 * b[i]), "{length}");
        }
    }

    /// Columns that are orthogonal, of lengths 1, 1/10, 1/100 and so on: a basis that may omit
    /// 0.02 has two of them, and one that may omit 0.005 has three. Its columns are orthonormal.
    #[test]
    fn basis_omits_no_more_than_is_allowed() {
        let columns = |order: &[usize]| -> Vec<Vec<f64>> {
            let column = |n: usize| (0..6).map(|i| if i == n { 0.1_f64.powi(n as i32) } else { 0.0 }).collect();
            order.iter().map(|n| column(*n)).collect()
        };
        let given = columns(&[3, 0, 2, 1]);
        for (omitted, rank) in [(0.2, 1), (0.02, 2), (0.005, 3), (0.0, 4)] {
            let found = LowRank::new(given.clone(), omitted);
            assert_eq!(found.rank(), rank, "{omitted}");
            let known = columns(&[0, 1, 2, 3]);
            for (column, known) in found.basis.iter().zip(&known) {
                let length = dot(known, known).sqrt();
                assert!(column.iter().zip(known).all(|(found, known)| (found - known / length).abs() < 1e-15));
            }
        }
    }
}
