//! Search for spliced films that decouple better, by exact derivatives and constrained least
//! squares.
//!
//! The `[design]` table of a layout, its brief, says what may change and what is wanted.
//!
//! * [`DesignProblem`]: a layout prepared for design. Tiles are sorted by symmetry, each free
//!   number is a variable, and each rule a linear inequality.
//! * [`DesignProblem::search`]: damped Gauss-Newton descents from several starts, each step a
//!   quadratic program; then fewer parts, if asked for, and rounding.
//! * [`SearchResult`]: the film found, with its [`Metrics`] before and after.
//! * [`ParetoFront`]: the best films for a series of demands.
//! * [`SpliceRequest`]: a layout to begin with, from a few numbers.
//!
//! Lengths in millimetres, polarization in tesla. This crate reads no files and prints nothing.
//! docs/physics.md, section 6, derives the method; docs/design.md tells how well it does.
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
//! assert!(result.after.uniformity_rmse.r_x < result.before.uniformity_rmse.r_x);
//! let designed = problem.designed_layout(&result, "example");
//! assert_eq!(designed.tiles.len(), 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Affine expressions of the variables.
mod affine;
/// Second derivatives of the model of a step.
mod curvature;
/// Derivatives of the residuals against central differences.
#[cfg(test)]
mod derivative_tests;
/// Local descent by damped Gauss-Newton steps.
mod descent;
/// A layout prepared for design.
mod design_problem;
/// Why a film cannot be designed.
mod error;
/// Errors of the films that are made, as mean squares.
mod error_model;
/// The time that a search will take.
mod estimate;
/// The expected square that errors of films add, with derivatives.
mod expected_squares;
/// How the field changes with errors that several tiles share.
mod joint_response;
/// Matrices of few rows.
mod low_rank;
/// Errors of the films that are made, by samples.
mod made_films;
/// Errors of a film over a grid.
mod metrics;
/// Residuals of each goal, with derivatives.
mod objective;
/// Error against amplitude and against the number of parts.
mod pareto_front;
/// Which tile is made of which part.
mod part_assignment;
/// Merging of distinct parts.
mod parts;
/// Tiles as functions of the variables.
mod pattern;
/// Progress of a search, and the way to stop it.
mod progress;
/// Quadratic programs under linear inequalities.
mod quadratic;
/// What recoil adds to the field of a film.
mod recoil;
/// The film at which the expected square is taken.
mod robust_film;
/// Tests of the expected square of errors.
#[cfg(test)]
mod robust_tests;
/// Rounding to the resolution.
mod rounding;
/// Linear rules: sides, outline, thickness, strength, distances.
mod rules;
/// Points of the design grid, and the field there with derivatives.
mod sampling;
/// The search, stage by stage.
mod search;
/// The film that a search returns.
mod search_result;
/// A layout to begin with, from a few numbers.
mod splice;
/// Strengths replaced by strengths in stock.
mod stock_strengths;
/// Symmetry operations and orbits of tiles.
mod symmetry;
/// How the field of a tile changes with its errors.
mod tile_response;
/// Tolerances and tuning constants.
mod tolerances;
/// The film found, as a layout.
mod write_layout;

pub use design_problem::DesignProblem;
pub use error::DesignError;
pub use estimate::SearchEstimate;
pub use made_films::{MadeErrors, MadeFilms};
pub use metrics::Metrics;
pub use pareto_front::ParetoFront;
pub use progress::{Progress, ProgressUpdate, SearchStage, ignore_progress};
pub use search_result::{SearchResult, StageMetrics};
pub use splice::SpliceRequest;
