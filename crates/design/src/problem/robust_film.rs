//! The film at which the expected square of errors is taken.

use crate::problem::objective::Objective;
use crate::problem::pattern::Pattern;
use crate::problem::sampling::{SampledField, Sampling};

/// The film at which the expected square is taken.
#[derive(Clone, Copy)]
pub(crate) struct RobustFilm<'a> {
    pub(crate) sampling: &'a Sampling,
    pub(crate) objective: &'a Objective,
    pub(crate) pattern: &'a Pattern,
    pub(crate) variables: &'a [f64],
    /// Its field, with derivatives if those of the square are wanted.
    pub(crate) field: &'a SampledField,
}

impl RobustFilm<'_> {
    pub(crate) fn variable_count(&self) -> usize {
        self.field.variable_count
    }

    pub(crate) fn with_derivatives(&self) -> bool {
        self.variable_count() > 0
    }
}
