//! Fields of endless patterns.

/// Endless splicing patterns, against very large films.
mod endless_pattern;
/// Iron near shipped films.
mod iron;
