//! Samples of real films: what they are samples of, their figures in files, and runs that can be
//! continued.

/// Results of `budget`: where the displacement error comes from.
pub(crate) mod film_budget;
/// The journal of a run: every sample as soon as it is known.
pub(crate) mod journal;
/// The evaluation of samples in stretches.
pub(crate) mod run;
/// Tables of the figures of samples.
pub(crate) mod sample_file;
/// Results of `tolerance`: statistics of the samples of a film.
pub(crate) mod sampled_film;
/// A film whose samples are drawn.
pub(crate) mod scene;
/// What samples are samples of.
pub(crate) mod source;
