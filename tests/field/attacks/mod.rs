//! Adversarial scenes against an oracle of many digits.
//!
//! `cargo test -p magsplice-tests --features all-cases --test field attacks -- --nocapture` runs
//! all scenes and prints the largest ratios of errors to bounds. With `MAGSPLICE_SCENES=2000..3000`
//! in the environment only the scenes with these numbers run, which divides a run of hours.

use std::ops::Range;
use std::time::{Duration, Instant};

/// Hill climbs on the errors of the exact field and of the gradient.
mod climbs;
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

/// The numbers of a test's scenes: from `MAGSPLICE_SCENES`, else 10 000 with the feature
/// `all-cases`, else a few.
fn scene_numbers(few: u64) -> Range<u64> {
    let Ok(asked) = std::env::var("MAGSPLICE_SCENES") else {
        return 0..if cfg!(feature = "all-cases") { 10_000 } else { few };
    };
    let numbers = asked.split_once("..").and_then(|(first, end)| Some(first.parse().ok()?..end.parse().ok()?));
    let numbers = numbers.filter(|numbers| !numbers.is_empty());
    numbers.unwrap_or_else(|| panic!("MAGSPLICE_SCENES = {asked}, must be two numbers, as in 2000..3000"))
}

/// Time after which a scene is printed, to find scenes that do not end.
const SLOW: Duration = Duration::from_secs(20);

/// The findings in a scene. Slow scenes are printed.
fn timed<T>(findings: impl Fn(u64) -> T) -> impl Fn(u64) -> T {
    move |number| {
        let start = Instant::now();
        let found = findings(number);
        if start.elapsed() > SLOW {
            println!("scene {number}: {:.0?}", start.elapsed());
        }
        found
    }
}
