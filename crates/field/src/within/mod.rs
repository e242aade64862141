//! The field to a tolerance instead of to the last digits: models that cost less, each with a bound of its error.
//!
//! | model | where | file |
//! |---|---|---|
//! | Chebyshev expansion of a box without tiles | points of a grid, repeated look-ups | `fit`, `on_grid`, `fitted_field` |
//! | exact | points at which no other model keeps the tolerance | [`crate::batch`] |

pub(crate) mod accuracy;
mod chebyshev;
mod combine;
mod fit;
pub(crate) mod magnitude;
pub(crate) mod on_grid;
