//! One file per verb.

pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod decouple;
pub(crate) mod field;
#[cfg(feature = "report")]
pub(crate) mod report;
