//! Search for spliced films that decouple better, by exact derivatives and constrained least
//! squares.
//!
//! The `[design]` table of a layout, its brief, lists the free parameters and the demands.
//!
//! * [`DesignProblem`]: a layout prepared for design. Tiles are sorted by symmetry, each free
//!   parameter is a variable, and each rule a linear inequality.
//! * [`DesignProblem::search`]: damped Gauss-Newton descents from several starts, each step a
//!   quadratic program; then fewer parts, if asked for, and rounding.
//! * [`SearchResult`]: the film found, with its [`Metrics`] before and after.
//! * [`ParetoFront`]: the best films for a series of demands.
//! * [`SpliceRequest`]: a layout to begin with, from a few numbers.
//!
//! Lengths in millimetres, polarization in tesla. This crate reads no files and prints nothing.
//! docs/physics.md, section 6, derives the method; docs/design.md measures its results.
//!
//! # Example
//! ```
//! use magsplice_design::{DesignProblem, ignore_progress};
//! use magsplice_layout::Layout;
//!
//! let text = r#"
//!     format = 1
//!     name = "four squares"
//!     [ideal]
//!     wavelength_mm = 10.0
//!     thickness_mm = 1.0
//!     amplitude_t = 0.12
//!     [volume]
//!     x_mm = [-1.0, 1.0]
//!     y_mm = [-1.0, 1.0]
//!     z_mm = [-4.0, -3.0]
//!     step_mm = 1.0
//!     [design]
//!     vary = ["size", "position"]
//!     symmetry = "four-fold"
//!     outline_mm = { x = [-6.0, 6.0], y = [-6.0, 6.0] }
//!     starts = 1
//!     [[tile]]
//!     position_mm = [2.5, 2.5, 0.5]
//!     size_mm = [3.3, 3.3, 1.0]
//!     polarization_t = [0.085, 0.085, 0.0]
//!     mirror = { axes = ["x", "y"] }
//! "#;
//! let layout = Layout::parse(text, "example")?;
//! let problem = DesignProblem::new(&layout)?;
//! let result = problem.search(&ignore_progress)?;
//! let r_x = |metrics: &magsplice_design::Metrics| metrics.figures.uniformity_rmse.r_x.unwrap();
//! assert!(r_x(&result.after) < r_x(&result.before));
//! let designed = problem.designed_layout(&result, "example");
//! assert_eq!(designed.tiles.len(), 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Derivatives of the residuals against central differences.
#[cfg(test)]
mod derivative_tests;
/// Local descent by damped Gauss-Newton steps.
mod descent;
/// Why a film cannot be designed.
mod error;
/// Error against amplitude and against the number of parts.
mod pareto_front;
/// Films of few distinct parts.
mod parts;
/// A layout prepared for design: variables, rules, errors.
mod problem;
/// Progress of a search, and the way to stop it.
mod progress;
/// Rules of a brief, with their tiles.
mod rule;
/// The search, stage by stage, and the film found.
mod search;
/// A layout to begin with, from a few numbers.
mod splice;
/// Why a layout to begin with cannot be made.
mod splice_fault;
/// Which number of a request stands in the way of a film.
mod splice_trials;
/// Strengths in stock, and strengths under recoil.
mod strengths;
/// Tolerances and tuning constants.
mod tolerances;

pub use error::{DesignError, NeededTable, RoundingFault};
pub use pareto_front::ParetoFront;
pub use problem::design_problem::DesignProblem;
pub use progress::{ProgressUpdate, SearchProgress, SearchStage, ignore_progress};
pub use rule::{Demand, Gap, Rule};
pub use search::estimate::SearchEstimate;
pub use search::made_films::MadeFilms;
pub use search::metrics::Metrics;
pub use search::search_result::{SearchResult, StageMetrics};
pub use search::shortfall::Shortfall;
pub use splice::{SpliceRequest, distances_of};
pub use splice_fault::SpliceFault;
pub use splice_trials::{SpliceChange, SpliceTrial};
