//! The fit of all unknowns by Gauss-Newton steps.
//!
//! The least sum of squares prefers places where expected errors of the tiles act more: 3 mm below
//! a wavelength of 10 mm, strengths of films made by hand would be 10 % too small. With the
//! derivatives B of the film as ordered, the condition for the parameters of the scan is
//! B^T C^-1 r = 0, where r is the residual and C its covariance before the errors are known. The
//! mean of r is 0 at the true parameters, and B does not depend on r: the condition has no bias to
//! first order (quasi-likelihood; P. McCullagh and J. A. Nelder, Generalized Linear Models, 1989,
//! section 9.3).

use glam::DVec3;

use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::model::{Compared, Linearized, ScanModel, SlopeOf};
use crate::diagnosis::prior_fit::PriorFit;

/// Fall of the sum of squares, in units of the variance of the residuals, below which steps end.
/// Errors then change by a thirtieth of their standard deviation.
const LEAST_GAIN: f64 = 1e-3;

/// Largest number of halvings of a step.
const MOST_HALVINGS: usize = 12;

/// The model after a number of steps.
struct Steps {
    at: Linearized,
    compared: Compared,
    is_converged: bool,
}

impl Steps {
    fn converged(self) -> Option<(Linearized, Compared)> {
        self.is_converged.then_some((self.at, self.compared))
    }
}

impl SlopeOf {
    /// Largest number of steps of a fit. With exact derivatives, errors of 10 degrees or 0.5 mm
    /// need about six. With others, each step is a half to a fifth of the one before.
    const fn most_steps(self) -> usize {
        match self {
            SlopeOf::State => 20,
            SlopeOf::Ordered => 40,
        }
    }
}

impl ScanModel {
    /// The model at the fit of all unknowns to readings. With expected errors, the least sum of
    /// squares is only the start of the fit without bias. It is the result, with
    /// [`SlopeOf::State`], where that fit does not converge.
    pub(crate) fn converged(
        &self,
        readings_t: &[DVec3],
        from: Linearized,
        deviations: &[f64],
    ) -> Result<(Linearized, Compared), DiagnosisError> {
        if from.slope_of == SlopeOf::Ordered {
            let unbiased = self.steps(readings_t, from.clone(), SlopeOf::Ordered, deviations)?;
            if let Some(unbiased) = unbiased.converged() {
                return Ok(unbiased);
            }
        }
        let Steps { at, compared, .. } = self.steps(readings_t, from, SlopeOf::State, deviations)?;
        let is_biased = self.unknowns.expects_errors() && self.unknowns.of_scan() > 0;
        let unbiased = is_biased.then(|| self.steps(readings_t, at.clone(), SlopeOf::Ordered, deviations));
        Ok(unbiased.transpose()?.and_then(Steps::converged).unwrap_or((at, compared)))
    }

    /// Gauss-Newton steps. With exact derivatives, each reduces the sum of squares.
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
        let is_same = state == from.state && slope_of == from.slope_of;
        let mut at = if is_same { from } else { self.linearized(state, slope_of, &is_used, Some(&from))? };
        let objective = |compared: &Compared, values: &nalgebra::DVector<f64>| {
            let prior =
                |(value, deviation): (&f64, &f64)| if *deviation > 0.0 { (value / deviation).powi(2) } else { 0.0 };
            compared.chi_squared + values.iter().zip(deviations).map(prior).sum::<f64>()
        };
        let mut compared = self.compared(&at, readings_t);
        let readings = (3 * is_used.iter().filter(|is_used| **is_used).count()) as f64;
        for _ in 0..slope_of.most_steps() {
            let fit = PriorFit::new(&at.gram, &compared.projected, deviations)?;
            let now = objective(&compared, &values);
            if fit.gain(&values) < LEAST_GAIN * (now / readings).max(1.0) {
                return Ok(Steps { at, compared, is_converged: true });
            }
            let step = &fit.estimate - &values;
            let mut share = 1.0;
            let better = (0..MOST_HALVINGS).find_map(|_| {
                let next = &values + &step * share;
                share *= 0.5;
                // A step to invalid tiles or points is too long.
                let state = self.state(&at.state, &next);
                let there = self.linearized(state, slope_of, &is_used, Some(&at)).ok()?;
                let compared = self.compared(&there, readings_t);
                let is_better = slope_of == SlopeOf::Ordered || objective(&compared, &next) < now;
                is_better.then_some((next, there, compared))
            });
            let Some((next, there, next_compared)) = better else { break };
            (values, at, compared) = (next, there, next_compared);
        }
        Ok(Steps { at, compared, is_converged: false })
    }
}
