//! Reference values and random scenes shared by several tests.

/// The field of a cuboid to 130 digits.
pub mod oracle;
/// The tables of `tests/reference`.
pub mod reference_tables;
/// Random tiles and points, near and on faces, edges and corners.
pub mod scenes;

/// The number of cases of a slow test: `all` with the feature `all-cases`, else a tenth.
pub fn cases(all: u32) -> u32 {
    if cfg!(feature = "all-cases") { all } else { all / 10 }
}

/// The points of a slow test: `all` with the feature `all-cases`, else every fifth.
pub fn share<T: Clone>(all: &[T]) -> Vec<T> {
    let step = if cfg!(feature = "all-cases") { 1 } else { 5 };
    all.iter().step_by(step).cloned().collect()
}
