//! What the commands about films as made share: the errors that they need, and their failures.

use magsplice::FilmError;

use super::sample_file::MAX_SAMPLES;
use crate::failure::Failure;
use crate::session::Session;

/// The failure of a film that cannot be sampled.
pub(crate) fn sampling_failure(session: &Session, error: FilmError) -> Failure {
    let message = match error {
        FilmError::Sample { error, .. } => error.to_string(),
        FilmError::Sorting(error) => error.to_string(),
        error => return session.failed(error),
    };
    Failure::at(session.path, message)
}

/// Refuses a layout without the errors of films as made.
pub(crate) fn require_errors(session: &Session) -> Result<(), Failure> {
    session.require_film(true, "tolerance", "evaluates films as made")?;
    require_tolerance(session)
}

/// Refuses a layout without [tolerance].
pub(super) fn require_tolerance(session: &Session) -> Result<(), Failure> {
    if session.layout.tolerance.is_some() {
        return Ok(());
    }
    let message = "the layout has no [tolerance] table with the errors of films as made: give --preset workshop to \
                   begin with, or add the table that docs/layout-format.md describes; for noise alone, give noise_ut \
                   in [tolerance.sensor]";
    Err(Failure::at(session.path, message.to_owned()))
}

/// The number of a sample, as an argument.
pub(super) fn sample_number(text: &str) -> Result<u64, String> {
    let number = text.parse().ok().filter(|n| *n < MAX_SAMPLES);
    number.ok_or_else(|| format!("must be a whole number below {MAX_SAMPLES}: samples are counted from 0"))
}
