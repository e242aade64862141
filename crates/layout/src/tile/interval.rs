//! Intervals of a lattice along one axis.

/// One interval of a lattice along one axis, in millimetres.
pub(crate) struct Interval {
    pub(crate) centre: f64,
    pub(crate) width: f64,
    /// Component of the pattern along the axis.
    pub(crate) pattern: f64,
    /// Contribution to the component of the pattern along z.
    pub(crate) upright: f64,
}
