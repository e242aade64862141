//! A tree built when first needed.

use std::sync::OnceLock;

use magsplice_expansion::tolerances::HIGHEST_DEGREE;
use magsplice_magnet::{Accuracy, Tolerance};

use super::nodes::Tree;
use crate::tolerances::{EXTRA_DEGREES, MIN_TREE_DEGREE};
use magsplice_direct::direct_sum::DirectSum;

/// A tree over the tiles of a scene, for one accuracy.
#[derive(Clone, Debug)]
pub(crate) struct LazyTree {
    highest_degree: usize,
    tree: OnceLock<Tree>,
}

impl LazyTree {
    /// A tree for this accuracy, not built yet.
    pub(crate) fn new(direct: &DirectSum, accuracy: Accuracy) -> LazyTree {
        let largest_j_t = direct.tiles().iter().map(|tile| tile.polarization_t().length()).fold(0.0, f64::max);
        LazyTree { highest_degree: highest_degree(accuracy, largest_j_t), tree: OnceLock::new() }
    }

    /// The tree, built from the tiles given to [`LazyTree::new`].
    pub(crate) fn get(&self, direct: &DirectSum) -> &Tree {
        self.tree.get_or_init(|| Tree::new(direct, self.highest_degree))
    }
}

/// Highest degree of expansions that an accuracy needs, for tiles whose |J| is at most
/// `largest_j_t`. The truncation error of that degree is about the tolerance at twice the radius.
fn highest_degree(accuracy: Accuracy, largest_j_t: f64) -> usize {
    let fraction = match accuracy {
        Accuracy::Exact => return HIGHEST_DEGREE,
        Accuracy::Within(Tolerance::Relative { fraction, .. }) => fraction,
        Accuracy::Within(Tolerance::AbsoluteT { error_t, .. }) => error_t / largest_j_t,
    };
    let degree = EXTRA_DEGREES - fraction.log2();
    if degree > MIN_TREE_DEGREE as f64 { degree.min(HIGHEST_DEGREE as f64) as usize } else { MIN_TREE_DEGREE }
}
