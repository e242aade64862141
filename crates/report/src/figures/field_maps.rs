//! B_x, B_y, B_z on a plane below the film, of the spliced film, of the ideal film, and their
//! difference (Dai 2024, Fig. 6).

use magsplice::field::IdealFilm;

use crate::colours::ColourScale;
use crate::error::DrawError;
use crate::flux_unit::{FluxUnit, flux_unit};
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::sheet::{DrawResult, LETTERS, Sheet, sheet};
use crate::survey::{FieldSlice, Survey};
use crate::typeset::{AXIS_NAMES, number, symbol, variable};

const ROOM_PX: [f64; 2] = [220.0, 220.0];
const TOP_PX: f64 = 52.0;
const GAP_PX: f64 = 26.0;

/// The figure of the plane `slice` at `z_mm`, as SVG.
pub(crate) fn draw(survey: &Survey, slice: &FieldSlice, z_mm: f64) -> Result<String, DrawError> {
    match &survey.against_ideal {
        Some(against) => with_ideal(against.film, slice, z_mm),
        None => without_ideal(slice, z_mm),
    }
}

/// The unit in which the components of B on the slice have few digits.
fn unit(slice: &FieldSlice) -> FluxUnit {
    let components = slice.all().map(|(u, v)| slice.field_t(u, v)).filter(|b| b.is_finite());
    flux_unit(components.map(|b| b.abs().max_element()).fold(0.0, f64::max))
}

fn heading(sheet: &Sheet, z_mm: f64) -> DrawResult {
    let heading = format!("{} = {} mm", variable("z"), number(z_mm));
    sheet.text([LEFT_PX + 6.0, 14.0], &heading, LETTERS.sized(14.0))
}

/// The three components side by side, each with its own colour scale.
fn without_ideal(slice: &FieldSlice, z_mm: f64) -> Result<String, DrawError> {
    let unit = unit(slice);
    let [width, height] = equal_scale(ROOM_PX, slice.ranges_mm.map(|[low, high]| high - low));
    let step = width + BAR_PX + 34.0;
    let size = [LEFT_PX + 6.0 + 3.0 * step, TOP_PX + height + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        heading(sheet, z_mm)?;
        for (component, axis) in AXIS_NAMES.into_iter().enumerate() {
            let left = LEFT_PX + 6.0 + component as f64 * step;
            let [x, y] = slice.ranges_mm;
            let panel = Panel { left, top: TOP_PX - 18.0, width, height, x, y };
            let b = |u: usize, v: usize| slice.field_t(u, v)[component] * unit.per_t;
            let scale = ColourScale::from_values(slice.all().map(|(u, v)| b(u, v)));
            panel.cells(sheet, slice.cells(), scale, b);
            let beside = if component == 0 { AxisLabel::Coordinate("y") } else { AxisLabel::TicksOnly };
            panel.axes(sheet, AxisLabel::Coordinate("x"), beside)?;
            panel.colour_bar(sheet, 10.0, scale, &format!("{} ({})", symbol("B", axis), unit.name))?;
        }
        Ok(())
    })
}

/// One row per component: spliced film, ideal film, difference.
fn with_ideal(film: &IdealFilm, slice: &FieldSlice, z_mm: f64) -> Result<String, DrawError> {
    let unit = unit(slice);
    let extents = slice.ranges_mm.map(|[low, high]| high - low);
    let [width, height] = equal_scale(ROOM_PX, extents);
    // The spliced and the ideal film share the colour bar at their right; the difference has its
    // own.
    let left = |column: usize| {
        LEFT_PX + 6.0 + column as f64 * (width + GAP_PX) + if column == 2 { BAR_PX + 22.0 } else { 0.0 }
    };
    let top = |row: usize| TOP_PX + row as f64 * (height + 18.0);
    let size = [left(2) + width + 12.0 + BAR_PX, top(2) + height + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        heading(sheet, z_mm)?;
        for (component, axis) in AXIS_NAMES.into_iter().enumerate() {
            let b = |u: usize, v: usize| slice.field_t(u, v)[component] * unit.per_t;
            let of_ideal = |u: usize, v: usize| slice.ideal_t(film, u, v)[component] * unit.per_t;
            let both = slice.all().flat_map(|(u, v)| [b(u, v), of_ideal(u, v)]);
            let scale = ColourScale::from_values(both);
            let difference = |u: usize, v: usize| b(u, v) - of_ideal(u, v);
            let own = ColourScale::symmetric_from_values(slice.all().map(|(u, v)| difference(u, v)));
            let titles = ["spliced film", "ideal film", "spliced \u{2212} ideal"];
            for (column, title) in titles.into_iter().enumerate() {
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
                let x = if component == 2 { AxisLabel::Coordinate("x") } else { AxisLabel::TicksOnly };
                let y = if column == 0 { AxisLabel::Coordinate("y") } else { AxisLabel::TicksOnly };
                panel.axes(sheet, x, y)?;
                if component == 0 {
                    panel.title(sheet, title)?;
                }
                let name = format!("{} ({})", symbol("B", axis), unit.name);
                match column {
                    2 => panel.colour_bar(sheet, 12.0, own, &format!("\u{394}{name}"))?,
                    1 => panel.colour_bar(sheet, 12.0, scale, &name)?,
                    _ => {}
                }
            }
        }
        Ok(())
    })
}
