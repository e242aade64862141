//! `--within`: the accuracy of a field.

use magsplice::magnet::{Accuracy, Tolerance};

use super::numbers;
use crate::decimal;
use crate::text::units::in_per_cent;

#[derive(clap::Args)]
pub(crate) struct AccuracyArgs {
    /// Largest accepted error of B (of mu0 H for H): a fraction of |B| such as 1e-6, or a value
    /// with a unit (T, mT, uT or µT, nT) such as 10nT
    ///
    /// Without it the field is exact up to round-off. With it the program chooses the cheapest
    /// method that keeps the tolerance at every point; where no method keeps it, the program lists
    /// the points. A tolerance saves time if many points lie away from the tiles; `magsplice plan`
    /// shows where. J and the gradient are always exact.
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance, allow_hyphen_values = true)]
    within: Option<Tolerance>,
}

impl AccuracyArgs {
    /// The accuracy asked for; exact without `--within`.
    pub(crate) fn accuracy(&self) -> Accuracy {
        self.within.map_or(Accuracy::Exact, Accuracy::Within)
    }
}

/// Fraction of |B| that is too large for a tolerance: it was probably meant as a field.
const LARGEST_FRACTION: f64 = 0.1;

fn tolerance(text: &str) -> Result<Tolerance, String> {
    if let Some(percent) = text.trim().strip_suffix('%') {
        // The decimal point moves in the text, so that 5 % is the 0.05 that the user will type.
        let fraction = decimal::scaled(percent.trim(), -2).map_or("0.05".to_owned(), |value| value.to_string());
        return Err(format!(
            "a fraction of |B| is written without a unit: {fraction}; it must be below {LARGEST_FRACTION}. A field has a \
             unit (T, mT, uT, nT), as in 10nT"
        ));
    }
    let in_tesla = numbers::flux_density_or_fraction_t(text)?;
    let tolerance = match in_tesla {
        Some(value) => Tolerance::absolute_t(value),
        None => {
            let fraction: f64 = text.trim().parse().map_err(|_| {
                "must be a number: a fraction of |B| such as 1e-6, or a value with a unit (T, mT, uT, nT) such as 10nT"
                    .to_owned()
            })?;
            if fraction >= LARGEST_FRACTION {
                return Err(format!(
                    "{fraction} is {} % of |B|, must be a fraction below {LARGEST_FRACTION}; a field has a unit, as in {}nT",
                    in_per_cent(fraction),
                    text.trim()
                ));
            }
            Tolerance::relative(fraction)
        }
    };
    tolerance.map_err(|error| error.to_string())
}
