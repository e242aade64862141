//! Strengths of tiles: those in stock, and what recoil takes from them.

/// What recoil adds to the field of a film.
mod recoil;
/// Strengths replaced by strengths in stock.
pub(crate) mod stock_strengths;
