//! Strengths of tiles: in stock, and weakened by recoil.

/// The field that recoil adds to a film.
mod recoil;
/// Strengths replaced by strengths in stock.
pub(crate) mod stock_strengths;
