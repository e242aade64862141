//! The tiles that a scan finds faulty, and its resolution for each tile.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use magsplice::layout::{Layout, NamedTile};
use magsplice::results::{FaultyTile, FilmDiagnosis};
use magsplice::scan::{DetectedError, ErrorKind};
use plotters::prelude::RGBColor;

use crate::colours::{BLUE, ColourScale, GREEN, Palette, VERMILION, plotters_colour};
use crate::csv::quoted;
use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::{DrawError, ReportError};
use crate::marks::arrow;
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, Panel};
use crate::sheet::{DrawResult, INK, LETTERS, Lettering, Sheet, sheet};
use crate::typeset::plain;

use super::film_panel::{film_axes, outline, two_panels};
use super::tile_annotations::Rectangle;

const ROOM_PX: [f64; 2] = [380.0, 380.0];
/// Distance of the panels from the upper side of the sheet, and from each other.
const TOP_AND_GAP_PX: [f64; 2] = [30.0, 30.0];
/// Empty space around the tiles, as a fraction of the longer side.
const MARGIN: f64 = 0.04;
const LINE_PX: f64 = 18.0;
/// Most errors that are listed below the tiles.
const MOST_LINES: usize = 16;
/// Length of the arrow of a shift, in pixels.
const SHIFT_PX: f64 = 30.0;
/// Largest radius of the arc of a turn, in pixels.
const MOST_ARC_PX: f64 = 11.0;
/// Width of a letter over its size.
const LETTER_WIDTH: f64 = 0.6;
/// Angle that the arc of a turn covers, in radians.
const ARC: f64 = 1.5 * PI;
/// Purple of the palette of Okabe and Ito.
const PURPLE: RGBColor = RGBColor(170, 80, 130);
const PALE: RGBColor = RGBColor(240, 240, 240);
const OUTLINE: RGBColor = RGBColor(150, 150, 150);

/// The fault of a tile.
#[derive(Clone, Debug, PartialEq)]
struct DrawnFault {
    kind: ErrorKind,
    /// What is wrong, as in the result.
    words: String,
    /// Error of |J| as a fraction; rotation vector in degrees; angles of J in the plane of the film
    /// and out of it, in degrees; displacement in mm.
    components: DVec3,
}

/// A tile as a scan tells it.
#[derive(Clone, Debug, PartialEq)]
struct DiagnosedTile<'a> {
    /// The tile as ordered.
    tile: &'a NamedTile,
    /// Its faults.
    faults: Vec<DrawnFault>,
    /// The largest standard deviation of its errors after the scan, over that before it, but for
    /// turns about J.
    unresolved: f64,
}

impl DrawnFault {
    fn new(detected: &DetectedError, words: &str) -> DrawnFault {
        let kind = detected.candidate.kind;
        let mut components = DVec3::ZERO;
        for (axis, of) in detected.components.iter().enumerate() {
            let is_noise = !of.is_significant() && detected.components.len() > 1;
            components[axis] = if is_noise { 0.0 } else { of.value };
        }
        let is_angle = matches!(kind, ErrorKind::Turn | ErrorKind::Direction);
        let words = words.to_owned();
        DrawnFault { kind, words, components: if is_angle { components.map(f64::to_degrees) } else { components } }
    }
}

impl DrawnFault {
    fn colour(&self) -> RGBColor {
        match self.kind {
            ErrorKind::Strength => GREEN,
            ErrorKind::Turn => VERMILION,
            ErrorKind::Direction => PURPLE,
            _ => BLUE,
        }
    }
}

/// The tiles from above: those that are wrong with a mark for what is wrong, and beside them how
/// much the scan tells of each tile.
///
/// # Errors
/// [`ReportError::Drawing`] if it cannot be drawn.
pub fn diagnosis_figure(layout: &Layout, found: &FilmDiagnosis) -> Result<Drawing, ReportError> {
    let caption = "The tiles from above. Left: faulty tiles, with an arrow for a displacement, an arc for a \
                   turn, and a percentage for the strength. Right: the largest standard deviation of the errors of each \
                   tile after the scan, divided by their standard deviation before it, without turns about J. At 1 the scan \
                   resolves nothing.";
    // Errors that are not reported are not drawn.
    let listed = if found.is_rejected { &[][..] } else { &found.diagnosis.detected };
    let fault = |(of, reported): (&DetectedError, &FaultyTile)| DrawnFault::new(of, &reported.words);
    let faults_of = |index: usize| listed.iter().zip(&found.faulty).filter(move |(of, _)| of.candidate.tile == index);
    let tile = |(index, tile)| DiagnosedTile {
        tile,
        faults: faults_of(index).map(fault).collect(),
        unresolved: found.unresolved_share(layout, index),
    };
    let tiles: Vec<DiagnosedTile> = layout.tiles.iter().enumerate().map(tile).collect();
    FigureDraft::new("diagnosis", caption, svg(&tiles, found.is_rejected), csv(&tiles))?.rendered(SvgText::Text)
}

fn svg(tiles: &[DiagnosedTile], is_rejected: bool) -> Result<String, DrawError> {
    let [left, right] = two_panels(tiles.iter().map(|of| &of.tile.tile), ROOM_PX, TOP_AND_GAP_PX, MARGIN);
    let list = listed(tiles, is_rejected);
    let below = left.bottom() + BELOW_PX + 14.0;
    sheet([right.right() + 12.0 + BAR_PX, below + LINE_PX * list.len() as f64 + 6.0], |sheet| {
        left.title(sheet, 0, "faulty tiles")?;
        right.title(sheet, 1, "resolution of the scan for each tile")?;
        let scale = ColourScale { low: 0.0, high: 1.0, palette: Palette::Sequential };
        let map = scale.mapper();
        for of in tiles {
            let fault = of.faults.first().map_or(PALE, |fault| pale(fault.colour()));
            for (panel, colour) in [(&left, fault), (&right, plotters_colour(map.colour(of.unresolved)))] {
                sheet.shape(&outline(panel, &of.tile.tile), colour, OUTLINE, 0.7)?;
            }
        }
        // Marks reach over neighbours, so they come last.
        for of in tiles {
            for fault in &of.faults {
                mark(sheet, &left, of.tile, fault)?;
            }
        }
        film_axes(sheet, &left)?;
        right.axes(sheet, AxisLabel::Coordinate("x"), AxisLabel::TicksOnly)?;
        right.colour_bar(sheet, 12.0, scale, "\u{3c3} after / before the scan")?;
        for (row, (text, colour)) in list.iter().enumerate() {
            let at = [left.left, below + LINE_PX * row as f64];
            sheet.text(at, text, Lettering { colour: *colour, ..LETTERS })?;
        }
        Ok(())
    })
}

/// A line for each error, with its colour.
fn listed(tiles: &[DiagnosedTile], is_rejected: bool) -> Vec<(String, RGBColor)> {
    let all: Vec<(String, RGBColor)> = tiles
        .iter()
        .flat_map(|of| {
            let line =
                |fault: &DrawnFault| (format!("{}: {}", plain(&of.tile.name), plain(&fault.words)), fault.colour());
            of.faults.iter().map(line).collect::<Vec<_>>()
        })
        .collect();
    let more = all.len().saturating_sub(MOST_LINES);
    let mut lines: Vec<(String, RGBColor)> = all.into_iter().take(MOST_LINES).collect();
    match lines.len() {
        0 if is_rejected => lines.push(("Rejected: no tile is reported.".to_owned(), INK)),
        0 => lines.push(("No tile has more than its expected errors.".to_owned(), INK)),
        _ if more > 0 => lines.push((format!("and {more} more"), INK)),
        _ => (),
    }
    lines
}

/// The mark for the fault of a tile.
fn mark(sheet: &Sheet, panel: &Panel, named: &NamedTile, fault: &DrawnFault) -> DrawResult {
    let outline = outline(panel, &named.tile);
    sheet.outline(&outline, fault.colour(), 2.0)?;
    let around = Rectangle::of_points(outline.into_iter().map(DVec2::from));
    let (middle, extent) = (around.middle(), around.size());
    let radius = (0.4 * extent.min_element()).clamp(5.0, MOST_ARC_PX);
    let DVec3 { x: error, z: along_z, .. } = fault.components;
    let shift = fault.components.truncate();
    match fault.kind {
        ErrorKind::Strength => {
            let sign = if error < 0.0 { "\u{2212}" } else { "+" };
            // A tile that has lost more than all of its strength is reversed.
            let is_reversed = error < -1.0;
            let text = if is_reversed { "reversed".to_owned() } else { format!("{sign}{:.0}%", 100.0 * error.abs()) };
            let upright = extent.x < extent.y && extent.x < 30.0;
            let along = extent.max_element() / (LETTER_WIDTH * text.chars().count() as f64);
            let size = along.min(0.7 * extent.min_element()).clamp(6.0, 12.0);
            let letters = Lettering { upright, colour: fault.colour(), ..LETTERS.sized(size).centred() };
            sheet.text(middle.to_array(), &text, letters)
        }
        ErrorKind::Turn => arc(sheet, middle, radius, along_z < 0.0, fault.colour()),
        ErrorKind::Direction => arc(sheet, middle, radius, error < 0.0, fault.colour()),
        _ => match shift.try_normalize() {
            Some(along) if shift.length() > 0.5 * along_z.abs() => {
                let step = 0.5 * SHIFT_PX * DVec2::new(along.x, -along.y);
                arrow(sheet, (middle - step).to_array(), (middle + step).to_array(), 3.0, fault.colour())
            }
            // Along z: a disc, which no other mark is.
            _ => sheet.disc(middle.to_array(), 4.0, fault.colour()),
        },
    }
}

/// An arc with a head, clockwise or not.
fn arc(sheet: &Sheet, middle: DVec2, radius: f64, clockwise: bool, colour: RGBColor) -> DrawResult {
    let sign = if clockwise { 1.0 } else { -1.0 };
    let at = |share: f64| middle + radius * DVec2::from_angle(sign * (share * ARC - 0.25 * PI));
    let points: Vec<[f64; 2]> = (0..=24).map(|n| at(f64::from(n) / 24.0).to_array()).collect();
    sheet.line(&points, colour, 1.8)?;
    let (from, tip) = (at(0.94), at(1.0));
    let along = (tip - from).normalize();
    let across = along.perp();
    let head = [tip + 5.0 * along, tip - 1.5 * along + 4.0 * across, tip - 1.5 * along - 4.0 * across];
    sheet.fill(&head.map(|corner| corner.to_array()), colour)
}

/// The same colour on paper, for surfaces.
fn pale(colour: RGBColor) -> RGBColor {
    let mixed = |value: u8| 255 - (255 - value) / 4;
    RGBColor(mixed(colour.0), mixed(colour.1), mixed(colour.2))
}

fn csv(tiles: &[DiagnosedTile]) -> String {
    let mut csv = "name,faulty,unresolved\n".to_owned();
    for of in tiles {
        let faults: Vec<String> = of.faults.iter().map(|fault| fault.words.clone()).collect();
        csv += &format!("{},\"{}\",{:?}\n", quoted(&of.tile.name), faults.join("; "), of.unresolved);
    }
    csv
}
