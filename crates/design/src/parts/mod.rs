//! Films of few distinct parts.

/// Which tile is made of which part.
mod assignment;
/// Merging of distinct parts.
pub(crate) mod merging;
