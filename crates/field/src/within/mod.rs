//! The field to a tolerance instead of to the last digits: models that cost less, each with a bound of its error.
//!
//! | model | where | file |
//! |---|---|---|
//! | Chebyshev expansion of a box without tiles | points of a grid | `fit`, `on_grid` |
//! | harmonic potentials of cells of the box | repeated look-ups | `fitted_field`, `cells`, `harmonic`, `look_up` |
//! | expansions of nodes of a tree over the tiles | other points | `at_points`, [`crate::batch`] |
//! | exact | points at which no other model keeps the tolerance | [`crate::batch`] |

pub(crate) mod accuracy;
pub(crate) mod at_points;
mod cells;
mod chebyshev;
mod combine;
mod fit;
pub(crate) mod fitted_field;
mod harmonic;
mod look_up;
pub(crate) mod magnitude;
pub(crate) mod on_grid;
pub(crate) mod plan;
