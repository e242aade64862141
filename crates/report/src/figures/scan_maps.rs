//! A measured plane of a scan beside the field of the layout: B (Dai 2024, Fig. 6), and the
//! decoupling parameters (Figs. 7 and 8).

use glam::DVec3;

use crate::colours::ColourScale;
use crate::drawing::{Drawing, SvgText};
use crate::error::{DrawError, ReportError};
use crate::flux_unit::flux_unit;
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::sheet::{LETTERS, sheet};
use crate::typeset::{self, AXIS_NAMES, number, symbol, variable};

use super::field_maps::{ROW_GAP_PX, csv_row};

const ROOM_PX: [f64; 2] = [220.0, 220.0];
const TOP_PX: f64 = 52.0;
const GAP_PX: f64 = 26.0;
const PER_MILLI: f64 = 1e3;
/// Pixels along a side of a map at least: as many as print resolves.
const SHARP_PX: usize = 400;

/// Readings on a plane of a scan, and the field of the layout at the same points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScanPlane {
    /// The two axes that span the plane: 0, 1, 2 for x, y, z.
    pub(crate) axes: [usize; 2],
    /// Coordinate of the plane along the third axis, in millimetres.
    pub(crate) at_mm: f64,
    /// Coordinates of the points along both axes, in millimetres, ascending in equal steps.
    pub(crate) coordinates_mm: [Vec<f64>; 2],
    /// Readings in tesla without the errors of the sensor, second axis fastest; NaN where there is
    /// none.
    pub(crate) measured_t: Vec<DVec3>,
    /// The field of the layout at the same points.
    pub(crate) simulated_t: Vec<DVec3>,
    /// R_x, R_y, S_z of both; NaN where there are none. `None` without an ideal film.
    pub(crate) parameters: Option<[Vec<DVec3>; 2]>,
}

/// A row of maps of one component.
struct Row {
    name: String,
    unit: String,
    /// Values in this unit, measured and simulated.
    values: [Vec<f64>; 2],
    difference_unit: String,
    difference: Vec<f64>,
}

/// The figure of B on a plane, named `name` in files.
pub(crate) fn scan_field_figure(plane: &ScanPlane, name: &'static str, text: SvgText) -> Result<Drawing, ReportError> {
    let both = || plane.measured_t.iter().chain(&plane.simulated_t).filter(|b| b.is_finite());
    let unit = flux_unit(both().map(|b| b.abs().max_element()).fold(0.0, f64::max));
    let differences_t: Vec<DVec3> = plane.measured_t.iter().zip(&plane.simulated_t).map(|(m, s)| *m - *s).collect();
    let most_t = differences_t.iter().filter(|d| d.is_finite()).map(|d| d.abs().max_element()).fold(0.0, f64::max);
    let fine = flux_unit(most_t);
    let row = |axis: usize| Row {
        name: symbol("B", AXIS_NAMES[axis]),
        unit: unit.name.to_owned(),
        values: [&plane.measured_t, &plane.simulated_t].map(|of| of.iter().map(|b| b[axis] * unit.per_t).collect()),
        difference_unit: fine.name.to_owned(),
        difference: differences_t.iter().map(|b| b[axis] * fine.per_t).collect(),
    };
    let header = "b_x_t,b_y_t,b_z_t,simulated_b_x_t,simulated_b_y_t,simulated_b_z_t";
    let csv = csv(plane, header, [&plane.measured_t, &plane.simulated_t]);
    figure(plane, &[row(0), row(1), row(2)], "B", csv, name, text)
}

/// The figure of R_x, R_y, S_z on a plane, named `name` in files. `None` without parameters.
pub(crate) fn scan_parameters_figure(
    plane: &ScanPlane,
    name: &'static str,
    text: SvgText,
) -> Result<Option<Drawing>, ReportError> {
    let Some([measured, simulated]) = &plane.parameters else { return Ok(None) };
    let row = |which: usize| {
        let (letter, unit, fine) = [("R", "rad", "mrad"), ("R", "rad", "mrad"), ("S", "ln of B/T", "1/1000")][which];
        Row {
            name: symbol(letter, AXIS_NAMES[which]),
            unit: unit.to_owned(),
            values: [measured, simulated].map(|of| of.iter().map(|p| p[which]).collect()),
            difference_unit: fine.to_owned(),
            difference: measured.iter().zip(simulated).map(|(m, s)| PER_MILLI * (m[which] - s[which])).collect(),
        }
    };
    let header = "r_x_rad,r_y_rad,s_z_ln_t,simulated_r_x_rad,simulated_r_y_rad,simulated_s_z_ln_t";
    let csv = csv(plane, header, [measured, simulated]);
    figure(plane, &[row(0), row(1), row(2)], "The decoupling parameters", csv, name, text).map(Some)
}

fn figure(
    plane: &ScanPlane,
    rows: &[Row; 3],
    what: &str,
    csv: String,
    name: &'static str,
    text: SvgText,
) -> Result<Drawing, ReportError> {
    let normal = 3 - plane.axes[0] - plane.axes[1];
    let caption = format!(
        "{what} at {} = {} mm: the readings without the errors of the sensor, the field of the layout at the same \
         points, and the difference.",
        AXIS_NAMES[normal],
        number((1e3 * plane.at_mm).round() / 1e3)
    );
    let drawn = draw(plane, rows).and_then(|svg| Drawing::new(name, caption, &svg, csv, text, &typeset::options()));
    drawn.map_err(|source| ReportError::Drawing { figure: name, source })
}

fn csv(plane: &ScanPlane, header: &str, values: [&[DVec3]; 2]) -> String {
    let names = plane.axes.map(|axis| AXIS_NAMES[axis]);
    let mut csv = format!("{}_mm,{}_mm,{header}\n", names[0], names[1]);
    let [across, along] = &plane.coordinates_mm;
    for (index, (measured, simulated)) in values[0].iter().zip(values[1]).enumerate() {
        let place = [across[index / along.len()], along[index % along.len()]];
        csv_row(&mut csv, place.into_iter().chain(measured.to_array()).chain(simulated.to_array()));
    }
    csv
}

/// Lower and upper side of a map whose cells have the points at their centres.
fn sides(coordinates: &[f64]) -> [f64; 2] {
    let (first, last) = (coordinates[0], coordinates[coordinates.len() - 1]);
    let half_cell = if coordinates.len() > 1 { 0.5 * (last - first) / (coordinates.len() - 1) as f64 } else { 0.5 };
    [first - half_cell, last + half_cell]
}

fn draw(plane: &ScanPlane, rows: &[Row; 3]) -> Result<String, DrawError> {
    let [x, y] = plane.coordinates_mm.each_ref().map(|coordinates| sides(coordinates));
    let [width, height] = equal_scale(ROOM_PX, [x[1] - x[0], y[1] - y[0]]);
    let left = |column: usize| {
        LEFT_PX + 6.0 + column as f64 * (width + GAP_PX) + if column == 2 { BAR_PX + 22.0 } else { 0.0 }
    };
    let top = |row: usize| TOP_PX + row as f64 * (height + ROW_GAP_PX);
    let size = [left(2) + width + 12.0 + BAR_PX, top(2) + height + BELOW_PX + 6.0];
    let normal = 3 - plane.axes[0] - plane.axes[1];
    let counts = plane.coordinates_mm.each_ref().map(Vec::len);
    // Viewers smooth between the pixels of an image, and a reading is not known beside its cell.
    let sharp = counts.map(|count| SHARP_PX.div_ceil(count));
    sheet(size, |sheet| {
        let heading = format!("{} = {} mm", variable(AXIS_NAMES[normal]), number((1e3 * plane.at_mm).round() / 1e3));
        sheet.text([LEFT_PX + 6.0, 14.0], &heading, LETTERS.sized(14.0))?;
        for (n, row) in rows.iter().enumerate() {
            let range = range(row.values.iter().flatten());
            // Logarithms have no zero.
            let is_logarithm = range[1] < 0.0 && range[0] < -2.0 * (range[1] - range[0]);
            let scale = if is_logarithm { ColourScale::without_zero(range) } else { ColourScale::signed(range) };
            let own = ColourScale::signed(self::range(row.difference.iter()));
            for (column, title) in ["measured", "simulated", "measured \u{2212} simulated"].into_iter().enumerate() {
                let panel = Panel { left: left(column), top: top(n), width, height, x, y };
                let values = if column == 2 { &row.difference } else { &row.values[column] };
                let scale = if column == 2 { own } else { scale };
                let pixels = [0, 1].map(|axis| counts[axis] * sharp[axis]);
                panel.cells(sheet, pixels, scale, |u, v| values[u / sharp[0] * counts[1] + v / sharp[1]]);
                panel.title(sheet, 3 * n + column, if n == 0 { title } else { "" })?;
                let [across, along] = plane.axes.map(|axis| AxisLabel::Coordinate(AXIS_NAMES[axis]));
                let across = if n == 2 { across } else { AxisLabel::TicksOnly };
                let along = if column == 0 { along } else { AxisLabel::TicksOnly };
                panel.axes(sheet, across, along)?;
                match column {
                    2 => {
                        let name = format!("\u{394}{} ({})", row.name, row.difference_unit);
                        panel.colour_bar(sheet, 12.0, own, &name)?;
                    }
                    1 => panel.colour_bar(sheet, 12.0, scale, &format!("{} ({})", row.name, row.unit))?,
                    _ => {}
                }
            }
        }
        Ok(())
    })
}

fn range<'a>(values: impl Iterator<Item = &'a f64>) -> [f64; 2] {
    values
        .filter(|v| v.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)])
}
