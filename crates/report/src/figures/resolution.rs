//! The standard deviations of displacements that the noise of the sensor causes, on planes of
//! constant z.

use glam::DVec3;
use magsplice::Film;
use magsplice::layout::WorkingVolume;
use magsplice::prelude::Grid;
use magsplice::sensor::Noise;

use crate::colours::ColourScale;
use crate::error::{DrawError, ReportError};
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::shared_ranges::SharedRanges;
use crate::sheet::sheet;
use crate::typeset::{AXIS_NAMES, number, variable};

use super::field_maps::{ROW_GAP_PX, csv_row};

const ROOM_PX: [f64; 2] = [220.0, 220.0];
const TOP_PX: f64 = 30.0;
const GAP_PX: f64 = 26.0;
const UM_PER_MM: f64 = 1e3;
/// Number of cells along a side of a map. A deviation takes a gradient for each node of the active
/// area.
const CELLS: usize = 48;

/// Deviations on one plane of constant z.
struct Plane {
    grid: Grid,
    z_mm: f64,
    /// In um along x, y, z; NaN where the reading is out of range.
    deviations_um: Vec<DVec3>,
}

/// Deviations on planes through the working volume.
pub(crate) struct ResolutionMaps {
    planes: Vec<Plane>,
    ranges_mm: [[f64; 2]; 2],
}

impl ResolutionMaps {
    /// The maps of the planes at these heights. `None` if the layout states no noise of its sensor.
    pub(crate) fn new(
        film: &Film,
        volume: &WorkingVolume,
        heights_mm: &[f64],
    ) -> Result<Option<ResolutionMaps>, ReportError> {
        let sensed = film.sensed_field(&volume.grid)?;
        let sensor = *sensed.sensor();
        let Some(noise) = Noise::of_sensor(&sensor) else { return Ok(None) };
        let (lower, upper) = (volume.lower_mm, volume.upper_mm);
        let mut planes = Vec::new();
        for &z_mm in heights_mm {
            let half_cell = 0.5 * (upper - lower) / CELLS as f64;
            let corner = |corner: DVec3, inwards: DVec3| DVec3::new(corner.x + inwards.x, corner.y + inwards.y, z_mm);
            let grid = Grid::new(corner(lower, half_cell), corner(upper, -half_cell), [CELLS, CELLS, 1])
                .expect("a slice of a valid volume is a valid grid");
            let points: Vec<DVec3> = grid.points().collect();
            let (readings_t, gradients) = sensed.readings_and_gradients(&points);
            let of_point = |(reading, gradient)| {
                let seen = noise.of_position(gradient).filter(|_| !sensor.is_saturated(sensor.digitized_t(reading)));
                seen.map_or(DVec3::NAN, |deviation| UM_PER_MM * deviation)
            };
            let deviations_um = readings_t.into_iter().zip(gradients).map(of_point).collect();
            planes.push(Plane { grid, z_mm, deviations_um });
        }
        Ok(Some(ResolutionMaps { planes, ranges_mm: [[lower.x, upper.x], [lower.y, upper.y]] }))
    }

    /// The figure as SVG: one column per plane, one row per axis.
    pub(crate) fn draw(&self, ranges: &SharedRanges) -> Result<String, DrawError> {
        let [width, height] = equal_scale(ROOM_PX, self.ranges_mm.map(|[low, high]| high - low));
        let left = |column: usize| LEFT_PX + 6.0 + column as f64 * (width + GAP_PX);
        let top = |row: usize| TOP_PX + row as f64 * (height + ROW_GAP_PX);
        let count = self.planes.len();
        sheet([left(count - 1) + width + 12.0 + BAR_PX, top(2) + height + BELOW_PX + 6.0], |sheet| {
            for axis in 0..3 {
                let all = self.planes.iter().flat_map(|plane| plane.deviations_um.iter().map(|of| of[axis]));
                let [_, most] = ranges.of_values(&format!("resolution {axis}"), all);
                let scale = ColourScale::without_zero([0.0, most]);
                for (column, plane) in self.planes.iter().enumerate() {
                    let [x, y] = self.ranges_mm;
                    let panel = Panel { left: left(column), top: top(axis), width, height, x, y };
                    panel.cells(sheet, [CELLS; 2], scale, |u, v| plane.deviations_um[u * CELLS + v][axis]);
                    let title = format!("{} = {} mm", variable("z"), number(plane.z_mm));
                    panel.title(sheet, axis * count + column, if axis == 0 { &title } else { "" })?;
                    if plane.deviations_um.iter().all(|of| of.is_nan()) {
                        panel.remark(sheet, &["beyond the range", "of the sensor"])?;
                    }
                    let across = if axis == 2 { AxisLabel::Coordinate("x") } else { AxisLabel::TicksOnly };
                    let along = if column == 0 { AxisLabel::Coordinate("y") } else { AxisLabel::TicksOnly };
                    panel.axes(sheet, across, along)?;
                    if column + 1 == count {
                        let name = format!("\u{3c3} along {} (\u{b5}m)", variable(AXIS_NAMES[axis]));
                        panel.colour_bar(sheet, 12.0, scale, &name)?;
                    }
                }
            }
            Ok(())
        })
    }

    /// The deviations as CSV.
    pub(crate) fn csv(&self) -> String {
        let mut csv = "x_mm,y_mm,z_mm,deviation_x_um,deviation_y_um,deviation_z_um\n".to_owned();
        for plane in &self.planes {
            for (point, deviation) in plane.grid.points().zip(&plane.deviations_um) {
                csv_row(&mut csv, point.to_array().into_iter().chain(deviation.to_array()));
            }
        }
        csv
    }
}
