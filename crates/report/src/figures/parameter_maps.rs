//! R_x, R_y, S_z on planes through the working volume: planes of constant z (Dai 2024, Fig. 7) and
//! vertical planes (Fig. 8).
//!
//! On a plane of constant z S_z should be constant, and its map would be one colour. There the
//! figure shows the residual: S_z minus its mean over the plane, as a displacement along z.

use glam::DVec3;

use crate::colours::ColourScale;
use crate::csv::csv;
use crate::drawing::FigureDraft;
use crate::error::ReportError;
use crate::panel::LEFT_PX;
use crate::shared_ranges::SharedRanges;
use crate::survey::{AgainstIdeal, FieldSlice};
use crate::typeset::{parameter, plane, thousandths, variable};

use super::map_grid::{BESIDE_PX, GAP_PX, GridMap, MapColumn, MapGrid, map_size, zero_remark};

const UM_PER_MM: f64 = 1e3;

/// Which planes a figure shows.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum MappedPlanes {
    /// Planes of constant z, where the map of S_z is S_z minus its mean over the plane, divided by
    /// k, in um.
    Level,
    /// Vertical planes.
    Upright,
}

impl MappedPlanes {
    fn name(self) -> &'static str {
        match self {
            MappedPlanes::Level => "parameters-level",
            MappedPlanes::Upright => "parameters-upright",
        }
    }

    /// Maximum width and height of a map, in pixels.
    fn room_px(self) -> [f64; 2] {
        match self {
            MappedPlanes::Level => [220.0, 220.0],
            MappedPlanes::Upright => [340.0, 200.0],
        }
    }

    fn caption(self) -> &'static str {
        match self {
            MappedPlanes::Level => {
                "The decoupling parameters on planes of constant z. R_x should depend on x only, R_y on y only, and \
                 S_z on z only. For S_z the maps show the residual: S_z minus its mean over the plane, divided by the \
                 wavenumber k. This is the apparent displacement along z on the plane, in um; the true one is zero. \
                 The mean stands above each map."
            }
            MappedPlanes::Upright => {
                "The decoupling parameters on the two vertical planes through the centre of the working volume."
            }
        }
    }
}

/// The name of a parameter with its unit.
pub(crate) fn name(which: usize) -> String {
    format!("{} ({})", parameter(which), ["rad", "rad", "ln of B/T"][which])
}

/// The parameters on a slice.
struct SliceParameters {
    /// In the order of the cells; NaN where there are none.
    values: Vec<DVec3>,
    /// The mean of S_z, and S_z minus the mean, divided by k, in um: the displacement along z that
    /// the film shows where there is none.
    residual: Option<(f64, Vec<f64>)>,
}

impl SliceParameters {
    fn new(against: &AgainstIdeal, slice: &FieldSlice, planes: MappedPlanes) -> SliceParameters {
        let values = slice.parameters(against.branch);
        let residual = (planes == MappedPlanes::Level).then(|| {
            let finite = values.iter().map(|p| p.z).filter(|s| s.is_finite());
            let (sum, count) = finite.fold((0.0, 0), |(sum, n), s| (sum + s, n + 1));
            let mean = sum / f64::from(count);
            let um_per_unit = UM_PER_MM / against.film.wavenumber();
            let of_cell = |(p, round_off): (&DVec3, f64)| {
                let residual = p.z - mean;
                um_per_unit * if residual.abs() <= round_off { 0.0 } else { residual }
            };
            (mean, values.iter().zip(slice.log_round_off()).map(of_cell).collect())
        });
        SliceParameters { values, residual }
    }
}

/// The figure: one column per slice with its title, one row per parameter with one colour scale.
/// All slices have the same axes or the same height.
pub(crate) fn draft(
    against: &AgainstIdeal,
    slices: &[FieldSlice],
    planes: MappedPlanes,
    ranges: &SharedRanges,
) -> Result<FigureDraft, ReportError> {
    let parameters: Vec<SliceParameters> =
        slices.iter().map(|slice| SliceParameters::new(against, slice, planes)).collect();
    let rows = (0..3).map(|row| maps(slices, &parameters, planes, row, ranges)).collect();
    let columns = columns(slices, planes.room_px());
    let grid = MapGrid { heading: None, beside_px: BESIDE_PX, columns, rows, is_stacked: false };
    FigureDraft::of_maps(planes.name(), planes.caption(), grid, table(slices, &parameters, planes))
}

/// The columns, all on the same scale of length.
fn columns(slices: &[FieldSlice], room_px: [f64; 2]) -> Vec<MapColumn> {
    let extent = |slice: &FieldSlice, axis: usize| slice.ranges_mm[axis][1] - slice.ranges_mm[axis][0];
    let widest = slices.iter().map(|slice| extent(slice, 0)).fold(0.0, f64::max);
    let mut right = 6.0 - GAP_PX;
    let column = |(n, slice): (usize, &FieldSlice)| {
        let [width, height] = map_size(room_px, [[0.0, widest], slice.ranges_mm[1]]);
        let width = (width * extent(slice, 0) / widest).max(0.2 * width);
        // A slice along other axes than the one at its left has numbers of its own.
        let is_numbered = n == 0 || slice.axes != slices[n - 1].axes;
        let left = right + GAP_PX + if is_numbered { LEFT_PX } else { 0.0 };
        right = left + width;
        MapColumn::of_slice(slice, left, [width, height], is_numbered)
    };
    slices.iter().enumerate().map(column).collect()
}

/// The maps of a parameter on all slices.
fn maps(
    slices: &[FieldSlice],
    parameters: &[SliceParameters],
    planes: MappedPlanes,
    row: usize,
    ranges: &SharedRanges,
) -> Vec<GridMap> {
    let is_residual = row == 2 && planes == MappedPlanes::Level;
    let values = |of: &SliceParameters| match &of.residual {
        Some((_, um)) if is_residual => um.clone(),
        _ => of.values.iter().map(|p| p[row]).collect::<Vec<f64>>(),
    };
    let all: Vec<Vec<f64>> = parameters.iter().map(values).collect();
    let range = ranges.of_values(&format!("{} {row}", planes.name()), all.iter().flatten().copied());
    let scale = if row == 2 && !is_residual { ColourScale::without_zero(range) } else { ColourScale::signed(range) };
    let bar =
        if is_residual { format!("({} \u{2212} mean) / {} (\u{b5}m)", parameter(2), variable("k")) } else { name(row) };
    let map = |(n, values): (usize, Vec<f64>)| GridMap {
        remark: zero_remark(&values),
        values,
        scale,
        title: match &parameters[n].residual {
            Some((mean, _)) if is_residual && mean.is_finite() => format!("mean {}", thousandths(*mean)),
            _ if row == 0 => plane(slices[n].normal, slices[n].at_mm),
            _ => String::new(),
        },
        bar: (n + 1 == slices.len()).then(|| bar.clone()),
    };
    all.into_iter().enumerate().map(map).collect()
}

/// The parameters on all slices as CSV, with the residuals of S_z if the figure shows them.
fn table(slices: &[FieldSlice], parameters: &[SliceParameters], planes: MappedPlanes) -> String {
    let mut header = "x_mm,y_mm,z_mm,r_x_rad,r_y_rad,s_z_ln_t".to_owned();
    if planes == MappedPlanes::Level {
        header += ",s_z_residual_um";
    }
    let rows = slices.iter().zip(parameters).flat_map(|(slice, parameters)| {
        slice.grid.points().enumerate().map(move |(cell, point)| {
            let numbers = [point, parameters.values[cell]].map(|vector| vector.to_array()).concat();
            (String::new(), numbers.into_iter().chain(parameters.residual.as_ref().map(|(_, um)| um[cell])))
        })
    });
    csv(&header, rows)
}
