//! `--within`: the accuracy of a field.

use magsplice::magnet::{Accuracy, Tolerance};

#[derive(clap::Args)]
pub(crate) struct AccuracyArgs {
    /// Largest accepted error of B (of mu0 H for H): a fraction of |B| such as 1e-6, or a value
    /// with a unit (T, mT, uT, nT) such as 10nT
    ///
    /// Without it the field is exact up to round-off. With it the program chooses the cheapest
    /// method that keeps the tolerance at every point; where no method keeps it, the program names
    /// the points. This may be faster where many points lie away from the tiles; `magsplice plan`
    /// tells. J and the gradient are always exact.
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

/// Units of an absolute tolerance, and how many of each make one tesla. `T` is the last, because
/// the other names end in it too.
const UNITS_PER_T: [(&str, f64); 4] = [("mT", 1e3), ("uT", 1e6), ("nT", 1e9), ("T", 1.0)];

fn tolerance(text: &str) -> Result<Tolerance, String> {
    let unit = UNITS_PER_T.iter().find_map(|(name, per_t)| Some((text.strip_suffix(name)?.trim_end(), per_t)));
    let number = unit.map_or(text, |(number, _)| number);
    let value: f64 = number.parse().map_err(|_| {
        "must be a number: a fraction of |B| such as 1e-6, or a value with a unit (T, mT, uT, nT) such as 10nT"
            .to_owned()
    })?;
    let tolerance = match unit {
        // Divided, so that 2.5 uT is 2.5e-6 T to the last digit.
        Some((_, per_t)) => Tolerance::absolute_t(value / per_t),
        None if value >= LARGEST_FRACTION => {
            return Err(format!(
                "{value} is {} % of |B|, must be a fraction below {LARGEST_FRACTION}; a field has a unit, as in {number}nT",
                100.0 * value
            ));
        }
        None => Tolerance::relative(value),
    };
    tolerance.map_err(|error| error.to_string())
}
