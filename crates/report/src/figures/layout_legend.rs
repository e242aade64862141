//! The legend of the figure of the tiles.

use glam::DVec3;
use magsplice::layout::NamedTile;
use plotters::prelude::RGBColor;

use crate::colours::{DirectionColours, Rgb, light};
use crate::marks::{VANISHING, arrow, corner_brackets, out_of_plane_mark, sensor_mark};
use crate::sheet::{DrawResult, INK, LETTERS, PlotError, Sheet};
use crate::typeset::{plain, rounded, variable};

use super::film_panel::tile_count;
use super::tile_annotations::arrow_width;

/// Distance of the marks from the left side of the colour circle beside them, in pixels.
const BESIDE_WHEEL_PX: f64 = 160.0;

/// The legend at the right of the drawing or below it.
pub(super) struct LayoutLegend<'a> {
    /// Its upper left corner.
    pub(super) at: [f64; 2],
    /// Whether it is below: the colour circle is then beside the marks, not above them.
    pub(super) is_below: bool,
    /// The length of the arrow of the tile with the largest |J|, in pixels.
    pub(super) arrow_px: f64,
    /// The largest |J| in tesla.
    pub(super) most_t: f64,
    /// The tiles that are drawn.
    pub(super) tiles: &'a [&'a NamedTile],
    /// The number of tiles of the layout.
    pub(super) all: usize,
    /// Whether a working volume is drawn.
    pub(super) volume: bool,
    /// Number of sensors that are drawn.
    pub(super) sensors: usize,
    /// Each plane of iron in words.
    pub(super) iron: &'a [String],
    /// Lines about the names of the tiles.
    pub(super) names: &'a [String],
}

impl LayoutLegend<'_> {
    /// Height below a drawing, in pixels.
    pub(super) const HEIGHT_PX: f64 = 200.0;

    pub(super) fn draw(&self, sheet: &Sheet, directions: &DirectionColours) -> DrawResult {
        let [left, top] = self.at;
        let mut y = direction_wheel(sheet, directions, light, left, top + 10.0)? + 34.0;
        let left = if self.is_below { left + BESIDE_WHEEL_PX } else { left };
        if self.is_below {
            y = top + 34.0;
        }
        y = self.marks(sheet, [left, y])?;
        for line in self.lines() {
            sheet.text([left, y], &line, LETTERS)?;
            y += 20.0;
        }
        Ok(())
    }

    /// Draws the meaning of the arrow and the other marks from `y` down, and returns where it ends.
    fn marks(&self, sheet: &Sheet, [left, mut y]: [f64; 2]) -> Result<f64, PlotError> {
        let polarization = |named: &&NamedTile| named.tile.scene_polarization_t() / self.most_t;
        if self.tiles.iter().any(|named| polarization(named).truncate().length() > VANISHING) {
            let length = self.arrow_px;
            arrow(sheet, [left, y], [left + length, y], arrow_width(self.arrow_px), INK)?;
            sheet.text([left + length + 8.0, y], &strength(self.most_t), LETTERS)?;
            y += 26.0;
        }
        for (sign, text) in [(1.0, "up, to the viewer"), (-1.0, "down")] {
            if self.tiles.iter().any(|named| sign * polarization(named).z > VANISHING) {
                out_of_plane_mark(sheet, [left + 10.0, y], 8.0, sign > 0.0)?;
                sheet.text([left + 28.0, y], text, LETTERS)?;
                y += 26.0;
            }
        }
        if self.volume {
            corner_brackets(sheet, [left, y - 8.0], [left + 24.0, y + 8.0], 5.0)?;
            sheet.text([left + 34.0, y], "working volume", LETTERS)?;
            y += 30.0;
        }
        if self.sensors > 0 {
            sensor_mark(sheet, [left + 12.0, y])?;
            sheet.text([left + 34.0, y], &format!("{} sensors at rest", self.sensors), LETTERS)?;
            y += 30.0;
        }
        Ok(y)
    }

    /// The lines of text: the number of tiles, |J|, the iron and the names.
    fn lines(&self) -> Vec<String> {
        let (tiles, all) = (self.tiles, self.all);
        let mut lines = vec![tile_count(all)];
        if tiles.len() < all {
            lines.push(format!("drawn: the {} nearest", tiles.len()));
        }
        let least_t = tiles.iter().map(|named| named.tile.polarization_t().length()).fold(f64::MAX, f64::min);
        if self.most_t - least_t <= 1e-9 * self.most_t {
            let each = if all == 1 { "" } else { " in each" };
            lines.push(format!("|{}| = {}{each}", variable("J"), strength(self.most_t)));
        } else {
            lines.push(format!("|{}| = {} to {}", variable("J"), strength(least_t), strength(self.most_t)));
        }
        lines.extend(self.iron.iter().map(|plane| format!("Iron: {}", plain(plane))));
        lines.extend_from_slice(self.names);
        lines
    }
}

/// Draws the colour circle, its colours by `shade`, with its title from `y` down, and returns where
/// it ends.
pub(super) fn direction_wheel(
    sheet: &Sheet,
    directions: &DirectionColours,
    shade: fn(Rgb) -> RGBColor,
    left: f64,
    y: f64,
) -> Result<f64, PlotError> {
    sheet.text([left, y], "Direction of polarization", LETTERS)?;
    let wheel = 46.0;
    let y = y + 24.0 + wheel;
    let centre = [left + wheel + 18.0, y];
    let sectors = 48;
    for i in 0..sectors {
        let angle = |i: i32| f64::from(i) / f64::from(sectors) * std::f64::consts::TAU;
        let (from, to, middle) = (angle(i) - 0.01, angle(i + 1), 0.5 * (angle(i) + angle(i + 1)));
        let rim = |angle: f64, r: f64| [centre[0] + r * angle.cos(), centre[1] - r * angle.sin()];
        let colour = shade(directions.colour(DVec3::new(middle.cos(), middle.sin(), 0.0)));
        let inner = 0.45 * wheel;
        sheet.fill(&[rim(from, wheel), rim(to, wheel), rim(to, inner), rim(from, inner)], colour)?;
    }
    for (text, dx, dy) in [("x", 1.0, 0.0), ("y", 0.0, -1.0)] {
        let letters = LETTERS.centred();
        sheet.text([centre[0] + dx * (wheel + 10.0), centre[1] + dy * (wheel + 9.0)], &variable(text), letters)?;
        let tip = [centre[0] + dx * 0.4 * wheel, centre[1] + dy * 0.4 * wheel];
        arrow(sheet, centre, tip, 1.2, INK)?;
    }
    Ok(y + wheel)
}

/// A polarization with four significant digits and its unit.
pub(super) fn strength(value_t: f64) -> String {
    format!("{} T", rounded(value_t, 3))
}
