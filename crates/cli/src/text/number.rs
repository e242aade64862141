//! Numbers and counts in words. Text has no round-off; JSON and tables have all digits.

use magsplice::prelude::DVec3;
use magsplice::results::rounded_beside;

pub(crate) use magsplice::results::number;

/// A uniformity RMSE. Planes with a single point have none.
pub(crate) fn uniformity_number(rmse: Option<f64>) -> String {
    rmse.map_or("one point".to_owned(), number)
}

/// A number of things, with the word for one or for many of them.
pub(crate) fn counted(number: usize, one: &str, many: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {many}") }
}

/// A quantity beside another of the same kind, such as a force at rest beside the largest force. A
/// value below the twelfth digit of `scale` is round-off of 0.
pub(crate) fn number_beside(value: f64, scale: f64) -> String {
    number(rounded_beside(value, scale))
}

/// The components of a vector to the twelfth digit of the largest.
pub(crate) fn components(v: DVec3) -> [f64; 3] {
    let largest = v.abs().max_element();
    v.to_array().map(|component| rounded_beside(component, largest))
}

/// A point, such as (0.5, -1, -3).
pub(crate) fn point(p: DVec3) -> String {
    let [x, y, z] = components(p);
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_off_is_not_printed() {
        assert_eq!(point(DVec3::new(-4.44089e-16, 0.1 + 0.2, -3.0)), "(0, 0.3, -3)");
        assert_eq!(number_beside(1e-35, 0.4), "0.000000");
        assert_eq!(number_beside(-4.4e-16, 10.0), "0.000000");
        assert_eq!(number_beside(1e-9, 0.4), "1.00000e-9");
        // Alone it is a number.
        assert_eq!(point(DVec3::new(0.0, 0.0, 1e-16)), "(0, 0, 0.0000000000000001)");
    }
}
