//! Measured planes of a scan beside the field of the layout: B (Dai 2024, Fig. 6), and the
//! decoupling parameters (Figs. 7 and 8).

use glam::DVec3;
use magsplice::Film;
use magsplice::results::FilmScan;

use crate::colours::ColourScale;
use crate::csv::csv_of_vectors;
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::ReportError;
use crate::flux_unit::{flux_unit, largest_component_t};
use crate::scan_planes::{ScanPlane, ScanPlanes};
use crate::shared_ranges::range_of;
use crate::tile_shapes::in_plane;
use crate::typeset::{AXIS_NAMES, number, parameter, plane, symbol};

use super::map_grid::{ComparedRow, FIRST_PX, MapColumn, MapGrid, ROOM_PX, map_size, zero_remark};

const FIELDS: [&str; 3] = ["scan-field-lowest", "scan-field-middle", "scan-field-highest"];
const LEVEL: [&str; 3] = ["scan-parameters-lowest", "scan-parameters-middle", "scan-parameters-highest"];
const UPRIGHT: [&str; 2] = ["scan-parameters-upright-y", "scan-parameters-upright-x"];

const PER_MILLI: f64 = 1e3;
/// Pixels along a side of a map at least: as many as print resolves.
const SHARP_PX: usize = 400;

/// Figures of planes of a scan: B, and with an ideal film R_x, R_y, S_z (Dai 2024, Figs. 6 to 8).
/// Empty for positions that are no grid with equal steps, of two at least along two axes.
///
/// # Errors
/// [`ReportError::Drawing`] if a figure cannot be drawn.
pub fn scan_figures(film: &Film, scan: &FilmScan) -> Result<Vec<Drawing>, ReportError> {
    let ScanPlanes { level, upright } = ScanPlanes::new(scan, film.branch());
    // The last of one or two planes is the highest.
    let named = |names: [&'static str; 3]| {
        let names = if level.len() == 2 { vec![names[0], names[2]] } else { names.to_vec() };
        names.into_iter().zip(&level)
    };
    let fields = named(FIELDS).map(|(name, plane)| Some(fields(plane, name)));
    let parameters = named(LEVEL).chain(UPRIGHT.into_iter().zip(&upright));
    let all = fields.chain(parameters.map(|(name, plane)| parameters_figure(plane, name)));
    all.flatten().map(|draft| draft?.rendered(SvgText::Text)).collect()
}

/// The figure of B on a plane.
fn fields(plane: &ScanPlane, name: &'static str) -> Result<FigureDraft, ReportError> {
    let [measured, simulated] = &plane.fields_t;
    let unit = flux_unit(largest_component_t(measured.iter().chain(simulated).copied()));
    let fine = flux_unit(largest_component_t(measured.iter().zip(simulated).map(|(m, s)| *m - *s)));
    let rows = [0, 1, 2].map(|axis| {
        let name = symbol("B", AXIS_NAMES[axis]);
        row(&plane.fields_t, axis, name, [unit.name, fine.name], [unit.per_t, fine.per_t])
    });
    let header = "b_x_t,b_y_t,b_z_t,simulated_b_x_t,simulated_b_y_t,simulated_b_z_t";
    figure(plane, rows, name, "B", table(plane, header, &plane.fields_t))
}

/// The figure of R_x, R_y, S_z on a plane. `None` without parameters.
fn parameters_figure(plane: &ScanPlane, name: &'static str) -> Option<Result<FigureDraft, ReportError>> {
    let values = plane.parameters.as_ref()?;
    let units = [["rad", "mrad"], ["rad", "mrad"], ["ln of B/T", "1/1000"]];
    let rows = [0, 1, 2].map(|which| row(values, which, parameter(which), units[which], [1.0, PER_MILLI]));
    let header = "r_x_rad,r_y_rad,s_z_ln_t,simulated_r_x_rad,simulated_r_y_rad,simulated_s_z_ln_t";
    Some(figure(plane, rows, name, "The decoupling parameters", table(plane, header, values)))
}

/// A component, and its difference; `per_unit` are the numbers of units in one of the values.
fn row(
    [measured, simulated]: &[Vec<DVec3>; 2],
    component: usize,
    name: String,
    units: [&'static str; 2],
    per_unit: [f64; 2],
) -> ComparedRow {
    let [m, s] = [measured, simulated].map(|of| of.iter().map(|v| v[component] * per_unit[0]).collect::<Vec<f64>>());
    let difference = measured.iter().zip(simulated).map(|(m, s)| (m[component] - s[component]) * per_unit[1]);
    let difference: Vec<f64> = difference.collect();
    let range = range_of(m.iter().chain(&s).copied());
    // Logarithms have no zero.
    let is_logarithm = range[1] < 0.0 && range[0] < -2.0 * (range[1] - range[0]);
    let scale = if is_logarithm { ColourScale::without_zero(range) } else { ColourScale::signed(range) };
    let scales = [scale, ColourScale::signed(range_of(difference.iter().copied()))];
    ComparedRow { name, units, values: [m, s, difference], scales }
}

fn figure(
    of: &ScanPlane,
    rows: [ComparedRow; 3],
    name: &'static str,
    what: &str,
    csv: String,
) -> Result<FigureDraft, ReportError> {
    let caption = format!(
        "{what} at {} = {} mm: the readings without the errors of the sensor, the field of the layout at the same \
         points, and the difference.",
        AXIS_NAMES[of.normal],
        number(of.at_mm)
    );
    let ranges_mm = of.coordinates_mm.each_ref().map(|coordinates| sides(coordinates));
    let cells = of.coordinates_mm.each_ref().map(Vec::len);
    let first = MapColumn {
        left: FIRST_PX,
        size: map_size(ROOM_PX, ranges_mm),
        axes: in_plane(of.normal),
        ranges_mm,
        is_numbered: true,
        cells,
        // Viewers smooth between the pixels of an image, and a reading is unknown beside its cell.
        pixels: cells.map(|count| SHARP_PX.div_ceil(count)),
    };
    let titles = ["measured", "simulated", "measured \u{2212} simulated"];
    let grid = MapGrid::compared(plane(of.normal, of.at_mm), titles, &first, rows, zero_remark);
    FigureDraft::of_maps(name, caption, grid, csv)
}

fn table(plane: &ScanPlane, header: &str, [measured, simulated]: &[Vec<DVec3>; 2]) -> String {
    let [u, v] = in_plane(plane.normal);
    let place = |across: f64, along: f64| {
        let mut place = DVec3::splat(plane.at_mm);
        (place[u], place[v]) = (across, along);
        place
    };
    let [across, along] = &plane.coordinates_mm;
    let places = across.iter().flat_map(|u| along.iter().map(move |v| place(*u, *v)));
    let rows = places.zip(measured).zip(simulated).map(|((place, measured), simulated)| [place, *measured, *simulated]);
    csv_of_vectors(&format!("x_mm,y_mm,z_mm,{header}"), rows)
}

/// Lower and upper side of a map whose cells have the points at their centres.
fn sides(coordinates: &[f64]) -> [f64; 2] {
    let (first, last) = (coordinates[0], coordinates[coordinates.len() - 1]);
    let half_cell = if coordinates.len() > 1 { 0.5 * (last - first) / (coordinates.len() - 1) as f64 } else { 0.5 };
    [first - half_cell, last + half_cell]
}
