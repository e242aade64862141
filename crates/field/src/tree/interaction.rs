//! Interactions of the nodes of a tree with a batch of points.

/// A node that acts through its multipole expansion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExpandedNode {
    pub(crate) node: usize,
    /// Distance from the centre to the nearest of the points, scaled.
    pub(crate) distance: f64,
    /// The degree at that distance.
    pub(crate) degree: usize,
    /// Upper bound of the truncation error of that degree there, in tesla. Points farther away may
    /// have lower degrees, whose truncation error is at most this too.
    pub(crate) truncation_error_t: f64,
}

/// A node whose expansion is translated into a local expansion around the points (M2L).
#[derive(Clone, Copy, Debug)]
pub(crate) struct TranslatedNode {
    pub(crate) node: usize,
    /// Distance from the centre to the nearest of the points, scaled.
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

/// The interaction of a node with points.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Interaction {
    /// No interaction, because the whole field of the node is within the allowed truncation error.
    Ignored,
    /// A local expansion of this degree, with an upper bound of its truncation error in tesla.
    Translated { local_degree: usize, local_truncation_error_t: f64 },
    /// The multipole expansion.
    Expanded,
}

/// An item summed directly at some points or all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectItem {
    pub(crate) item: usize,
    /// Distance from the centre beyond which the expansion replaces direct summation.
    pub(crate) beyond: Option<(f64, ExpandedNode)>,
}
