//! Uniformity RMSE of R_x of films whose tiles have a recoil permeability:
//!
//!     cargo run --release -p magsplice-recoil --example films -- layouts/published-film.toml layouts/designed-tilted.toml
//!
//! The arguments are layouts with `[ideal]` and `[volume]`. Their polarizations are J_r. The table
//! holds the value without permeability, the first-order estimate of one cell for each tile, the
//! value at the highest level, the value extrapolated from all levels with its error, and the
//! weakening of tiles.

use std::error::Error;
use std::time::Instant;

use magsplice_decouple::Decoupling;
use magsplice_field::Scene;
use magsplice_layout::Layout;
use magsplice_magnet::{Quantity, Tile};
use magsplice_recoil::{Magnetization, Permeability, RecoilTile, extrapolated_at, highest_level};

const PERMEABILITIES: [f64; 4] = [1.0, 1.05, 1.1, 1.2];

/// Level 4 of 56 compact tiles has 3584 cells.
const MOST_CELLS: usize = 4_500;

/// Uniformity RMSE of R_x over the working volume; NaN where it is undefined.
fn uniformity_r_x(layout: &Layout, tiles: &[Tile]) -> f64 {
    let (Some(ideal), Some(volume)) = (&layout.ideal, &layout.volume) else {
        return f64::NAN;
    };
    let scene = Scene::new(tiles);
    let field_t = scene.field_on_grid(Quantity::FluxDensity, &volume.grid);
    let reference_t = scene.field(Quantity::FluxDensity, volume.reference_mm);
    let (Ok(field_t), Ok(reference_t)) = (field_t, reference_t) else {
        return f64::NAN;
    };
    let reference = (volume.reference_mm, reference_t);
    Decoupling::from_field(&volume.grid, &field_t, reference, ideal)
        .ok()
        .and_then(|d| d.uniformity_rmse.r_x)
        .unwrap_or(f64::NAN)
}

fn main() -> Result<(), Box<dyn Error>> {
    for path in std::env::args().skip(1) {
        let layout = Layout::read(&path)?;
        println!("{}", layout.name);
        println!("  mu_r  first order      at level    value       +-          cells  weakening  time/s");
        for mu_r in PERMEABILITIES {
            let permeability = Permeability::isotropic(mu_r)?;
            let tiles: Vec<RecoilTile> =
                layout.bare_tiles().into_iter().map(|tile| RecoilTile { tile, permeability }).collect();
            let estimate =
                uniformity_r_x(&layout, Magnetization::first_order(&tiles, &layout.iron, 1, |_| {})?.cells());
            let start = Instant::now();
            let level = highest_level(&tiles, MOST_CELLS);
            let refined = extrapolated_at(
                &tiles,
                &layout.iron,
                level,
                &[],
                |cells| vec![uniformity_r_x(&layout, cells)],
                |_| {},
            )?;
            let cells = refined.magnetization.cells();
            let changes = refined.magnetization.tile_changes();
            let weakening = changes.iter().map(|change| change.weakening).sum::<f64>() / changes.len() as f64;
            println!(
                "  {mu_r:<4}  {estimate:.4e}  {} {:.4e}  {:.4e}  {:.1e}  {:>9}  {weakening:>9.4}  {:.1}",
                refined.level,
                uniformity_r_x(&layout, cells),
                refined.values[0],
                refined.errors[0],
                cells.len(),
                start.elapsed().as_secs_f64()
            );
        }
    }
    Ok(())
}
