//! Planes through a scan on a grid.

use glam::DVec3;
use magsplice::decouple::{Branch, Parameters};
use magsplice::results::FilmScan;

use crate::survey::as_vector;
use crate::tile_shapes::in_plane;

/// Difference of two steps of a grid, as a fraction of them, up to which a map shows them as equal:
/// cells are then in place to a tenth of their width over fifty of them.
const EQUAL_STEPS: f64 = 2e-3;

/// Readings on a plane of a scan beside the field of the layout at the same points. Values are in
/// the order of the points, second axis fastest; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScanPlane {
    /// The axis normal to the plane: 0, 1, 2 for x, y, z.
    pub(crate) normal: usize,
    /// Coordinate of the plane along it, in millimetres.
    pub(crate) at_mm: f64,
    /// Coordinates of the points along both other axes, in millimetres, ascending in equal steps.
    pub(crate) coordinates_mm: [Vec<f64>; 2],
    /// Readings in tesla without the errors of the sensor, and the field of the layout.
    pub(crate) fields_t: [Vec<DVec3>; 2],
    /// R_x, R_y, S_z of both. `None` without an ideal film.
    pub(crate) parameters: Option<[Vec<DVec3>; 2]>,
}

/// The planes of a scan that are drawn.
#[derive(Default)]
pub(crate) struct ScanPlanes {
    /// The lowest, the middle and the highest plane of constant z.
    pub(crate) level: Vec<ScanPlane>,
    /// The middle planes of constant y and of constant x.
    pub(crate) upright: Vec<ScanPlane>,
}

/// Coordinates along an axis in equal steps.
struct Steps {
    count: usize,
    first: f64,
    step: f64,
}

impl Steps {
    /// This many steps of the values, which are not empty. `None` if they are not equal.
    fn new(mut values: Vec<f64>, count: usize) -> Option<Steps> {
        // As the grid of `ScanPositions`: coordinates that differ by round-off are one.
        values.sort_by(f64::total_cmp);
        let (first, last) = (values[0], values[values.len() - 1]);
        let steps = Steps { count, first, step: if count > 1 { (last - first) / (count - 1) as f64 } else { 0.0 } };
        let from_step = |value: &f64| (steps.index(*value) - steps.index(*value).round()).abs();
        let slack = EQUAL_STEPS * values.len() as f64;
        values.iter().all(|value| from_step(value) < slack).then_some(steps)
    }

    fn index(&self, value: f64) -> f64 {
        if self.step > 0.0 { (value - self.first) / self.step } else { 0.0 }
    }

    fn value(&self, index: usize) -> f64 {
        self.first + index as f64 * self.step
    }
}

impl ScanPlanes {
    /// The planes of a scan on a grid with equal steps, of two at least along two axes; none for
    /// other positions. The parameters have this branch, with an ideal film.
    pub(crate) fn new(scanned: &FilmScan, branch: Option<Branch>) -> ScanPlanes {
        let steps = |axis: usize| {
            let values = scanned.places_mm.iter().map(|place| place[axis]).collect();
            Steps::new(values, scanned.grid?[axis])
        };
        let (Some(x), Some(y), Some(z)) = (steps(0), steps(1), steps(2)) else { return ScanPlanes::default() };
        let grid = [x, y, z];
        let counts = grid.each_ref().map(|steps| steps.count);
        let cell = |[i, j, k]: [usize; 3]| (i * counts[1] + j) * counts[2] + k;
        let mut of_cell = vec![None; counts.iter().product()];
        for (index, place) in scanned.places_mm.iter().enumerate() {
            // Repeated positions show the first reading.
            let at = [0, 1, 2].map(|axis| grid[axis].index(place[axis]).round() as usize);
            of_cell[cell(at)].get_or_insert(index);
        }
        let plane = |normal: usize, at: usize| {
            let axes = in_plane(normal);
            let mut fields_t = [Vec::new(), Vec::new()];
            for u in 0..counts[axes[0]] {
                for v in 0..counts[axes[1]] {
                    let mut indices = [at; 3];
                    (indices[axes[0]], indices[axes[1]]) = (u, v);
                    let reading = of_cell[cell(indices)];
                    for (fields_t, of) in fields_t.iter_mut().zip([&scanned.corrected_t, &scanned.simulated_t]) {
                        fields_t.push(reading.map_or(DVec3::NAN, |reading| of[reading]));
                    }
                }
            }
            let parameters = branch.map(|branch| {
                let of = |field_t: &DVec3| as_vector(Parameters::from_field(*field_t, branch));
                fields_t.each_ref().map(|fields_t| fields_t.iter().map(of).collect())
            });
            let coordinates_mm = axes.map(|axis| (0..counts[axis]).map(|n| grid[axis].value(n)).collect());
            // To the micrometre.
            let at_mm = (1e3 * grid[normal].value(at)).round() / 1e3;
            ScanPlane { normal, at_mm, coordinates_mm, fields_t, parameters }
        };
        let is_map = |normal: &usize| in_plane(*normal).iter().all(|axis| counts[*axis] > 1);
        let mut levels = vec![0, (counts[2] - 1) / 2, counts[2] - 1];
        levels.dedup();
        let levels = levels.into_iter().filter(|_| is_map(&2)).map(|k| plane(2, k)).collect();
        let upright = [1, 0].into_iter().filter(is_map).map(|normal| plane(normal, counts[normal] / 2)).collect();
        ScanPlanes { level: levels, upright }
    }
}
