//! The ideal film of a layout: its polarization (Dai 2024, Fig. 2), and vectors of its field
//! (Fig. 3).

use std::f64::consts::SQRT_2;

use glam::DVec3;
use magsplice::Film;
use magsplice::prelude::{IdealFilm, Tile};

use super::layout_legend::{direction_wheel, strength};
use super::vectors;
use crate::colours::{DirectionColours, plotters_colour};
use crate::csv::csv_of_vectors;
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::{DrawError, ReportError};
use crate::marks::arrow;
use crate::panel::{AxisLabel, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{INK, LETTERS, sheet};
use crate::survey::{IDEAL_ROUND_OFF, without_round_off};
use crate::tile_shapes::bounds;
use crate::typeset::{AXIS_NAMES, variable};

const POLARIZATION_CAPTION: &str = "J of the ideal film (Eq. 1) from above, over the extent of the spliced film. The \
    length of an arrow is proportional to the magnitude of J, and its colour shows the direction.";

const VECTORS_CAPTION: &str = "B of the ideal film (Eq. 2) in three planes. The length and the colour of an arrow show \
    the logarithm of the magnitude of B in the plane. The dashed rectangle is the working volume.";

/// Arrows per wavelength along an axis: the arrows of a period are the same in each.
const ARROWS_PER_WAVELENGTH: f64 = 12.0;

/// Most arrows along an axis, for films of very many wavelengths.
const MOST_ARROWS: f64 = 48.0;

/// Largest width and height of the panel, in pixels.
const ROOM_PX: [f64; 2] = [560.0, 560.0];
const TOP_PX: f64 = 20.0;

/// Width of the legend at the right of the panel, in pixels.
const LEGEND_PX: f64 = 190.0;

/// Lengths of the longest arrow over the distance of neighbouring arrows.
const LONGEST: f64 = 1.1;

/// Width of an arrow, in pixels.
const ARROW_PX: f64 = 1.8;

/// The figures `ideal-polarization` and `ideal-vectors` of the ideal film, over the extent of the
/// film.
///
/// # Errors
/// [`ReportError`] without a working volume or an ideal film, and if a figure cannot be drawn.
pub fn ideal_film_figures(film: &Film) -> Result<Vec<Drawing>, ReportError> {
    let (ideal, volume) = (film.ideal()?, film.volume()?);
    let of_film = bounds(film.layout().tiles.iter().map(|named| &named.tile));
    let [lower, upper] = of_film.unwrap_or([volume.lower_mm, volume.upper_mm]);
    let columns = columns(ideal, lower, upper);
    let field = |points: &[DVec3]| points.iter().map(|point| field_t(ideal, *point)).collect();
    let vectors = vectors::draft_of_magnet(
        "ideal-vectors",
        VECTORS_CAPTION,
        &columns.iter().collect::<Vec<_>>(),
        &field,
        volume,
        &SharedRanges::default(),
    )?;
    [polarization(ideal, &columns, [lower, upper])?, vectors]
        .map(|draft| draft.rendered(SvgText::Text))
        .into_iter()
        .collect()
}

/// B of the ideal film; NaN where Eq. 2 does not hold. Components of round-off are 0.
fn field_t(ideal: &IdealFilm, point: DVec3) -> DVec3 {
    let b = ideal.flux_density_t(point).unwrap_or(DVec3::NAN);
    let largest_t = 2.0 * ideal.surface_amplitude_t().abs() * (ideal.wavenumber() * point.z).exp();
    without_round_off(b, IDEAL_ROUND_OFF * largest_t)
}

/// Columns of the ideal film with J of their centres. Their sides are fractions of the wavelength,
/// so that a zero of J is on the middle or on the edge of a column in each period.
fn columns(ideal: &IdealFilm, lower: DVec3, upper: DVec3) -> Vec<Tile> {
    let extent = (upper - lower).truncate().max_element();
    let per_wavelength = ARROWS_PER_WAVELENGTH.min(MOST_ARROWS * ideal.wavelength() / extent);
    let side = ideal.wavelength() / per_wavelength;
    let numbers = |axis: usize| (lower[axis] / side).floor() as i64..(upper[axis] / side).ceil() as i64;
    let size = DVec3::new(side, side, ideal.thickness());
    let mut columns = Vec::new();
    for x in numbers(0) {
        for y in numbers(1) {
            let centre = DVec3::new((x as f64 + 0.5) * side, (y as f64 + 0.5) * side, 0.5 * ideal.thickness());
            // A layout with a valid ideal film and volume has columns within the limits of tiles.
            columns.extend(Tile::new(centre, size, ideal.polarization_t(centre)));
        }
    }
    columns
}

/// The figure of J from above.
fn polarization(ideal: &IdealFilm, columns: &[Tile], [lower, upper]: [DVec3; 2]) -> Result<FigureDraft, ReportError> {
    let rows = columns.iter().map(|column| [column.position(), column.polarization_t()]);
    let csv = csv_of_vectors("x_mm,y_mm,z_mm,j_x_t,j_y_t,j_z_t", rows);
    FigureDraft::new("ideal-polarization", POLARIZATION_CAPTION, draw(ideal, columns, [lower, upper]), csv)
}

fn draw(ideal: &IdealFilm, columns: &[Tile], [lower, upper]: [DVec3; 2]) -> Result<String, DrawError> {
    let extent = (upper - lower).truncate();
    let [width, height] = equal_scale(ROOM_PX, extent.to_array());
    let panel = Panel::new([LEFT_PX, TOP_PX], [width, height], [lower.x, upper.x], [lower.y, upper.y]);
    let directions = DirectionColours::new();
    let most_t = SQRT_2 * ideal.amplitude_t().abs();
    let longest = |column: &Tile| LONGEST * column.size().x * panel.px_per_x();
    sheet([panel.right() + LEGEND_PX, panel.bottom() + BELOW_PX + 6.0], |sheet| {
        for column in columns.iter().filter(|column| panel.contains(column.position().x, column.position().y)) {
            let j = column.polarization_t();
            let half = 0.5 * longest(column) * j / most_t;
            let [x, y] = panel.at(column.position().x, column.position().y);
            let colour = plotters_colour(directions.colour(j));
            arrow(sheet, [x - half.x, y + half.y], [x + half.x, y - half.y], ARROW_PX, colour)?;
        }
        let [x, y] = [0, 1].map(|axis| AxisLabel::Coordinate(AXIS_NAMES[axis]));
        panel.axes(sheet, x, y)?;
        let left = panel.right() + 24.0;
        let y = direction_wheel(sheet, &directions, plotters_colour, left, TOP_PX + 10.0)? + 34.0;
        let Some(length) = columns.first().map(longest) else { return Ok(()) };
        arrow(sheet, [left, y], [left + length, y], ARROW_PX, INK)?;
        sheet.text([left + length + 8.0, y], &format!("largest |{}|: {}", variable("J"), strength(most_t)), LETTERS)
    })
}
