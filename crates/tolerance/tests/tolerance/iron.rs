//! Iron near the shipped films.

use magsplice_layout::{FilmTolerance, Layout, NearIron};
use magsplice_tolerance::{EvaluationGrid, RealFilm, Sampler};

/// Distances of the iron from the upper face, in mm.
const DISTANCES_MM: [f64; 5] = [0.5, 1.0, 2.0, 5.0, 10.0];

/// Errors of displacements along x and z after iron appears, in mm, computed apart from this
/// program.
const FILMS: [(&str, [[f64; 2]; 5]); 4] = [
    ("designed-displacement", [[0.000, 0.533], [0.000, 0.262], [0.001, 0.070], [0.001, 0.002], [0.001, 0.001]]),
    ("robust-in-plane", [[0.015, 0.534], [0.017, 0.260], [0.019, 0.061], [0.012, 0.013], [0.005, 0.007]]),
    ("robust-tilted", [[0.176, 0.459], [0.111, 0.293], [0.050, 0.129], [0.006, 0.014], [0.002, 0.002]]),
    ("designed-tilted", [[0.181, 0.349], [0.153, 0.128], [0.120, 0.079], [0.061, 0.074], [0.021, 0.024]]),
];

#[test]
fn iron_moves_the_readings_of_shipped_films() {
    for (name, known) in FILMS {
        let layout = Layout::read(format!("../../layouts/{name}.toml")).unwrap_or_else(|e| panic!("{e}"));
        let volume = layout.volume.expect("a volume");
        let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
        for (distance_mm, [x_mm, z_mm]) in DISTANCES_MM.into_iter().zip(known) {
            let mut tolerance = FilmTolerance::default();
            tolerance.common.iron = Some(NearIron { distance_mm, ..NearIron::default() });
            let film = RealFilm::new(&layout.bare_tiles(), &tolerance);
            let ideal = layout.ideal.expect("an ideal film");
            let errors = Sampler::new(&film, &volume, &ideal, 1).and_then(|sampler| sampler.errors_of(0));
            let found_mm = errors.expect("a sample").displacement_rmse_mm;
            let agrees = |found_mm: f64, known_mm: f64| (found_mm - known_mm).abs() < 5.1e-4;
            assert!(agrees(found_mm.x, x_mm) && agrees(found_mm.z, z_mm), "{name}, {distance_mm} mm: {found_mm:?}");
        }
    }
}

/// Iron at a distance c multiplies the field of an in-plane film without end, of thickness d, by
/// 1 - exp(-k (d + 2 c)), so that z is wrong by its logarithm over k. Designed ends leave 1 um.
#[test]
fn iron_scales_the_field_of_a_film_without_end() {
    let wavenumber = std::f64::consts::TAU / 10.0;
    for (distance_mm, [_, z_mm]) in DISTANCES_MM.into_iter().zip(FILMS[0].1).take(3) {
        let known_mm = -(1.0 - (-wavenumber * (1.0 + 2.0 * distance_mm)).exp()).ln() / wavenumber;
        assert!((z_mm - known_mm).abs() < 1e-3, "{distance_mm} mm: {z_mm}, not {known_mm}");
    }
}
