//! A field to a tolerance instead of the last digits, and a volume prepared for look-ups.

use std::error::Error;

use magsplice::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let layout = Layout::parse(include_str!("film.toml"), "film.toml")?;
    let exact = Scene::new(&layout.bare_tiles());
    let volume = Film::new(layout)?.volume()?.grid;
    let fine = Grid::new(volume.lower(), volume.upper(), [81, 81, 41])?;

    // The error of B may be a millionth of |B| at each point. A Chebyshev expansion of the volume
    // then takes the place of the sum over tiles.
    let tolerance = Tolerance::relative(1e-6)?;
    let fast = exact.clone().with_accuracy(Accuracy::Within(tolerance));
    let exact_t = exact.field_on_grid(Quantity::FluxDensity, &fine)?;
    let fast_t = fast.field_on_grid(Quantity::FluxDensity, &fine)?;
    let relative = |(exact, fast): (&DVec3, &DVec3)| exact.distance(*fast) / exact.length();
    let worst = exact_t.iter().zip(&fast_t).map(relative).fold(0.0, f64::max);
    println!("{} points, tolerance 1e-6 of |B|, largest error {worst:.1e}", fine.len());
    let plan = fast.plan_on_grid(&fine);
    println!("cost: {:.2} of the exact field", plan.cost() / plan.exact_cost);

    // For repeated look-ups at points that are not known in advance.
    let fitted = exact.fitted_field(volume.lower(), volume.upper(), tolerance)?;
    println!("fitted field: {} kB, error at most {:.1e} T", fitted.memory_bytes() / 1000, fitted.error_t());
    let point_mm = DVec3::new(0.3, -0.7, -4.1);
    match fitted.flux_density(point_mm) {
        Some(b_t) => println!("B at {point_mm} mm: {:.6} mT along z", 1e3 * b_t.z),
        None => println!("{point_mm} mm is outside the prepared volume"),
    }
    Ok(())
}
