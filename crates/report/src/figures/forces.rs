//! The tiles from above with the force on each, and the order in which they are placed.

use glam::{DVec2, DVec3};
use magsplice::layout::{Layout, NamedTile};
use magsplice::results::{FilmLoads, TileLoad};
use plotters::style::text_anchor::VPos;

use crate::colours::{DirectionColours, VERMILION, light};
use crate::csv::{csv, quoted};
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::{DrawError, ReportError};
use crate::marks::{arrow, out_of_plane_mark};
use crate::panel::{BELOW_PX, Panel};
use crate::sheet::{DrawResult, INK, LETTERS, Lettering, Sheet, sheet};
use crate::typeset::rounded;

use super::film_panel::{MARGIN, OUTLINE, ROOM_PX, TOP_PX, film_axes, film_bounds, film_panel, outline, upwards};
use super::layout_legend::direction_wheel;

/// Width of the legend at the right of the drawing, in pixels.
const LEGEND_PX: f64 = 190.0;
/// Length of the longest arrow over the longer side of the largest tile, and its limits as
/// fractions of the longer side of the film.
const ARROW_PER_TILE: f64 = 0.75;
const ARROW_PER_FILM: [f64; 2] = [0.035, 0.12];
/// Shorter arrows are not drawn: a head alone has no length.
const SHORTEST_PX: f64 = 3.0;
/// Radius of the mark for the largest force out of the plane, in pixels, and the smallest that is
/// drawn.
const MARK_PX: f64 = 9.0;
const SMALLEST_MARK_PX: f64 = 1.5;
/// Forces from this fraction of the largest on are drawn as the largest: images by symmetry differ
/// by round-off.
const LARGEST: f64 = 1.0 - 1e-9;
/// Size of the numbers of steps, in pixels: the largest, and the smallest that can be read.
const NUMBER_PX: [f64; 2] = [12.0, 7.0];

/// A tile and the force on it.
struct DrawnForce<'a> {
    tile: &'a NamedTile,
    force_n: DVec3,
    /// Step at which it is placed, from 1.
    step: Option<usize>,
}

/// The tiles from above, each with the force on it as an arrow: by the tiles placed before, if the
/// loads have an order, or by all others.
///
/// # Errors
/// [`ReportError::Drawing`] if it cannot be drawn.
pub fn forces_figure(layout: &Layout, loads: &FilmLoads) -> Result<Drawing, ReportError> {
    let is_ordered = loads.order.is_some();
    let caption = if is_ordered {
        "The tiles from above with the number of the step at which each is placed, and the force on it by the \
         tiles placed before. Circles are forces out of the plane, up with a dot and down with a cross."
    } else {
        "The tiles from above with the force on each by all others. Circles are forces out of the plane, up with a \
         dot and down with a cross."
    };
    let drawn = |(index, load): (usize, &TileLoad)| DrawnForce {
        tile: &layout.tiles[load.tile],
        force_n: load.load.force_n,
        step: is_ordered.then_some(index + 1),
    };
    let shown = loads.order.as_ref().map_or(&loads.tiles, |order| &order.steps);
    let tiles: Vec<DrawnForce> = shown.iter().enumerate().map(drawn).collect();
    let row = |DrawnForce { tile, force_n, step }: &DrawnForce| {
        let step = step.map_or(String::new(), |step| step.to_string());
        (format!("{},{step},", quoted(&tile.name)), [tile.tile.position(), *force_n].map(|v| v.to_array()).concat())
    };
    let csv = csv("tile,step,x_mm,y_mm,z_mm,force_x_n,force_y_n,force_z_n", tiles.iter().map(row));
    FigureDraft::new("forces", caption, svg(&tiles, is_ordered), csv)?.rendered(SvgText::Text)
}

fn svg(tiles: &[DrawnForce], is_ordered: bool) -> Result<String, DrawError> {
    let [low, high] = film_bounds(tiles.iter().map(|force| &force.tile.tile));
    let largest = tiles.iter().map(|force| force.tile.tile.size().truncate().max_element()).fold(0.0, f64::max);
    let film = (high - low).truncate().max_element();
    let [shortest, longest] = ARROW_PER_FILM.map(|fraction| fraction * film);
    let arrow_mm = (ARROW_PER_TILE * largest).clamp(shortest, longest);
    let most_n = tiles.iter().map(|force| force.force_n.length()).fold(0.0, f64::max);
    let tips = tiles.iter().filter(|_| most_n > 0.0);
    let tips = tips.map(|force| force.tile.tile.position() + arrow_mm / most_n * force.force_n);
    let (low, high) = tips.fold((low, high), |(low, high), tip| (low.min(tip), high.max(tip)));
    let margin = MARGIN * (high - low).truncate().max_element();
    let panel = film_panel([low - margin, high + margin], ROOM_PX);
    let forces = ForcePainter::new(tiles, panel, most_n, arrow_mm);
    let size = [panel.right() + LEGEND_PX, (panel.bottom() + BELOW_PX + 6.0).max(380.0)];
    sheet(size, |sheet| {
        let order = upwards(tiles, |force| force.tile.tile.position().z);
        order.iter().try_for_each(|force| forces.body(sheet, force))?;
        order.iter().try_for_each(|force| forces.force(sheet, force))?;
        film_axes(sheet, &panel)?;
        forces.legend(sheet, tiles, is_ordered)
    })
}

/// Draws tiles and forces into a panel.
struct ForcePainter {
    panel: Panel,
    directions: DirectionColours,
    /// The largest force in newtons.
    most_n: f64,
    /// The length of its arrow in pixels.
    arrow_px: f64,
    /// Size of the numbers of steps; `None` if the tiles are too small for them.
    number_px: Option<f64>,
}

impl ForcePainter {
    fn new(tiles: &[DrawnForce], panel: Panel, most_n: f64, arrow_mm: f64) -> ForcePainter {
        let sides = |force: &DrawnForce| force.tile.tile.size().truncate() * panel.px_per_x();
        let narrowest = tiles.iter().map(|force| sides(force).min_element()).fold(f64::INFINITY, f64::min);
        let number_px = NUMBER_PX[0].min(0.5 * narrowest);
        ForcePainter {
            panel,
            directions: DirectionColours::new(),
            most_n,
            arrow_px: arrow_mm * panel.px_per_x(),
            number_px: (number_px >= NUMBER_PX[1]).then_some(number_px),
        }
    }

    /// Draws the outline, filled with the colour of the polarization's direction, and the step.
    fn body(&self, sheet: &Sheet, force: &DrawnForce) -> DrawResult {
        let outline = outline(&self.panel, &force.tile.tile);
        let colour = light(self.directions.colour(force.tile.tile.scene_polarization_t()));
        sheet.shape(&outline, colour, OUTLINE, 0.8)?;
        let (Some(step), Some(size)) = (force.step, self.number_px) else { return Ok(()) };
        let corners = outline.iter().map(|&corner| DVec2::from(corner));
        let corner = corners.fold(DVec2::MAX, DVec2::min);
        let letters = Lettering { along: VPos::Top, colour: OUTLINE, ..LETTERS.sized(size) };
        sheet.text([corner.x + 3.0, corner.y + 2.0], &step.to_string(), letters)
    }

    /// Draws the arrow of the force in the plane, and the mark of the force out of it.
    fn force(&self, sheet: &Sheet, force: &DrawnForce) -> DrawResult {
        if self.most_n == 0.0 {
            return Ok(());
        }
        let colour = if force.force_n.length() >= LARGEST * self.most_n { VERMILION } else { INK };
        let centre = force.tile.tile.position();
        let tail = self.panel.at(centre.x, centre.y);
        let along = force.force_n / self.most_n;
        // y grows upwards in the film and downwards on the sheet.
        let tip = [tail[0] + self.arrow_px * along.x, tail[1] - self.arrow_px * along.y];
        if self.arrow_px * along.truncate().length() >= SHORTEST_PX {
            arrow(sheet, tail, tip, 2.0, colour)?;
        }
        let radius = MARK_PX * along.z.abs().sqrt();
        // The area of the circle is in proportion to the force.
        if radius >= SMALLEST_MARK_PX { out_of_plane_mark(sheet, tail, radius, along.z > 0.0) } else { Ok(()) }
    }

    fn legend(&self, sheet: &Sheet, tiles: &[DrawnForce], is_ordered: bool) -> DrawResult {
        let left = self.panel.right() + 24.0;
        let mut y = TOP_PX + 10.0;
        y = direction_wheel(sheet, &self.directions, light, left, y)? + 40.0;
        let title = if is_ordered { "Force during placement" } else { "Force by all others" };
        sheet.text([left, y], title, LETTERS)?;
        y += 26.0;
        let (size_n, unit) = [(1.0, "N"), (1e-3, "mN"), (1e-6, "\u{b5}N")]
            .into_iter()
            .find(|(size_n, _)| self.most_n >= 0.1 * size_n)
            .unwrap_or((1.0, "N"));
        let said = |force_n: f64| format!("{} {unit}", rounded(force_n / size_n, 2));
        if self.most_n > 0.0 {
            arrow(sheet, [left, y], [left + self.arrow_px, y], 2.0, VERMILION)?;
            sheet.text([left + self.arrow_px + 8.0, y], &said(self.most_n), LETTERS)?;
            y += 20.0;
            sheet.text([left, y], "the largest", LETTERS.sized(12.0))?;
            y += 26.0;
        }
        for (sign, text) in [(1.0, "up"), (-1.0, "down")] {
            let of_sign = |force: &DrawnForce| sign * force.force_n.z;
            let most_n = tiles.iter().map(of_sign).fold(0.0, f64::max);
            let radius = MARK_PX * (most_n / self.most_n).sqrt();
            if self.most_n > 0.0 && radius >= SMALLEST_MARK_PX {
                out_of_plane_mark(sheet, [left + 10.0, y], radius, sign > 0.0)?;
                let text = format!("{text}, {} at most", said(most_n));
                sheet.text([left + 28.0, y], &text, LETTERS.sized(12.0))?;
                y += 26.0;
            }
        }
        if is_ordered {
            let words = if self.number_px.is_some() { "Numbers: steps" } else { "Tiles too small for steps" };
            sheet.text([left, y], words, LETTERS)?;
        }
        Ok(())
    }
}
