//! Reference values and random scenes that several tests share.

/// The field of a cuboid to 130 digits.
pub mod oracle;
/// The tables of `tests/reference`.
pub mod reference_tables;
/// Random tiles and points, on purpose near and on faces, edges and corners.
pub mod scenes;
