//! Levels.

use std::time::Instant;

use glam::DVec3;
use magsplice_decouple::Decoupling;
use magsplice_field::Scene;
use magsplice_layout::Layout;
use magsplice_magnet::{Quantity, Tile};
use magsplice_recoil::{Magnetization, Permeability, RecoilTile};

const LEVELS: usize = 4;
fn main() {
    for path in std::env::args().skip(1) {
        let layout = Layout::read(&path).unwrap_or_else(|error| panic!("{error}"));
        let (ideal, volume) = (layout.ideal.unwrap(), layout.volume.as_ref().unwrap());
        let r_x = |tiles: &[Tile]| {
            let scene = Scene::new(tiles);
            let field = scene.field_on_grid(Quantity::FluxDensity, &volume.grid).unwrap();
            let reference: DVec3 = scene.field(Quantity::FluxDensity, volume.reference_mm).unwrap();
            let d = Decoupling::from_field(&volume.grid, &field, (volume.reference_mm, reference), &ideal).unwrap();
            d.uniformity_rmse.r_x
        };
        println!("{path} rigid {:.6e}", r_x(&layout.bare_tiles()));
        for mu_r in [1.2] {
            let permeability = Permeability::isotropic(mu_r).unwrap();
            let tiles: Vec<RecoilTile> =
                layout.bare_tiles().into_iter().map(|tile| RecoilTile { tile, permeability }).collect();
            for level in 1..=LEVELS {
                let start = Instant::now();
                let solution = Magnetization::solve(&tiles, level, || {}).unwrap_or_else(|error| panic!("{error}"));
                println!(
                    "{mu_r} {level} {} {:.8e} {:.1?}",
                    solution.cells().len(),
                    r_x(solution.cells()),
                    start.elapsed()
                );
            }
        }
    }
}
