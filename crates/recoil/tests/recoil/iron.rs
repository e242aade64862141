//! Flat iron by its images, against a plate of soft cells.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{IronPlane, IronPlanes, Quantity};
use magsplice_recoil::{Magnetization, RecoilTile};

use crate::magnet;

/// Boundaries of the boxes of the plate, from its middle outwards and from its face downwards, in
/// millimetres. The plate is 44 mm wide and 16 mm thick.
const ACROSS_MM: [f64; 9] = [0.0, 0.5, 1.0, 1.6, 2.4, 3.6, 6.0, 11.0, 22.0];
const DOWN_MM: [f64; 7] = [0.0, 0.5, 1.1, 2.0, 3.6, 7.0, 16.0];

/// Magnet above the plate.
const SIDE_MM: f64 = 2.0;
const GAP_MM: f64 = 1.0;

/// The boxes of the plate, with every boundary or every second one.
fn plate(step: usize, mu_r: f64) -> Vec<RecoilTile> {
    let half: Vec<f64> = ACROSS_MM.into_iter().step_by(step).collect();
    let across: Vec<f64> = half.iter().skip(1).rev().map(|x| -x).chain(half.iter().copied()).collect();
    let down: Vec<f64> = DOWN_MM.into_iter().step_by(step).collect();
    let mut boxes = Vec::new();
    for x in across.windows(2) {
        for y in across.windows(2) {
            for z in down.windows(2) {
                let (lower, upper) = (DVec3::new(x[0], y[0], -z[1]), DVec3::new(x[1], y[1], -z[0]));
                let (size, centre) = (upper - lower, 0.5 * (lower + upper));
                boxes.push(magnet(size.to_array(), centre.to_array(), [0.0; 3], mu_r));
            }
        }
    }
    boxes
}

/// The field of the plate at points that are as far from it as its boxes are large, from boxes of
/// two sizes. What is left is the next order in their size, and the end of the plate: (5 mm / 44
/// mm)^3, some tenths of a per cent. Without images the error would be 1.
#[test]
fn a_thick_plate_of_soft_cells_has_the_field_of_images() {
    let points = [[1.5, 0.5, 1.0], [2.5, 1.0, 2.0], [0.5, 0.0, 4.0], [2.5, 1.5, 1.6], [0.0, 0.5, 5.0]];
    let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
    for (mu_r, j_t) in [(4.0, [1.0, 0.0, 0.0]), (20.0, [0.0, 0.0, 1.0])] {
        let cube = magnet([SIDE_MM; 3], [0.0, 0.0, GAP_MM + 0.5 * SIDE_MM], j_t, 1.0);
        let plane = IronPlane::new(DVec3::ZERO, DVec3::Z, mu_r).unwrap();
        let images = IronPlanes::new(vec![plane]).unwrap().images(&[cube.tile]).unwrap();
        let by_images_t = Scene::new(&images.tiles).field_at(Quantity::FluxDensity, &points).unwrap();
        let of_plate_t = |step: usize| {
            let solution = Magnetization::solve(&[&[cube][..], &plate(step, mu_r)].concat(), 1, |_| {}).unwrap();
            Scene::new(&solution.cells()[1..]).field_at(Quantity::FluxDensity, &points).unwrap()
        };
        let [coarse_t, fine_t] = [2, 1].map(of_plate_t);
        for (index, image_t) in by_images_t.iter().enumerate() {
            // The error falls as the square of the sides of the boxes.
            let limit_t = fine_t[index] + (fine_t[index] - coarse_t[index]) / 3.0;
            let error = (limit_t - *image_t).length() / image_t.length();
            assert!(error < 0.01, "mu_r {mu_r}, {}: {limit_t}, not {image_t}: {error}", points[index]);
        }
    }
}
