//! Planes through a scan as figures, measured beside simulated.

use glam::DVec3;
use magsplice::Film;
use magsplice::decouple::{Branch, Parameters};
use magsplice::results::FilmScan;

use crate::drawing::{Drawing, SvgText};
use crate::error::ReportError;
use crate::figures::scan_maps::{ScanPlane, scan_field_figure, scan_parameters_figure};

const FIELDS: [&str; 3] = ["scan-field-lowest", "scan-field-middle", "scan-field-highest"];
const LEVEL: [&str; 3] = ["scan-parameters-lowest", "scan-parameters-middle", "scan-parameters-highest"];
const UPRIGHT: [&str; 2] = ["scan-parameters-upright-y", "scan-parameters-upright-x"];

/// Figures of planes of a scan: B, and with an ideal film R_x, R_y, S_z (Dai 2024, Figs. 6 to 8).
/// Empty for positions that are no grid with equal steps, of two at least along two axes.
///
/// # Errors
/// [`ReportError::Drawing`] if a figure cannot be drawn.
pub fn scan_figures(film: &Film, scan: &FilmScan) -> Result<Vec<Drawing>, ReportError> {
    ScanPlanes::new(scan, film.branch()).map_or(Ok(Vec::new()), |planes| drawn(&planes))
}

fn drawn(planes: &ScanPlanes) -> Result<Vec<Drawing>, ReportError> {
    let mut figures = Vec::new();
    // The last of one or two planes is the highest.
    let named = |names: [&'static str; 3]| -> Vec<(&'static str, &ScanPlane)> {
        let names = if planes.level.len() == 2 { vec![names[0], names[2]] } else { names.to_vec() };
        names.into_iter().zip(&planes.level).collect()
    };
    for (name, plane) in named(FIELDS) {
        figures.push(scan_field_figure(plane, name, SvgText::Text)?);
    }
    for (name, plane) in named(LEVEL).into_iter().chain(UPRIGHT.into_iter().zip(&planes.upright)) {
        figures.extend(scan_parameters_figure(plane, name, SvgText::Text)?);
    }
    Ok(figures)
}

/// Difference of two steps of a grid, as a fraction of them, up to which a map shows them as equal:
/// cells are then in place to a tenth of their width over fifty of them.
const EQUAL_STEPS: f64 = 2e-3;

/// The planes that are drawn, with what the parameters need.
struct ScanPlanes {
    /// The lowest, the middle and the highest plane of constant z.
    level: Vec<ScanPlane>,
    /// The middle planes of constant y and of constant x.
    upright: Vec<ScanPlane>,
}

impl ScanPlanes {
    /// The planes of a scan on a grid with equal steps. `None` for other positions. `branch` is
    /// that of the parameters, with an ideal film.
    fn new(scanned: &FilmScan, branch: Option<Branch>) -> Option<ScanPlanes> {
        let counts = scanned.grid?;
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
