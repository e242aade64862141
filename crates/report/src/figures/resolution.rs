//! The standard deviations of displacements that the noise of the sensor causes, on planes of
//! constant z.

use glam::DVec3;
use magsplice::Film;
use magsplice::layout::WorkingVolume;
use magsplice::prelude::Grid;
use magsplice::sensor::Noise;

use crate::colours::ColourScale;
use crate::csv::csv_of_vectors;
use crate::drawing::FigureDraft;
use crate::error::ReportError;
use crate::shared_ranges::SharedRanges;
use crate::survey::{cells_of_plane, mapped_region};
use crate::typeset::{AXIS_NAMES, plane, variable};

use super::map_grid::{BESIDE_PX, FIRST_PX, GAP_PX, GridMap, MapColumn, MapGrid, ROOM_PX, map_size};

const UM_PER_MM: f64 = 1e3;
/// Number of cells along a side of a map. A deviation takes a gradient for each node of the active
/// area.
const CELLS: usize = 48;

const CAPTION: &str = "Resolution: the standard deviation of the displacement along x, y and z that the noise of the \
    sensor and its counts cause, by the field of the layout. No unbiased estimate from one reading has a smaller \
    standard deviation. Grey: beyond the range of the sensor.";

/// Deviations on one plane of constant z.
struct Plane {
    grid: Grid,
    z_mm: f64,
    /// In um along x, y, z; NaN where the reading is out of range.
    deviations_um: Vec<DVec3>,
}

/// The figure of planes through the working volume at these heights: one column per plane, one row
/// per axis. `None` if the layout states no noise of its sensor.
pub(crate) fn draft(
    film: &Film,
    volume: &WorkingVolume,
    heights_mm: &[f64],
    ranges: &SharedRanges,
) -> Result<Option<FigureDraft>, ReportError> {
    let sensed = film.sensed_field(&volume.grid)?;
    let sensor = *sensed.sensor();
    let Some(noise) = Noise::of_sensor(&sensor) else { return Ok(None) };
    let on_plane = |&z_mm: &f64| {
        let grid = cells_of_plane(volume, 2, z_mm, CELLS);
        let points: Vec<DVec3> = grid.points().collect();
        let (readings_t, gradients) = sensed.readings_and_gradients(&points);
        let of_point = |(reading, gradient)| {
            let seen = noise.of_position(gradient).filter(|_| !sensor.is_saturated(sensor.digitized_t(reading)));
            seen.map_or(DVec3::NAN, |deviation| UM_PER_MM * deviation)
        };
        Plane { grid, z_mm, deviations_um: readings_t.into_iter().zip(gradients).map(of_point).collect() }
    };
    let planes: Vec<Plane> = heights_mm.iter().map(on_plane).collect();
    let rows = planes.iter().flat_map(|plane| plane.grid.points().zip(plane.deviations_um.iter().copied()));
    let header = "x_mm,y_mm,z_mm,deviation_x_um,deviation_y_um,deviation_z_um";
    let csv = csv_of_vectors(header, rows.map(|(point, deviation)| [point, deviation]));
    FigureDraft::of_maps("resolution", CAPTION, maps(&planes, volume, ranges), csv).map(Some)
}

fn maps(planes: &[Plane], volume: &WorkingVolume, ranges: &SharedRanges) -> MapGrid {
    let axes = [0, 1];
    let [lower, upper] = mapped_region(volume);
    let ranges_mm = axes.map(|axis| [lower[axis], upper[axis]]);
    let size = map_size(ROOM_PX, ranges_mm);
    let column = |n: usize| {
        let left = FIRST_PX + n as f64 * (size[0] + GAP_PX);
        MapColumn { left, size, axes, ranges_mm, is_numbered: n == 0, cells: [CELLS; 2], pixels: [1; 2] }
    };
    let row = |axis: usize| {
        let all = planes.iter().flat_map(|plane| plane.deviations_um.iter().map(|of| of[axis]));
        let [_, most] = ranges.of_values(&format!("resolution {axis}"), all);
        let map = |(n, of): (usize, &Plane)| GridMap {
            values: of.deviations_um.iter().map(|of| of[axis]).collect(),
            scale: ColourScale::without_zero([0.0, most]),
            title: if axis == 0 { plane(2, of.z_mm) } else { String::new() },
            remark: if of.deviations_um.iter().all(|of| of.is_nan()) {
                &["beyond the range", "of the sensor"]
            } else {
                &[]
            },
            bar: (n + 1 == planes.len()).then(|| format!("\u{3c3} along {} (\u{b5}m)", variable(AXIS_NAMES[axis]))),
        };
        planes.iter().enumerate().map(map).collect()
    };
    let columns = (0..planes.len()).map(column).collect();
    MapGrid { heading: None, beside_px: BESIDE_PX, columns, rows: (0..3).map(row).collect(), is_stacked: false }
}
