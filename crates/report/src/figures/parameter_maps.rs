//! R_x, R_y, S_z on planes through the working volume: planes of constant z (Dai 2024, Fig. 7) and
//! vertical planes (Fig. 8).
//!
//! On a plane of constant z S_z should be constant, and its map would be one colour. There the
//! figure shows the residual: S_z minus its mean over the plane, as a displacement along z.

use magsplice::decouple::Parameters;

use crate::colours::ColourScale;
use crate::error::DrawError;
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::shared_ranges::SharedRanges;
use crate::sheet::sheet;
use crate::survey::{AgainstIdeal, FieldSlice};
use crate::typeset::{AXIS_NAMES, number, symbol, variable};

use super::field_maps::{ROW_GAP_PX, csv_row, remark_zero};

const GAP_PX: f64 = 26.0;
const TOP_PX: f64 = 30.0;
const UM_PER_MM: f64 = 1e3;

/// The parameter with this index: R_x, R_y, S_z.
pub(crate) fn value(parameters: &Parameters, which: usize) -> f64 {
    [parameters.r_x, parameters.r_y, parameters.s_z][which]
}

/// How a figure shows S_z.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum NormalMap {
    /// S_z.
    Whole,
    /// S_z minus its mean over the plane, divided by k, in um.
    Residual,
}

/// Names of the parameters with their units.
pub(crate) fn names() -> [String; 3] {
    [
        format!("{} (rad)", symbol("R", "x")),
        format!("{} (rad)", symbol("R", "y")),
        format!("{} (ln of B/T)", symbol("S", "z")),
    ]
}

/// The name of the residual of S_z with its unit.
fn residual_name() -> String {
    format!("({} \u{2212} mean) / {} (\u{b5}m)", symbol("S", "z"), variable("k"))
}

/// S_z minus its mean over a plane of constant z, divided by k, in um: the displacement along z
/// that the film shows where there is none. In the order of the cells; NaN where there is no value.
struct NormalResidual {
    mean: f64,
    um: Vec<f64>,
}

impl NormalResidual {
    fn new(against: &AgainstIdeal, slice: &FieldSlice) -> NormalResidual {
        let s_z: Vec<f64> =
            slice.all().map(|(u, v)| slice.parameters(against.branch, u, v).map_or(f64::NAN, |p| p.s_z)).collect();
        let (sum, count) = s_z.iter().filter(|s| s.is_finite()).fold((0.0, 0), |(sum, n), s| (sum + s, n + 1));
        let mean = sum / f64::from(count);
        let um_per_unit = UM_PER_MM / against.film.wavenumber();
        let of_cell = |((u, v), s): ((usize, usize), f64)| {
            let residual = s - mean;
            um_per_unit * if residual.abs() <= slice.log_round_off(u, v) { 0.0 } else { residual }
        };
        NormalResidual { mean, um: slice.all().zip(s_z).map(of_cell).collect() }
    }
}

/// The parameters on all slices as CSV, with the residuals of S_z if the figure shows them.
pub(crate) fn csv(against: &AgainstIdeal, slices: &[(FieldSlice, String)], normal: NormalMap) -> String {
    let mut csv = "x_mm,y_mm,z_mm,r_x_rad,r_y_rad,s_z_ln_t".to_owned();
    csv += if normal == NormalMap::Residual { ",s_z_residual_um\n" } else { "\n" };
    for (slice, _) in slices {
        let residual = (normal == NormalMap::Residual).then(|| NormalResidual::new(against, slice));
        for (cell, (u, v)) in slice.all().enumerate() {
            let parameters = slice.parameters(against.branch, u, v);
            let values = parameters.map_or([f64::NAN; 3], |p| [p.r_x, p.r_y, p.s_z]);
            let residual = residual.as_ref().map(|residual| residual.um[cell]);
            csv_row(&mut csv, slice.point_mm(u, v).to_array().into_iter().chain(values).chain(residual));
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
    normal: NormalMap,
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
        for row in 0..3 {
            let residuals: Option<Vec<NormalResidual>> = (row == 2 && normal == NormalMap::Residual)
                .then(|| slices.iter().map(|(slice, _)| NormalResidual::new(against, slice)).collect());
            let maps: Vec<Vec<f64>> = match &residuals {
                Some(residuals) => residuals.iter().map(|residual| residual.um.clone()).collect(),
                None => slices.iter().map(|(slice, _)| cell_values(against, slice, row)).collect(),
            };
            let range = ranges.of_values(&format!("{figure} {row}"), maps.iter().flatten().copied());
            let scale = if row == 2 && residuals.is_none() {
                ColourScale::without_zero(range)
            } else {
                ColourScale::signed(range)
            };
            let name = if residuals.is_some() { residual_name() } else { names()[row].clone() };
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
                let rows = slice.cells()[1];
                let value = |u: usize, v: usize| maps[i][u * rows + v];
                panel.cells(sheet, slice.cells(), scale, value);
                let title = match &residuals {
                    Some(residuals) if residuals[i].mean.is_finite() => {
                        format!("mean {}", number((1e3 * residuals[i].mean).round() / 1e3))
                    }
                    _ if row == 0 => title.clone(),
                    _ => String::new(),
                };
                panel.title(sheet, row * slices.len() + i, &title)?;
                remark_zero(sheet, &panel, slice, value)?;
                let [across, along] = slice.axes.map(|axis| AxisLabel::Coordinate(AXIS_NAMES[axis]));
                let x = if row == 2 { across } else { AxisLabel::TicksOnly };
                let y = if named[i] { along } else { AxisLabel::TicksOnly };
                panel.axes(sheet, x, y)?;
                if i + 1 == slices.len() {
                    panel.colour_bar(sheet, 12.0, scale, &name)?;
                }
            }
        }
        Ok(())
    })
}

/// A parameter in all cells of a slice; NaN where it does not exist.
fn cell_values(against: &AgainstIdeal, slice: &FieldSlice, which: usize) -> Vec<f64> {
    let at = |(u, v)| slice.parameters(against.branch, u, v).map_or(f64::NAN, |p| value(&p, which));
    slice.all().map(at).collect()
}
