//! Vectors of B below the film in three planes. The length of an arrow follows the logarithm of the
//! magnitude (Dai 2024, Fig. 3).

use glam::DVec3;
use magsplice::Film;
use magsplice::layout::{NamedTile, WorkingVolume};
use magsplice::prelude::{Quantity, Tile};
use plotters::prelude::RGBColor;

use crate::colours::{ColourScale, DirectionColours, Palette, light, plotters_colour};
use crate::csv::csv_of_vectors;
use crate::drawing::FigureDraft;
use crate::error::{DrawError, ReportError};
use crate::flux_unit::flux_unit;
use crate::marks::arrow;
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, LEFT_PX, Panel};
use crate::shared_ranges::SharedRanges;
use crate::sheet::{DrawResult, INK, Sheet, rectangle, sheet};
use crate::survey::{round_off_t, without_round_off};
use crate::tile_shapes::{bounds, in_plane, section};
use crate::typeset::{AXIS_NAMES, plane, variable};

const CAPTION: &str = "B in three planes. The length and the colour of an arrow show the logarithm of the magnitude of B in \
    the plane. The dashed rectangle is the working volume.";

/// Maximum width of the two vertical views, in pixels.
const MAX_WIDTH_PX: f64 = 560.0;
/// Maximum height of the two vertical views, in pixels.
const MAX_HEIGHT_PX: f64 = 270.0;
/// Minimum side of a view, as a fraction of the longest.
const MIN_SIDE_FRACTION: f64 = 0.2;
const TOP_PX: f64 = 34.0;
/// Minimum height of the colour bar: the length of its name, in pixels.
const MIN_BAR_PX: f64 = 190.0;
/// Distance of neighbouring arrows, in pixels.
const PITCH_PX: f64 = 17.5;
/// Length of the longest arrow, in pixels.
const LONGEST_PX: f64 = 19.0;
/// Length of the shortest arrow as a fraction of the longest.
const SHORTEST: f64 = 0.28;
/// Fields this many decades below the largest, and weaker ones, get the shortest arrow.
const DECADES: f64 = 2.0;
/// The views extend from the centre of the working volume to the end of the film, but at most this
/// many half widths of the volume.
const REACH: f64 = 5.0;

/// A plane in which B is drawn.
struct PlaneView {
    panel: Panel,
    normal: usize,
    at_mm: f64,
    /// Range of the arrows along the second axis of the plane.
    arrows: [f64; 2],
}

/// B at a point of a view, in its plane.
struct FieldArrow {
    at: [f64; 2],
    field_t: [f64; 2],
    point_mm: DVec3,
    whole_t: DVec3,
}

/// The figure.
pub(crate) fn draft(
    film: &Film,
    tiles: &[&NamedTile],
    volume: &WorkingVolume,
    ranges: &SharedRanges,
) -> Result<FigureDraft, ReportError> {
    let field = |points: &[DVec3]| {
        let mut field = vec![DVec3::ZERO; points.len()];
        // Points without a field are NaN, and get no arrow.
        let _ = film.scene().field_into(Quantity::FluxDensity, points, &mut field);
        let bounds = round_off_t(film, points, &field);
        field.into_iter().zip(bounds).map(|(b, bound)| without_round_off(b, bound)).collect()
    };
    let tiles: Vec<&Tile> = tiles.iter().map(|named| &named.tile).collect();
    draft_of_magnet("vectors", CAPTION, &tiles, &field, volume, ranges)
}

/// The figure of a magnet with this field. `tiles` fill the magnet, and `field` is B in tesla, NaN
/// where it is unbounded.
pub(super) fn draft_of_magnet(
    name: &'static str,
    caption: &str,
    tiles: &[&Tile],
    field: &dyn Fn(&[DVec3]) -> Vec<DVec3>,
    volume: &WorkingVolume,
    ranges: &SharedRanges,
) -> Result<FigureDraft, ReportError> {
    let views = views(tiles, volume, ranges);
    let arrows = views.each_ref().map(|view| view.field_arrows(field));
    let rows = arrows.iter().flatten().map(|arrow| [arrow.point_mm, arrow.whole_t]);
    let csv = csv_of_vectors("x_mm,y_mm,z_mm,b_x_t,b_y_t,b_z_t", rows);
    FigureDraft::new(name, caption, draw(&views, &arrows, tiles, volume, ranges), csv)
}

/// The three views.
fn views(tiles: &[&Tile], volume: &WorkingVolume, ranges: &SharedRanges) -> [PlaneView; 3] {
    let [film_low, film_high] = bounds(tiles.iter().copied()).unwrap_or([volume.lower_mm, volume.upper_mm]);
    let middle = 0.5 * (volume.lower_mm + volume.upper_mm);
    let half_volume = 0.5 * (volume.upper_mm - volume.lower_mm);
    let window = |axis: usize| {
        let film_half = (film_high[axis] - middle[axis]).max(middle[axis] - film_low[axis]);
        let half = film_half.clamp(half_volume[axis], REACH * half_volume[axis]) * 1.03;
        [middle[axis] - half, middle[axis] + half]
    };
    // The views contain the volume and the film. Arrows stay outside the film, unless the volume
    // overlaps it.
    let margin = 0.06 * (film_high.z.max(volume.upper_mm.z) - film_low.z.min(volume.lower_mm.z));
    let z = [film_low.z.min(volume.lower_mm.z) - margin, film_high.z.max(volume.upper_mm.z) + margin];
    let between = if volume.upper_mm.z <= film_low.z {
        [z[0], film_low.z]
    } else if volume.lower_mm.z >= film_high.z {
        [film_high.z, z[1]]
    } else {
        z
    };
    // A view must be wide enough that both of its axes can have the same scale of length.
    let widest = [window(0), window(1), z].map(|[low, high]| high - low).into_iter().fold(0.0, f64::max);
    let wide_enough = |[low, high]: [f64; 2]| {
        let more = (0.5 * (MIN_SIDE_FRACTION * widest - (high - low))).max(0.0);
        [low - more, high + more]
    };
    let shared = |axis: &str, range: [f64; 2]| ranges.widened(&format!("vectors {axis}"), wide_enough(range));
    let [x, y, z] = [shared("x", window(0)), shared("y", window(1)), shared("z", z)];
    let per_mm = (MAX_WIDTH_PX / (x[1] - x[0])).min(MAX_WIDTH_PX / (y[1] - y[0])).min(MAX_HEIGHT_PX / (z[1] - z[0]));
    let height = per_mm * (z[1] - z[0]);
    let left = LEFT_PX + 6.0;
    let upright = |horizontal: [f64; 2], top: f64| {
        Panel::new([left, top], [per_mm * (horizontal[1] - horizontal[0]), height], horizontal, z)
    };
    let first = upright(x, TOP_PX);
    let second = upright(y, first.bottom() + BELOW_PX + TOP_PX);
    let room = second.bottom() - TOP_PX;
    let per_mm = (room / (y[1] - y[0])).min(MAX_WIDTH_PX / (x[1] - x[0]));
    let left = first.right().max(second.right()) + LEFT_PX + 28.0;
    let third = Panel::new([left, TOP_PX], [per_mm * (x[1] - x[0]), per_mm * (y[1] - y[0])], x, y);
    [
        PlaneView { panel: first, normal: 1, at_mm: middle.y, arrows: between },
        PlaneView { panel: second, normal: 0, at_mm: middle.x, arrows: between },
        PlaneView { panel: third, normal: 2, at_mm: middle.z, arrows: y },
    ]
}

fn draw(
    views: &[PlaneView; 3],
    arrows: &[Vec<FieldArrow>; 3],
    tiles: &[&Tile],
    volume: &WorkingVolume,
    ranges: &SharedRanges,
) -> Result<String, DrawError> {
    let [_, second, third] = views.each_ref().map(|view| view.panel);
    let strengths = || arrows.iter().flatten().map(FieldArrow::strength_t).filter(|b| *b > 0.0);
    let most_t = ranges.widened("vectors most", [0.0, strengths().fold(0.0, f64::max)])[1];
    let unit = flux_unit(most_t);
    let least_t = strengths().fold(most_t, f64::min).max(most_t * 10_f64.powf(-DECADES));
    let decade = |t: f64| (t * unit.per_t).log10();
    let least_t = ranges.widened("vectors least", [least_t, least_t])[0];
    let [low, high] =
        if most_t > 0.0 { [decade(least_t).min(decade(most_t) - 0.5), decade(most_t)] } else { [0.0, 1.0] };
    let scale = ColourScale { low, high, palette: Palette::Lines };
    let size = [third.right() + 14.0 + BAR_PX, second.bottom().max(third.bottom()) + BELOW_PX + 6.0];
    sheet(size, |sheet| {
        for (index, (view, arrows)) in views.iter().zip(arrows).enumerate() {
            view.draw(sheet, tiles, volume)?;
            let mapper = scale.mapper();
            for field_arrow in arrows {
                let strength = field_arrow.strength_t();
                // Round-off is 0 already.
                if strength == 0.0 {
                    continue;
                }
                let level = decade(strength).max(scale.low);
                let share = (level - scale.low) / (scale.high - scale.low);
                let length = LONGEST_PX * (SHORTEST + (1.0 - SHORTEST) * share);
                let [x, y] = view.panel.at(field_arrow.at[0], field_arrow.at[1]);
                let half = field_arrow.field_t.map(|b| 0.5 * length * b / strength);
                let colour = plotters_colour(mapper.colour(level));
                arrow(sheet, [x - half[0], y + half[1]], [x + half[0], y - half[1]], 1.5, colour)?;
            }
            if arrows.is_empty() {
                view.panel.remark(sheet, &["no arrows: B is not", "defined in this plane"])?;
            } else if arrows.iter().all(|arrow| arrow.strength_t() == 0.0) {
                view.panel.remark(sheet, &["no arrows: B has no component", "in this plane"])?;
            }
            view.frame(sheet, index)?;
        }
        let bar = Panel { height: third.height.max(MIN_BAR_PX), ..third };
        let name = format!("|{}| in the plane of view ({})", variable("B"), unit.name);
        bar.logarithmic_bar(sheet, 14.0, scale, &name)
    })
}

impl PlaneView {
    /// B at regular points of the view that are in the range of the arrows. Points where B is
    /// unbounded are omitted.
    fn field_arrows(&self, field: &dyn Fn(&[DVec3]) -> Vec<DVec3>) -> Vec<FieldArrow> {
        let [u, v] = in_plane(self.normal);
        let counts = [self.panel.width, self.panel.height].map(|px| ((px / PITCH_PX).floor() as usize).max(2));
        let along =
            |range: [f64; 2], i: usize, n: usize| range[0] + (i as f64 + 0.5) / n as f64 * (range[1] - range[0]);
        let mut points = Vec::new();
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                let mut p = DVec3::ZERO;
                p[self.normal] = self.at_mm;
                p[u] = along(self.panel.x, i, counts[0]);
                p[v] = along(self.panel.y, j, counts[1]);
                if (self.arrows[0]..=self.arrows[1]).contains(&p[v]) {
                    points.push(p);
                }
            }
        }
        let field_arrow =
            |(p, b): (DVec3, DVec3)| FieldArrow { at: [p[u], p[v]], field_t: [b[u], b[v]], point_mm: p, whole_t: b };
        let field = field(&points);
        points.into_iter().zip(field).filter(|(_, b)| b.is_finite()).map(field_arrow).collect()
    }

    /// The position on the sheet of the point of the view nearest to `p`.
    fn clipped(&self, p: [f64; 2]) -> [f64; 2] {
        let [x, y] = [p[0].clamp(self.panel.x[0], self.panel.x[1]), p[1].clamp(self.panel.y[0], self.panel.y[1])];
        self.panel.at(x, y)
    }

    /// Draws the sections of the tiles and of the working volume.
    fn draw(&self, sheet: &Sheet, tiles: &[&Tile], volume: &WorkingVolume) -> DrawResult {
        let [u, v] = in_plane(self.normal);
        let directions = DirectionColours::new();
        for tile in tiles {
            let section = section(tile, self.normal, self.at_mm);
            if section.len() < 3 || !section.iter().any(|p| self.panel.contains(p.x, p.y)) {
                continue;
            }
            let outline: Vec<[f64; 2]> = section.iter().map(|p| self.clipped(p.to_array())).collect();
            let j = tile.scene_polarization_t();
            sheet.shape(&outline, light(directions.colour(j)), RGBColor(90, 90, 90), 0.7)?;
            let in_view = [j[u], j[v]];
            let strength = in_view[0].hypot(in_view[1]);
            let sides = [0, 1].map(|axis| {
                let of = |p: &[f64; 2]| p[axis];
                outline.iter().map(of).fold(f64::MIN, f64::max) - outline.iter().map(of).fold(f64::MAX, f64::min)
            });
            let length = 0.7 * sides[0].min(26.0).min(if in_view[1].abs() > 0.5 * strength { sides[1] } else { 26.0 });
            if strength > 0.3 * j.length() && length > 4.0 {
                let centre = outline.iter().fold([0.0; 2], |c, p| [c[0] + p[0], c[1] + p[1]]);
                let [x, y] = centre.map(|c| c / outline.len() as f64);
                let half = in_view.map(|c| 0.5 * length * c / strength);
                arrow(sheet, [x - half[0], y + half[1]], [x + half[0], y - half[1]], 1.3, INK)?;
            }
        }
        let (l, h) = (volume.lower_mm, volume.upper_mm);
        let corners = rectangle(self.panel.at(l[u], l[v]), self.panel.at(h[u], h[v]));
        sheet.dashed_outline(&corners, INK, 1.2)
    }

    /// Draws the axes and the title.
    fn frame(&self, sheet: &Sheet, index: usize) -> DrawResult {
        let [across, along] = in_plane(self.normal).map(|axis| AxisLabel::Coordinate(AXIS_NAMES[axis]));
        self.panel.axes(sheet, across, along)?;
        let plane = plane(self.normal, self.at_mm);
        let title = if self.normal == 2 { format!("{plane}, from above") } else { plane };
        self.panel.title(sheet, index, &title)
    }
}

impl FieldArrow {
    /// Magnitude in the plane.
    fn strength_t(&self) -> f64 {
        self.field_t[0].hypot(self.field_t[1])
    }
}
