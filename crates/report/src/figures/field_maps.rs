//! B_x, B_y, B_z on a plane below the film, of the spliced film, of the ideal film, and their
//! difference at best-fit amplitude (Dai 2024, Fig. 6).

use std::fmt::Write;

use crate::colours::ColourScale;
use crate::error::DrawError;
use crate::flux_unit::{FluxUnit, flux_unit};
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{DrawResult, LETTERS, Sheet, sheet};
use crate::survey::{AgainstIdeal, FieldSlice, Survey};
use crate::typeset::{AXIS_NAMES, number, symbol, variable};

const ROOM_PX: [f64; 2] = [220.0, 220.0];
const TOP_PX: f64 = 52.0;
const GAP_PX: f64 = 26.0;
/// Distance of rows, with the letters of the panels, in pixels.
pub(super) const ROW_GAP_PX: f64 = 26.0;

/// The figure of the plane `slice` at `z_mm`, as SVG.
pub(crate) fn draw(
    survey: &Survey,
    slice: &FieldSlice,
    z_mm: f64,
    name: &str,
    ranges: &SharedRanges,
) -> Result<String, DrawError> {
    match &survey.against_ideal {
        Some(against) => with_ideal(against, slice, z_mm, name, ranges),
        None => without_ideal(slice, z_mm, name, ranges),
    }
}

/// The unit in which the components of B on the slice have few digits.
fn unit(slice: &FieldSlice, name: &str, ranges: &SharedRanges) -> FluxUnit {
    let components = slice.all().map(|(u, v)| slice.field_t(u, v)).filter(|b| b.is_finite());
    let most_t = components.map(|b| b.abs().max_element()).fold(0.0, f64::max);
    flux_unit(ranges.widened(&format!("{name} unit"), [0.0, most_t])[1])
}

fn heading(sheet: &Sheet, z_mm: f64) -> DrawResult {
    let heading = format!("{} = {} mm", variable("z"), number(z_mm));
    sheet.text([LEFT_PX + 6.0, 14.0], &heading, LETTERS.sized(14.0))
}

/// Says so if the values are 0 in every cell: round-off is drawn as 0.
pub(super) fn remark_zero(
    sheet: &Sheet,
    panel: &Panel,
    slice: &FieldSlice,
    value: impl Fn(usize, usize) -> f64,
) -> DrawResult {
    if slice.all().all(|(u, v)| value(u, v) == 0.0) {
        panel.remark(sheet, &["0 everywhere,", "but for round-off"])?;
    }
    Ok(())
}

/// B on the slice as CSV, with B of the ideal film if there is one.
pub(crate) fn csv(survey: &Survey, slice: &FieldSlice) -> String {
    let film = survey.against_ideal.as_ref().map(|against| against.film);
    let mut csv = "x_mm,y_mm,z_mm,b_x_t,b_y_t,b_z_t".to_owned();
    csv += if film.is_some() { ",ideal_b_x_t,ideal_b_y_t,ideal_b_z_t\n" } else { "\n" };
    for (u, v) in slice.all() {
        let ideal = film.map(|film| slice.ideal_t(film, u, v));
        let numbers = [Some(slice.point_mm(u, v)), Some(slice.field_t(u, v)), ideal].into_iter().flatten();
        csv_row(&mut csv, numbers.flat_map(|vector| vector.to_array()));
    }
    csv
}

/// Appends a row of numbers with nine digits, more than a figure shows. Where there is no value the
/// field is empty.
pub(crate) fn csv_row(csv: &mut String, numbers: impl Iterator<Item = f64>) {
    for (column, number) in numbers.enumerate() {
        if column > 0 {
            csv.push(',');
        }
        if number == 0.0 {
            csv.push('0');
        } else if number.is_finite() {
            // The shortest text of the rounded number.
            let rounded: f64 = format!("{number:.8e}").parse().unwrap_or(number);
            let plain = (1e-3..1e6).contains(&rounded.abs());
            let _ = if plain { write!(csv, "{rounded}") } else { write!(csv, "{rounded:e}") };
        }
    }
    csv.push('\n');
}

/// The three components side by side, each with its own colour scale.
fn without_ideal(slice: &FieldSlice, z_mm: f64, name: &str, ranges: &SharedRanges) -> Result<String, DrawError> {
    let unit = unit(slice, name, ranges);
    let [width, height] = equal_scale(ROOM_PX, slice.ranges_mm.map(|[low, high]| high - low));
    let step = width + BAR_PX + 34.0;
    let size = [LEFT_PX + 6.0 + 3.0 * step, TOP_PX + height + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        heading(sheet, z_mm)?;
        for (component, axis) in AXIS_NAMES.into_iter().enumerate() {
            let left = LEFT_PX + 6.0 + component as f64 * step;
            let [x, y] = slice.ranges_mm;
            let panel = Panel { left, top: TOP_PX, width, height, x, y };
            let b = |u: usize, v: usize| slice.field_t(u, v)[component] * unit.per_t;
            let scale =
                ColourScale::signed(ranges.of_values(&format!("{name} {axis}"), slice.all().map(|(u, v)| b(u, v))));
            panel.cells(sheet, slice.cells(), scale, b);
            panel.title(sheet, component, "")?;
            remark_zero(sheet, &panel, slice, b)?;
            let beside = if component == 0 { AxisLabel::Coordinate("y") } else { AxisLabel::TicksOnly };
            panel.axes(sheet, AxisLabel::Coordinate("x"), beside)?;
            panel.colour_bar(sheet, 10.0, scale, &format!("{} ({})", symbol("B", axis), unit.name))?;
        }
        Ok(())
    })
}

/// One row per component: spliced film, ideal film, and the difference at best-fit amplitude. The
/// amplitude changes no displacement, and its difference would hide all others.
fn with_ideal(
    against: &AgainstIdeal,
    slice: &FieldSlice,
    z_mm: f64,
    name: &str,
    ranges: &SharedRanges,
) -> Result<String, DrawError> {
    let (film, amplitude) = (against.film, against.amplitude);
    let unit = unit(slice, name, ranges);
    let differences = slice.all().map(|(u, v)| slice.difference_t(film, amplitude, u, v)).filter(|b| b.is_finite());
    let most_t = differences.map(|b| b.abs().max_element()).fold(0.0, f64::max);
    let fine = flux_unit(ranges.widened(&format!("{name} difference unit"), [0.0, most_t])[1]);
    let extents = slice.ranges_mm.map(|[low, high]| high - low);
    let [width, height] = equal_scale(ROOM_PX, extents);
    // The spliced and the ideal film share the colour bar at their right; the difference has its
    // own.
    let left = |column: usize| {
        LEFT_PX + 6.0 + column as f64 * (width + GAP_PX) + if column == 2 { BAR_PX + 22.0 } else { 0.0 }
    };
    let top = |row: usize| TOP_PX + row as f64 * (height + ROW_GAP_PX);
    let size = [left(2) + width + 12.0 + BAR_PX, top(2) + height + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        heading(sheet, z_mm)?;
        for (component, axis) in AXIS_NAMES.into_iter().enumerate() {
            let b = |u: usize, v: usize| slice.field_t(u, v)[component] * unit.per_t;
            let of_ideal = |u: usize, v: usize| slice.ideal_t(film, u, v)[component] * unit.per_t;
            let both = slice.all().flat_map(|(u, v)| [b(u, v), of_ideal(u, v)]);
            let scale = ColourScale::signed(ranges.of_values(&format!("{name} {axis}"), both));
            let difference = |u: usize, v: usize| slice.difference_t(film, amplitude, u, v)[component] * fine.per_t;
            let own = slice.all().map(|(u, v)| difference(u, v));
            let own = ColourScale::signed(ranges.of_values(&format!("{name} difference {axis}"), own));
            let scaled = format!("spliced \u{2212} {} \u{d7} ideal", number((1e3 * amplitude).round() / 1e3));
            for (column, title) in ["spliced film", "ideal film", &scaled].into_iter().enumerate() {
                let panel = Panel {
                    left: left(column),
                    top: top(component),
                    width,
                    height,
                    x: slice.ranges_mm[0],
                    y: slice.ranges_mm[1],
                };
                match column {
                    0 => panel.cells(sheet, slice.cells(), scale, b),
                    1 => panel.cells(sheet, slice.cells(), scale, of_ideal),
                    _ => panel.cells(sheet, slice.cells(), own, difference),
                }
                panel.title(sheet, 3 * component + column, if component == 0 { title } else { "" })?;
                match column {
                    0 => remark_zero(sheet, &panel, slice, b)?,
                    1 => remark_zero(sheet, &panel, slice, of_ideal)?,
                    _ => remark_zero(sheet, &panel, slice, difference)?,
                }
                let x = if component == 2 { AxisLabel::Coordinate("x") } else { AxisLabel::TicksOnly };
                let y = if column == 0 { AxisLabel::Coordinate("y") } else { AxisLabel::TicksOnly };
                panel.axes(sheet, x, y)?;
                let component = symbol("B", axis);
                match column {
                    2 => panel.colour_bar(sheet, 12.0, own, &format!("\u{394}{component} ({})", fine.name))?,
                    1 => panel.colour_bar(sheet, 12.0, scale, &format!("{component} ({})", unit.name))?,
                    _ => {}
                }
            }
        }
        Ok(())
    })
}
