//! `--within`: the accuracy of a field.

use magsplice::layout::tolerance_of_text;
use magsplice::magnet::{Accuracy, Tolerance};

#[derive(clap::Args)]
pub(crate) struct AccuracyArgs {
    /// Largest accepted error of B (of mu0 H for H): a fraction of |B| such as 1e-6, or a value
    /// with a unit (T, mT, uT or µT, nT) such as 10nT
    ///
    /// Without it the field is exact up to round-off. With it the program chooses the cheapest
    /// method that keeps the tolerance at every point; where no method keeps it, the program lists
    /// the points. A tolerance saves time if many points lie away from the tiles; `magsplice plan`
    /// shows where. J and the gradient are always exact.
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance_of_text, allow_hyphen_values = true)]
    within: Option<Tolerance>,
}

impl AccuracyArgs {
    /// The accuracy asked for; exact without `--within`.
    pub(crate) fn accuracy(&self) -> Accuracy {
        self.within.map_or(Accuracy::Exact, Accuracy::Within)
    }
}
