//! B_x, B_y, B_z on a plane below the film, of the spliced film, of the ideal film, and their
//! difference at best-fit amplitude (Dai 2024, Fig. 6).

use glam::DVec3;

use crate::colours::ColourScale;
use crate::csv::csv;
use crate::drawing::FigureDraft;
use crate::error::ReportError;
use crate::flux_unit::{flux_unit, largest_component_t};
use crate::panel::BAR_PX;
use crate::shared_ranges::SharedRanges;
use crate::survey::{FieldSlice, Survey};
use crate::typeset::{AXIS_NAMES, number, plane, symbol, thousandths};

use super::map_grid::{ComparedRow, FIRST_PX, GridMap, MapColumn, MapGrid, ROOM_PX, map_size, zero_remark};

/// Distance of a colour bar from its map and from the next map, in pixels.
const BESIDE_PX: [f64; 2] = [10.0, 34.0];

/// The figure of a plane of constant z.
pub(crate) fn draft(
    survey: &Survey,
    slice: &FieldSlice,
    name: &'static str,
    ranges: &SharedRanges,
) -> Result<FigureDraft, ReportError> {
    let what = if survey.against_ideal.is_some() {
        "the spliced film, B of the ideal film (Eq. 2) on the same colour scale, and the spliced film minus the ideal \
         film times the best-fit amplitude"
    } else {
        "the film"
    };
    let caption = format!("B of {what}, at z = {} mm.", number(slice.at_mm));
    let ideal_t = survey.against_ideal.as_ref().map(|against| slice.ideal_t(against.film));
    let maps = maps(survey, slice, ideal_t.as_deref(), name, ranges);
    FigureDraft::of_maps(name, caption, maps, table(slice, ideal_t.as_deref()))
}

/// One row per component: spliced film, ideal film, and the difference at best-fit amplitude. The
/// amplitude changes no displacement, and its difference would hide all others. Without an ideal
/// film the three components are side by side, each with its own colour scale.
fn maps(survey: &Survey, slice: &FieldSlice, ideal_t: Option<&[DVec3]>, name: &str, ranges: &SharedRanges) -> MapGrid {
    let unit_of = |key: &str, fields_t: &[DVec3]| {
        let most_t = largest_component_t(fields_t.iter().copied());
        flux_unit(ranges.widened(&format!("{name} {key}"), [0.0, most_t])[1])
    };
    let scale = |key: &str, values: &mut dyn Iterator<Item = &f64>| {
        ColourScale::signed(ranges.of_values(&format!("{name} {key}"), values.copied()))
    };
    let component =
        |fields_t: &[DVec3], axis: usize, per_t: f64| fields_t.iter().map(|b| b[axis] * per_t).collect::<Vec<f64>>();
    let unit = unit_of("unit", &slice.field_t);
    let heading = plane(slice.normal, slice.at_mm);
    let size = map_size(ROOM_PX, slice.ranges_mm);
    let (Some(against), Some(ideal_t)) = (&survey.against_ideal, ideal_t) else {
        let map = |axis: usize| {
            let values = component(&slice.field_t, axis, unit.per_t);
            GridMap {
                scale: scale(AXIS_NAMES[axis], &mut values.iter()),
                remark: zero_remark(&values),
                values,
                title: String::new(),
                bar: Some(format!("{} ({})", symbol("B", AXIS_NAMES[axis]), unit.name)),
            }
        };
        let step = size[0] + BAR_PX + BESIDE_PX[1];
        let column = |n: usize| MapColumn::of_slice(slice, FIRST_PX + n as f64 * step, size, n == 0);
        let (columns, rows) = ((0..3).map(column).collect(), vec![(0..3).map(map).collect()]);
        return MapGrid { heading: Some(heading), beside_px: BESIDE_PX, columns, rows, is_stacked: false };
    };
    let difference_t = slice.difference_t(ideal_t, against.amplitude);
    let fine = unit_of("difference unit", &difference_t);
    let row = |axis: usize| {
        let [film, ideal] = [&slice.field_t[..], ideal_t].map(|fields_t| component(fields_t, axis, unit.per_t));
        let difference = component(&difference_t, axis, fine.per_t);
        let key = AXIS_NAMES[axis];
        let of_difference = scale(&format!("difference {key}"), &mut difference.iter());
        ComparedRow {
            name: symbol("B", key),
            units: [unit.name, fine.name],
            scales: [scale(key, &mut film.iter().chain(&ideal)), of_difference],
            values: [film, ideal, difference],
        }
    };
    let scaled = format!("spliced \u{2212} {} \u{d7} ideal", thousandths(against.amplitude));
    let titles = ["spliced film", "ideal film", &scaled];
    let column = MapColumn::of_slice(slice, FIRST_PX, size, true);
    MapGrid::compared(heading, titles, &column, [0, 1, 2].map(row), zero_remark)
}

/// B on the slice as CSV, with B of the ideal film if there is one.
fn table(slice: &FieldSlice, ideal_t: Option<&[DVec3]>) -> String {
    let mut header = "x_mm,y_mm,z_mm,b_x_t,b_y_t,b_z_t".to_owned();
    if ideal_t.is_some() {
        header += ",ideal_b_x_t,ideal_b_y_t,ideal_b_z_t";
    }
    let row = |(cell, point): (usize, DVec3)| {
        let vectors = [Some(point), Some(slice.field_t[cell]), ideal_t.map(|ideal_t| ideal_t[cell])];
        (String::new(), vectors.into_iter().flatten().flat_map(|vector| vector.to_array()))
    };
    csv(&header, slice.grid.points().enumerate().map(row))
}
