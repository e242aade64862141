//! R_x, R_y, S_z on planes through the working volume: planes of constant z (Dai 2024, Fig. 7) and
//! vertical planes (Fig. 8).

use magsplice::decouple::Parameters;

use crate::colours::ColourScale;
use crate::error::DrawError;
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::shared_ranges::SharedRanges;
use crate::sheet::sheet;
use crate::survey::{AgainstIdeal, FieldSlice};
use crate::typeset::{AXIS_NAMES, symbol};

use super::field_maps::{ROW_GAP_PX, csv_row, remark_zero};

const GAP_PX: f64 = 26.0;
const TOP_PX: f64 = 30.0;

/// The parameter with this index: R_x, R_y, S_z.
pub(crate) fn value(parameters: &Parameters, which: usize) -> f64 {
    [parameters.r_x, parameters.r_y, parameters.s_z][which]
}

/// Names of the parameters with their units.
pub(crate) fn names() -> [String; 3] {
    [
        format!("{} (rad)", symbol("R", "x")),
        format!("{} (rad)", symbol("R", "y")),
        format!("{} (ln of B/T)", symbol("S", "z")),
    ]
}

/// The parameters on all slices as CSV.
pub(crate) fn csv(against: &AgainstIdeal, slices: &[(FieldSlice, String)]) -> String {
    let mut csv = "x_mm,y_mm,z_mm,r_x_rad,r_y_rad,s_z_ln_t\n".to_owned();
    for (slice, _) in slices {
        for (u, v) in slice.all() {
            let parameters = slice.parameters(against.branch, u, v);
            let values = parameters.map_or([f64::NAN; 3], |p| [p.r_x, p.r_y, p.s_z]);
            csv_row(&mut csv, slice.point_mm(u, v).to_array().into_iter().chain(values));
        }
    }
    csv
}

/// The figure as SVG: one column per slice with its title, one row per parameter with one colour
/// scale. All slices have the same axes or the same height.
pub(crate) fn draw(
    against: &AgainstIdeal,
    slices: &[(FieldSlice, String)],
    room_px: [f64; 2],
    figure: &str,
    ranges: &SharedRanges,
) -> Result<String, DrawError> {
    // All slices have the same scale of length.
    let extents = |slice: &FieldSlice| slice.ranges_mm.map(|[low, high]| high - low);
    let widest = slices.iter().map(|(slice, _)| extents(slice)[0]).fold(0.0, f64::max);
    let sizes: Vec<[f64; 2]> = slices
        .iter()
        .map(|(slice, _)| {
            let [width, height] = equal_scale(room_px, [widest, extents(slice)[1]]);
            [(width * extents(slice)[0] / widest).max(0.2 * width), height]
        })
        .collect();
    let height = sizes.iter().map(|size| size[1]).fold(0.0, f64::max);
    // A slice along other axes than the one at its left has numbers of its own.
    let named: Vec<bool> = (0..slices.len()).map(|i| i == 0 || slices[i].0.axes != slices[i - 1].0.axes).collect();
    let mut lefts = Vec::new();
    let mut right = 6.0 - GAP_PX;
    for (size, named) in sizes.iter().zip(&named) {
        let left = right + GAP_PX + if *named { LEFT_PX } else { 0.0 };
        lefts.push(left);
        right = left + size[0];
    }
    let top = |row: usize| TOP_PX + row as f64 * (height + ROW_GAP_PX);
    sheet([right + 12.0 + BAR_PX, top(2) + height + BELOW_PX + 6.0], |sheet| {
        for (row, name) in names().iter().enumerate() {
            let at = |slice: &FieldSlice, u: usize, v: usize| {
                slice.parameters(against.branch, u, v).map_or(f64::NAN, |p| value(&p, row))
            };
            let values: Vec<f64> =
                slices.iter().flat_map(|(slice, _)| slice.all().map(|(u, v)| at(slice, u, v))).collect();
            let range = ranges.of_values(&format!("{figure} {row}"), values.into_iter());
            let scale = if row == 2 { ColourScale::without_zero(range) } else { ColourScale::signed(range) };
            for (i, (slice, title)) in slices.iter().enumerate() {
                let [width, height] = sizes[i];
                let panel = Panel {
                    left: lefts[i],
                    top: top(row),
                    width,
                    height,
                    x: slice.ranges_mm[0],
                    y: slice.ranges_mm[1],
                };
                panel.cells(sheet, slice.cells(), scale, |u, v| at(slice, u, v));
                panel.title(sheet, row * slices.len() + i, if row == 0 { title } else { "" })?;
                remark_zero(sheet, &panel, slice, |u, v| at(slice, u, v))?;
                let [across, along] = slice.axes.map(|axis| AxisLabel::Coordinate(AXIS_NAMES[axis]));
                let x = if row == 2 { across } else { AxisLabel::TicksOnly };
                let y = if named[i] { along } else { AxisLabel::TicksOnly };
                panel.axes(sheet, x, y)?;
                if i + 1 == slices.len() {
                    panel.colour_bar(sheet, 12.0, scale, name)?;
                }
            }
        }
        Ok(())
    })
}
