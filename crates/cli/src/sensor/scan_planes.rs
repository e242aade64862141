//! Planes through a scan, as its figures show them.

use magsplice::prelude::{Branch, DVec3, Parameters};
use magsplice_report::ScanPlane;

use super::scanned_film::ScannedFilm;

/// Difference of two steps of a grid, as a fraction of them, up to which a map shows them as equal:
/// cells are then in place to a tenth of their width over fifty of them.
const EQUAL_STEPS: f64 = 2e-3;

/// The planes that are drawn, with what the parameters need.
pub(crate) struct ScanPlanes {
    /// The lowest, the middle and the highest plane of constant z.
    pub(crate) level: Vec<ScanPlane>,
    /// The middle planes of constant y and of constant x.
    pub(crate) upright: Vec<ScanPlane>,
}

impl ScanPlanes {
    /// The planes of a scan on a grid with equal steps. `None` for other positions. `branch` is
    /// that of the parameters, with an ideal film.
    pub(crate) fn new(scanned: &ScannedFilm, branch: Option<Branch>) -> Option<ScanPlanes> {
        let counts = scanned.positions.grid?;
        // As the grid of `ScanPositions`: coordinates that differ by round-off are one.
        let coordinates = [0, 1, 2].map(|axis| {
            let mut values: Vec<f64> = scanned.places_mm.iter().map(|place| place[axis]).collect();
            values.sort_by(f64::total_cmp);
            let (first, last) = (values[0], values[values.len() - 1]);
            let count = counts[axis];
            let step = if count > 1 { (last - first) / (count - 1) as f64 } else { 0.0 };
            (values, first, step)
        });
        let has_equal_steps = |(values, first, step): &(Vec<f64>, f64, f64)| {
            let index = |value: f64| if *step > 0.0 { (value - first) / step } else { 0.0 };
            values.iter().all(|value| (index(*value) - index(*value).round()).abs() < EQUAL_STEPS * values.len() as f64)
        };
        if !coordinates.iter().all(has_equal_steps) {
            return None;
        }
        let cell = |place: DVec3| {
            [0, 1, 2].map(|axis| {
                let (_, first, step) = coordinates[axis];
                if step > 0.0 { ((place[axis] - first) / step).round() as usize } else { 0 }
            })
        };
        let mut of_cell = vec![None; counts.iter().product()];
        for (index, place) in scanned.places_mm.iter().enumerate() {
            let [i, j, k] = cell(*place);
            // Repeated positions show the first reading.
            of_cell[(i * counts[1] + j) * counts[2] + k].get_or_insert(index);
        }
        let plane = |normal: usize, at: usize| {
            let axes = [[1, 2], [0, 2], [0, 1]][normal];
            let value = |axis: usize, n: usize| coordinates[axis].1 + n as f64 * coordinates[axis].2;
            let mut indices = Vec::new();
            for u in 0..counts[axes[0]] {
                for v in 0..counts[axes[1]] {
                    let mut at_cell = [at; 3];
                    (at_cell[axes[0]], at_cell[axes[1]]) = (u, v);
                    let [i, j, k] = at_cell;
                    indices.push(of_cell[(i * counts[1] + j) * counts[2] + k]);
                }
            }
            let of = |field_t: &[DVec3]| -> Vec<DVec3> {
                indices.iter().map(|index| index.map_or(DVec3::NAN, |index| field_t[index])).collect()
            };
            let fields_t = [of(&scanned.corrected_t), of(&scanned.simulated_t)];
            let parameters = branch.map(|branch| {
                let of = |field_t: &DVec3| {
                    Parameters::from_field(*field_t, branch).map_or(DVec3::NAN, |p| DVec3::new(p.r_x, p.r_y, p.s_z))
                };
                fields_t.each_ref().map(|field_t| field_t.iter().map(of).collect())
            });
            let [measured_t, simulated_t] = fields_t;
            ScanPlane {
                axes,
                at_mm: value(normal, at),
                coordinates_mm: axes.map(|axis| (0..counts[axis]).map(|n| value(axis, n)).collect()),
                measured_t,
                simulated_t,
                parameters,
            }
        };
        let mut levels = vec![0, (counts[2] - 1) / 2, counts[2] - 1];
        levels.dedup();
        let is_map = |normal: usize| (0..3).all(|axis| axis == normal || counts[axis] > 1);
        let level = if is_map(2) { levels.into_iter().map(|k| plane(2, k)).collect() } else { Vec::new() };
        let upright = [1, 0]
            .into_iter()
            .filter(|normal| is_map(*normal))
            .map(|normal| plane(normal, counts[normal] / 2))
            .collect();
        Some(ScanPlanes { level, upright })
    }
}
