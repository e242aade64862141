//! Numbers and counts in words.

/// Six decimals, or six significant digits where six decimals would lose them or be too wide.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        // Adding 0 turns -0 into 0.
        format!("{:.6}", value + 0.0)
    } else {
        format!("{value:.5e}")
    }
}

/// A uniformity RMSE. Planes with a single point have none.
pub(crate) fn uniformity_number(rmse: Option<f64>) -> String {
    rmse.map_or("one point".to_owned(), number)
}

/// A number of things, with the word for one or for many of them.
pub(crate) fn counted(number: usize, one: &str, many: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {many}") }
}
