//! JSON forms of results. Keys carry the units of their values.

/// `assign`: the errors of the film, and the plan.
pub(crate) mod assign;
/// `budget`: where the displacement error comes from.
pub(crate) mod budget;
/// `calibrate`.
pub(crate) mod calibrate;
/// `design --front`: the films of a front.
pub(crate) mod design;
/// `diagnose`: the tiles that are wrong, and what the scan cannot tell.
pub(crate) mod diagnose;
/// `read`.
pub(crate) mod read;
/// `scan`.
pub(crate) mod scan;
/// `tolerance`: statistics of samples.
pub(crate) mod tolerance;

pub(crate) use crate::output::json::pretty;
