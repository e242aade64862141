//! The fit of all unknowns by Gauss-Newton steps.
//!
//! The least sum of squares prefers places where expected errors of the tiles act more: 3 mm below
//! a wavelength of 10 mm, strengths of films made by hand would be 10 % too small. With derivatives
//! of the film without expected errors, B by the parameters of the scan, the condition for them is
//! B^T C^-1 r = 0, where r is the residual and C its covariance before the errors are known. The
//! mean of r is 0 at the true parameters, and B and C do not depend on r: the condition has no bias
//! to first order in the errors (quasi-likelihood; P. McCullagh and J. A. Nelder, Generalized
//! Linear Models, 1989, section 9.3).

use glam::DVec3;

use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::model::{Compared, Linearized, ScanModel};
use crate::diagnosis::prior_fit::PriorFit;
use crate::diagnosis::unknowns::{State, Unknowns};

/// Fall of the sum of squares, in units of the variance of the residuals, below which steps end.
/// Errors then change by a thirtieth of their standard deviation.
const LEAST_GAIN: f64 = 1e-3;

/// Sum of squares of the fit without bias over the least one, up to which it is a fit of the same
/// readings. For three films made by hand it was at most 1.02; where the fit runs away, thousands.
const MOST_RISE: f64 = 1.5;

/// Sum of squares over its expectation from which on the model is wrong, and a bias does not
/// matter. Below it, the fit without bias, whose steps are full, may pass where those of least
/// squares are short.
const FAR: f64 = 100.0;

/// Variance of the noise of a step over the one of the next. The least sum of squares of large
/// errors lies in a narrow, curved valley, which steps of Gauss and Newton cross. The residual
/// itself is at first taken for noise, so that errors only grow as far as the readings show them.
/// By-hand films of slanted tiles, 1 mm below, then converge in 11 full steps; without it, 20 steps
/// of a hundredth end at a thousand times the least sum.
const COOLING: f64 = 4.0;

/// Largest number of halvings of a step.
const MOST_HALVINGS: usize = 12;

/// The model after a number of steps.
struct Steps {
    at: Linearized,
    compared: Compared,
    /// Squares of the residuals over the noise, and of the expected errors over their deviations.
    sum_of_squares: f64,
    is_converged: bool,
}

/// The film whose derivatives a fit uses.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SlopeOf {
    /// The film of the state: the derivatives are exact.
    State,
    /// This film without expected errors.
    Ordered,
}

impl SlopeOf {
    /// Largest number of steps of a fit. With exact derivatives, errors of 10 degrees or 0.5 mm
    /// need about six, after as many with a larger noise. With others, each step is a half to a
    /// fifth of the one before.
    const fn most_steps(self) -> usize {
        match self {
            SlopeOf::State => 30,
            SlopeOf::Ordered => 40,
        }
    }
}

impl ScanModel {
    /// The model at the fit of all unknowns to readings. With expected errors, the least sum of
    /// squares is only the start of the fit without bias. It is the result, with exact derivatives,
    /// where that fit does not converge, and where the model is wrong, so that a bias does not
    /// matter.
    pub(crate) fn converged(
        &self,
        readings_t: &[DVec3],
        from: Linearized,
        deviations: &[f64],
    ) -> Result<(Linearized, Compared), DiagnosisError> {
        if from.slopes_at.is_some() {
            let unbiased = self.steps(readings_t, from.clone(), SlopeOf::Ordered, deviations)?;
            if unbiased.is_converged {
                return Ok((unbiased.at, unbiased.compared));
            }
        }
        let least = self.steps(readings_t, from, SlopeOf::State, deviations)?;
        let is_near = least.sum_of_squares < FAR * self.freedom(&least.at.is_used) as f64;
        if self.unknowns.expects_errors() && self.unknowns.of_scan() > 0 && is_near {
            let unbiased = self.steps(readings_t, least.at.clone(), SlopeOf::Ordered, deviations)?;
            if unbiased.is_converged && unbiased.sum_of_squares < MOST_RISE * least.sum_of_squares {
                return Ok((unbiased.at, unbiased.compared));
            }
        }
        Ok((least.at, least.compared))
    }

    /// The model at the least sum of squares, with exact derivatives.
    pub(crate) fn least(
        &self,
        readings_t: &[DVec3],
        from: Linearized,
        deviations: &[f64],
    ) -> Result<(Linearized, Compared), DiagnosisError> {
        let least = self.steps(readings_t, from, SlopeOf::State, deviations)?;
        Ok((least.at, least.compared))
    }

    /// Gauss-Newton steps. With exact derivatives, each reduces the sum of squares with its noise.
    fn steps(
        &self,
        readings_t: &[DVec3],
        from: Linearized,
        slope_of: SlopeOf,
        deviations: &[f64],
    ) -> Result<Steps, DiagnosisError> {
        let mut values = self.values(&from.state);
        // Errors no longer identified get their expected values or vanish.
        values.iter_mut().zip(deviations).filter(|(_, d)| **d == 0.0).for_each(|(value, _)| *value = 0.0);
        let state = self.state(&from.state, &values);
        let is_used = from.is_used.clone();
        let slopes_at =
            |state: &State| (slope_of == SlopeOf::Ordered).then(|| self.without_expected(state, deviations));
        let is_same = state == from.state && slopes_at(&state) == from.slopes_at;
        let mut at = match is_same {
            true => from,
            false => self.linearized(state.clone(), slopes_at(&state), &is_used, Some(&from))?,
        };
        let mut compared = self.compared(&at, readings_t);
        let readings = self.freedom(&is_used) as f64;
        let mut is_converged = false;
        let mut variance = match slope_of {
            SlopeOf::State => (compared.chi_squared / readings).max(1.0),
            SlopeOf::Ordered => 1.0,
        };
        for _ in 0..slope_of.most_steps() {
            let narrowed = self.unknowns.with_expected_over(deviations, variance.sqrt());
            let fit = PriorFit::new(&at.gram, &compared.projected, &narrowed)?;
            let now = compared.chi_squared + Unknowns::sum_of_squares(&values, &narrowed);
            is_converged = variance == 1.0 && fit.gain(&values) < LEAST_GAIN * (now / readings).max(1.0);
            if is_converged {
                break;
            }
            let step = &fit.estimate - &values;
            let mut share = 1.0;
            let better = (0..MOST_HALVINGS).find_map(|_| {
                let next = &values + &step * share;
                share *= 0.5;
                let state = self.state(&at.state, &next);
                // A step to invalid tiles or points is too long.
                let there =
                    self.chi_squared(&state, &is_used, readings_t).ok()? + Unknowns::sum_of_squares(&next, &narrowed);
                (slope_of == SlopeOf::Ordered || there < now).then_some((next, state))
            });
            if let Some((next, state)) = better {
                values = next;
                at = self.linearized(state.clone(), slopes_at(&state), &is_used, Some(&at))?;
                compared = self.compared(&at, readings_t);
            } else if variance == 1.0 {
                break;
            }
            variance = (variance / COOLING).min(compared.chi_squared / readings).max(1.0);
        }
        let sum_of_squares = compared.chi_squared + Unknowns::sum_of_squares(&values, deviations);
        Ok(Steps { at, compared, sum_of_squares, is_converged })
    }
}
