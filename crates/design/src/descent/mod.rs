//! Local descent: steps that reduce the error of a film and keep its rules.

/// Second derivatives of the model of a step.
pub(crate) mod curvature;
/// Damped Gauss-Newton steps.
mod gauss_newton;
/// Quadratic programs under linear inequalities.
mod quadratic;
