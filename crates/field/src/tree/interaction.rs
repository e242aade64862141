//! How the nodes of a tree act on a batch of points.

/// A node that acts through its multipole expansion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExpandedNode {
    pub(crate) node: usize,
    /// Distance from its centre to the nearest of the points, scaled.
    pub(crate) distance: f64,
    /// The degree at that distance.
    pub(crate) degree: usize,
    /// Upper bound of the truncation error of that degree there, in tesla. No lower degree has a
    /// larger error at points farther away.
    pub(crate) truncation_error_t: f64,
}

/// A node whose expansion is translated to a local expansion around the points (M2L).
#[derive(Clone, Copy, Debug)]
pub(crate) struct TranslatedNode {
    pub(crate) node: usize,
    /// Distance from its centre to the nearest of the points, scaled.
    pub(crate) distance: f64,
    /// The degree of its expansion.
    pub(crate) degree: usize,
    /// Upper bound of the truncation error of that degree at that distance, in tesla.
    pub(crate) truncation_error_t: f64,
    /// The degree of the local expansion.
    pub(crate) local_degree: usize,
    /// Upper bound of the truncation error of the local expansion at any of the points, in tesla.
    pub(crate) local_truncation_error_t: f64,
}

/// How a node acts on points.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Interaction {
    /// Not at all: its whole field is within the allowed truncation error.
    Ignored,
    /// Through a local expansion of this degree, with an upper bound of its truncation error in tesla.
    Translated { local_degree: usize, local_truncation_error_t: f64 },
    /// Through its multipole expansion.
    Expanded,
}

/// An item that is summed directly, at least at some points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectItem {
    pub(crate) item: usize,
    /// The distance from its centre beyond which its expansion replaces it.
    pub(crate) beyond: Option<(f64, ExpandedNode)>,
}
