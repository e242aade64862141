//! Polynomials for firmware keep their error between the points at which it was measured.

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_field::Scene;
use magsplice_head::SensorHead;
use magsplice_layout::Layout;
use magsplice_magnet::HallSensor;
use magsplice_sensor::{DisplacementPolynomial, SensedField};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The length of the error at random points, and from the worst of them on at points ever nearer,
/// is below the stated bound, and the bound is at most a third above the largest error found.
#[test]
fn length_of_the_error_is_bounded_between_the_measured_points() {
    for (name, error) in [("published-film", 1e-3), ("robust-in-plane", 5e-3), ("heads/published-cross", 5e-3)] {
        let layout = Layout::read(format!("../../layouts/{name}.toml")).unwrap_or_else(|e| panic!("{e}"));
        let (scene, volume) = (Scene::new(&layout.bare_tiles()), layout.volume.expect("a volume"));
        let one = SensorHead::from(HallSensor::default());
        let sensed = SensedField::of_head(&scene, layout.head().unwrap_or(&one), &volume.grid).unwrap();
        let found = DisplacementPolynomial::fit(sensed.clone(), &volume.grid, volume.reference_mm, error).unwrap();
        assert!(found.largest_error <= error, "{name}: {}", found.largest_error);
        let branch = Branch::from_axis_field(sensed.readings_t(&[volume.reference_mm]).unwrap()[0]).unwrap();
        let lengths_at = |points: &[DVec3]| -> Vec<(f64, DVec3)> {
            let of = |(point, b_t): (&DVec3, DVec3)| {
                let Parameters { r_x, r_y, s_z } = Parameters::from_field(b_t, branch).unwrap();
                let moved = *point - volume.reference_mm;
                ((found.displacement([r_x, r_y, s_z]) - moved).length(), *point)
            };
            points.iter().zip(sensed.readings_t(points).unwrap()).map(of).collect()
        };
        let (lower, upper) = (volume.grid.lower(), volume.grid.upper());
        let mut random = ChaCha8Rng::seed_from_u64(9);
        let mut deviate = || DVec3::from([(); 3].map(|()| random.random::<f64>()));
        // Errors are largest near the faces, where sines of uniform angles are dense.
        let near_faces = |_| {
            let fraction = (std::f64::consts::FRAC_PI_2 * deviate()).to_array().map(|turn| turn.sin().powi(2));
            lower + (upper - lower) * DVec3::from(fraction)
        };
        let points: Vec<DVec3> = (0..20_000).map(near_faces).collect();
        let mut worst = lengths_at(&points).into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        for round in 0..2000 {
            let reach = 0.05 * 0.997_f64.powi(round);
            let point = worst.1 + reach * (upper - lower) * (2.0 * deviate() - 1.0);
            let point = point.clamp(lower, upper);
            worst = [worst, lengths_at(&[point])[0]].into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        }
        println!("{name} {error}: degree {}, {} found, {} stated", found.degree, worst.0, found.largest_error);
        assert!(worst.0 <= found.largest_error, "{name}: {worst:?}, stated {}", found.largest_error);
        assert!(found.largest_error <= 1.34 * worst.0, "{name}: {worst:?}, stated {}", found.largest_error);
    }
}
