//! Films as made of tiles with a recoil permeability, against the solution of each.

use magsplice::Film;
use magsplice::layout::{Distribution, FilmTolerance, NamedTile, TileErrors};
use magsplice::prelude::*;
use magsplice::recoil::{Magnetization, Permeability, RecoilTile};
use magsplice::tolerance::{EvaluationGrid, RealFilm, Sampler};

use crate::shipped::layout;

/// Gap on each side of the tiles, which prevents overlaps of misplaced tiles.
const GAP_MM: f64 = 0.1;

/// Largest difference of a displacement error, as a share of the susceptibility. The difference of
/// the field is the field of a tile in its neighbours times the susceptibility, 0.1 to 0.4 of it; a
/// root mean square along one axis has a part of it.
const NEGLECTED: f64 = 0.4;

/// A sample has the errors of its tiles and neglects their effect on the polarization of other
/// tiles. The solution of the sample, with as many cells, has nearly the same errors.
#[test]
fn errors_of_films_with_recoil_are_those_of_solved_films() {
    let [strength, degree, place] = [0.03, 1.0_f64.to_radians(), 0.02].map(Distribution::normal);
    let errors = TileErrors {
        strength,
        direction: [degree.clone(), degree],
        position: [place.clone(), place.clone(), place],
        ..TileErrors::default()
    };
    for (name, mu_r) in [("designed-displacement", 1.05), ("designed-displacement", 1.2), ("designed-tilted", 1.05)] {
        let mut layout = layout(name);
        for NamedTile { tile, .. } in &mut layout.tiles {
            *tile = Tile::new(tile.position(), tile.size() - 2.0 * GAP_MM, tile.polarization_t()).unwrap();
        }
        let permeability = Permeability::isotropic(mu_r).unwrap();
        layout.material.permeability = permeability;
        let tolerance = FilmTolerance::of_tiles(&errors, layout.tiles.len());
        layout.tolerance = Some(tolerance.clone());
        let (volume, ideal) = (layout.volume.as_ref().unwrap(), layout.ideal.unwrap());
        let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };

        let film = Film::new(layout.clone()).unwrap();
        let real = film.real_film().unwrap();
        let sampler = Sampler::new(&real, &volume, &ideal, 1).unwrap();
        let bare = RealFilm::new(&layout.bare_tiles(), &tolerance);
        let level = film.recoil().expect("it has a permeability").summary.level;
        for sample in 0..4 {
            let tiles: Vec<RecoilTile> = bare
                .sample_tiles(1, sample)
                .unwrap()
                .into_iter()
                .map(|tile| RecoilTile { tile, permeability })
                .collect();
            let solved = Scene::new(Magnetization::solve(&tiles, &layout.iron, level, |_| {}).unwrap().cells());
            let field_t = solved.field_on_grid(Quantity::FluxDensity, &volume.grid).unwrap();
            let reference_t = solved.field(Quantity::FluxDensity, volume.reference).unwrap();
            let of_solved = volume.figures(&field_t, reference_t, &ideal).unwrap();
            let of_sample = sampler.errors_of(sample).unwrap();
            for (axis, solved_mm) in of_solved.displacement_rmse_mm.to_array().into_iter().enumerate() {
                let sample_mm = of_sample.displacement_rmse_mm.to_array()[axis];
                assert!(
                    (sample_mm - solved_mm).abs() <= NEGLECTED * (mu_r - 1.0) * solved_mm,
                    "{name} {mu_r}, sample {sample}, axis {axis}: {sample_mm} mm, solved {solved_mm} mm"
                );
            }
        }
    }
}
