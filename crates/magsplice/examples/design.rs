//! A search for a better film: the cut lines of the published film are moved.

use std::error::Error;
use std::ops::ControlFlow;

use magsplice::design::Setting;
use magsplice::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    // [design] of the layout says what may change and which error is to become small.
    let layout = Layout::parse(include_str!("film.toml"), "film.toml")?;
    let problem = Setting::of(&layout)?;
    println!("{}: {} free numbers", layout.name, problem.free());

    // The closure hears of the progress and may stop the search.
    let result = problem.search(&|_progress| ControlFlow::Continue(()))?;
    let [before_mm, after_mm] = [result.before, result.after].map(|figures| problem.displacement_mm(&figures));
    println!("error of displacement along x, before: {:.4} mm", before_mm[0]);
    println!("error of displacement along x, after:  {:.4} mm", after_mm[0]);
    println!("best-fit amplitude: {:.4} before, {:.4} after", result.before.amplitude, result.after.amplitude);

    // The film found is a layout again, which can be written to a file.
    let better = problem.layout_of(&result, "examples/design.rs");
    println!("its layout has {} lines", better.to_toml().lines().count());
    Ok(())
}
