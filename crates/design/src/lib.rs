//! Films that decouple better, found by exact derivatives.
//!
//! A layout says in `[design]` what may change and what is wanted. [`Setting`] makes that ready: tiles sorted by symmetry, every free number a variable, every rule a linear
//! inequality. [`Setting::search`] goes down from several starts by damped Gauss-Newton steps, each a quadratic program; then makes the parts few, if asked, and rounds.
//! [`Outcome`] is the film found with its figures before and after.
//!
//! Lengths in millimetres, polarization in tesla. This crate reads no files and prints nothing. docs/design.md tells how well it does.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod affine;
mod descent;
mod designed;
mod division;
mod error;
mod figures;
mod front;
mod objective;
mod parts;
mod pattern;
mod quadratic;
mod rounding;
mod rules;
mod sampling;
mod search;
mod setting;
mod splice;
mod strengths;
mod symmetry;
mod tolerances;

pub use error::DesignError;
pub use figures::Figures;
pub use front::Front;
pub use search::{Outcome, Progress, Stage, Watch};
pub use setting::Setting;
pub use splice::Request;
