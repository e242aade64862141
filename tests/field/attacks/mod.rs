//! Adversarial scenes against an oracle of many digits.
//!
//! `cargo test -p magsplice-tests --features all-cases --test field attacks -- --nocapture` runs all
//! scenes and prints how close they come to what is promised.

/// The bound of the exact field.
mod exact_bound;
/// Boxes prepared for repeated look-ups.
mod fitted_fields;
/// True fields of adversarial scenes.
mod reference;
/// Adversarial scenes.
mod scenes;
/// Tolerances on grids and at points.
mod tolerances;

/// The stated bound of the exact field, as a fraction of the sum over tiles of the magnitudes of the
/// fields that the components of J make alone.
const EXACT_BOUND: f64 = 2e-14;

/// The numbers of the scenes that a test runs: 10 000 with the feature `all-cases`, else a few.
fn scene_numbers(few: u64) -> std::ops::Range<u64> {
    0..if cfg!(feature = "all-cases") { 10_000 } else { few }
}
