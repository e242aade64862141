//! Probabilities of chi squared, as logarithms, because probabilities of strong signals underflow.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use statrs::function::gamma::ln_gamma;

/// Probability below which the asymptotic series gives its logarithm. The relative error of the
/// series is then below `freedom` / 1000.
const LEAST_PROBABILITY: f64 = 1e-250;

/// Probability below which noise and expected errors do not explain a residual.
const IMPLAUSIBLE: f64 = 1e-4;

/// Whether a residual is too large for noise and expected errors.
pub(crate) fn is_implausible(chi_squared: f64, freedom: usize) -> bool {
    ln_probability_above(chi_squared, freedom) < IMPLAUSIBLE.ln()
}

/// The natural logarithm of the probability of a larger chi squared with these degrees of freedom.
pub(crate) fn ln_probability_above(chi_squared: f64, freedom: usize) -> f64 {
    let Ok(distribution) = ChiSquared::new(freedom as f64) else { return 0.0 };
    if !(chi_squared > 0.0) {
        return 0.0;
    }
    let probability = distribution.sf(chi_squared);
    if probability > LEAST_PROBABILITY {
        return probability.ln();
    }
    // Gamma(a, x) = x^(a-1) e^-x (1 + (a-1)/x + ...), Abramowitz and Stegun 6.5.32.
    let (a, x) = (0.5 * freedom as f64, 0.5 * chi_squared);
    (a - 1.0) * x.ln() - x + ((a - 1.0) / x).ln_1p() - ln_gamma(a)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For two degrees of freedom the probability is exp(-x / 2).
    #[test]
    fn two_degrees_of_freedom_are_exponential() {
        for chi_squared in [0.1, 5.0, 300.0, 1e4, 1e8] {
            let found = ln_probability_above(chi_squared, 2);
            assert!((found + 0.5 * chi_squared).abs() < 1e-9 * chi_squared, "{found} at {chi_squared}");
        }
    }

    /// By tables, 3.841 and 7.815 are exceeded in 5 % of cases with one and three degrees of
    /// freedom.
    #[test]
    fn tabulated_values() {
        for (chi_squared, freedom) in [(3.841_458_8, 1), (7.814_727_9, 3)] {
            assert!((ln_probability_above(chi_squared, freedom).exp() - 0.05).abs() < 1e-8);
        }
    }

    /// Both sides of the change of method agree.
    #[test]
    fn asymptotic_series_continues_the_distribution() {
        for freedom in [1, 2, 3] {
            let (below, above) = (ln_probability_above(1140.0, freedom), ln_probability_above(1170.0, freedom));
            assert!((above - below + 15.0).abs() < 0.05, "{freedom}: {below}, {above}");
        }
    }
}
