//! A search for a better film: the cut lines of the published film are moved.

use std::error::Error;

use magsplice::design::{DesignProblem, ignore_progress};
use magsplice::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    // [design] of the layout says what may change and which error is to become small.
    let layout = Layout::parse(include_str!("film.toml"), "film.toml")?;
    let problem = DesignProblem::new(&layout)?;
    println!("{}: {} free parameters", layout.name, problem.variable_count());

    // Another callback in place of `ignore_progress` is told the progress and may stop the search.
    let result = problem.search(&ignore_progress)?;
    let [before_mm, after_mm] = [result.before, result.after].map(|metrics| metrics.figures.displacement_rmse_mm);
    println!("error of displacement along x, before: {:.4} mm", before_mm.x);
    println!("error of displacement along x, after:  {:.4} mm", after_mm.x);
    let [before, after] = [result.before, result.after].map(|metrics| metrics.figures.amplitude);
    println!("best-fit amplitude: {before:.4} before, {after:.4} after");

    // The film found is a layout again, which can be written to a file.
    let better = problem.designed_layout(&result, "examples/design.rs");
    println!("its layout has {} lines", better.to_toml().lines().count());
    Ok(())
}
