//! One file per verb.

pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod decouple;
pub(crate) mod design;
pub(crate) mod export;
pub(crate) mod field;
pub(crate) mod init;
pub(crate) mod plan;
#[cfg(feature = "report")]
pub(crate) mod report;
pub(crate) mod schema;
pub(crate) mod tiles;
