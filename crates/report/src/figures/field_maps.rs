//! B_x, B_y, B_z on a plane below the film: spliced, ideal, and their difference (Dai 2024, Fig. 6).

use magsplice::field::IdealFilm;

use crate::colours::Scale;
use crate::panel::{BAR_PX, BELOW_PX, Beside, LEFT_PX, Panel, equal_scale};
use crate::sheet::{Drawn, LETTERS, Sheet, sheet};
use crate::survey::{Slice, Survey};
use crate::typeset::{number, symbol, variable};
use crate::units::{FluxUnit, flux_unit};

use super::AXES;

const ROOM_PX: [f64; 2] = [220.0, 220.0];
const TOP_PX: f64 = 52.0;
const GAP_PX: f64 = 26.0;

/// The plane `slice` at `z_mm`.
pub(crate) fn draw(survey: &Survey, slice: &Slice, z_mm: f64) -> Result<String, String> {
    match &survey.against_ideal {
        Some(against) => beside_ideal(against.film, slice, z_mm),
        None => alone(slice, z_mm),
    }
}

fn unit_of(slice: &Slice) -> FluxUnit {
    let components = slice.all().map(|(u, v)| slice.field_t(u, v)).filter(|b| b.is_finite());
    flux_unit(components.map(|b| b.abs().max_element()).fold(0.0, f64::max))
}

fn heading(sheet: &Sheet, z_mm: f64) -> Drawn {
    let heading = format!("{} = {} mm", variable("z"), number(z_mm));
    sheet.text([LEFT_PX + 6.0, 14.0], &heading, LETTERS.sized(14.0))
}

/// The three components side by side, each with its own scale.
fn alone(slice: &Slice, z_mm: f64) -> Result<String, String> {
    let unit = unit_of(slice);
    let [width, height] = equal_scale(ROOM_PX, slice.ranges_mm.map(|[low, high]| high - low));
    let step = width + BAR_PX + 34.0;
    let size = [LEFT_PX + 6.0 + 3.0 * step, TOP_PX + height + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        heading(sheet, z_mm)?;
        for (component, axis) in AXES.into_iter().enumerate() {
            let left = LEFT_PX + 6.0 + component as f64 * step;
            let [x, y] = slice.ranges_mm;
            let panel = Panel { left, top: TOP_PX - 18.0, width, height, x, y };
            let b = |u: usize, v: usize| slice.field_t(u, v)[component] * unit.per_t;
            let scale = Scale::of(slice.all().map(|(u, v)| b(u, v)));
            panel.cells(sheet, slice.cells(), scale, b);
            let beside = if component == 0 { Beside::Length("y") } else { Beside::Ticks };
            panel.axes(sheet, Beside::Length("x"), beside)?;
            panel.colour_bar(sheet, 10.0, scale, &format!("{} ({})", symbol("B", axis), unit.name))?;
        }
        Ok(())
    })
}

fn beside_ideal(film: &IdealFilm, slice: &Slice, z_mm: f64) -> Result<String, String> {
    let unit = unit_of(slice);
    let extents = slice.ranges_mm.map(|[low, high]| high - low);
    let [width, height] = equal_scale(ROOM_PX, extents);
    // Spliced and ideal share a bar at the right of the two; the difference has its own.
    let left = |column: usize| {
        LEFT_PX + 6.0 + column as f64 * (width + GAP_PX) + if column == 2 { BAR_PX + 22.0 } else { 0.0 }
    };
    let top = |row: usize| TOP_PX + row as f64 * (height + 18.0);
    let size = [left(2) + width + 12.0 + BAR_PX, top(2) + height + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        heading(sheet, z_mm)?;
        for (component, axis) in AXES.into_iter().enumerate() {
            let b = |u: usize, v: usize| slice.field_t(u, v)[component] * unit.per_t;
            let of_ideal = |u: usize, v: usize| slice.ideal_t(film, u, v)[component] * unit.per_t;
            let both = slice.all().flat_map(|(u, v)| [b(u, v), of_ideal(u, v)]);
            let scale = Scale::of(both);
            let difference = |u: usize, v: usize| b(u, v) - of_ideal(u, v);
            let own = Scale::symmetric_of(slice.all().map(|(u, v)| difference(u, v)));
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
                let x = if component == 2 { Beside::Length("x") } else { Beside::Ticks };
                let y = if column == 0 { Beside::Length("y") } else { Beside::Ticks };
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
