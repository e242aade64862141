//! The drawing area of a figure, on which plotters draws SVG.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::error::DrawError;
use crate::raster_image::RasterImage;
use crate::typeset;

/// Units of plotters per pixel. plotters rounds coordinates to whole units, so at one unit per
/// pixel lines would be jagged.
const UNITS_PER_PX: f64 = 10.0;

/// Pixels per millimetre at 96 pixels per inch.
pub(crate) const PX_PER_MM: f64 = 96.0 / 25.4;

/// plotters divides a font size by this factor when it writes SVG.
const FONT_SIZE_WRITTEN: f64 = 1.24;

/// The colour of text, frames and axes.
pub(crate) const INK: RGBColor = RGBColor(30, 30, 30);
/// Width of frames and axes, in pixels.
pub(crate) const FRAME_PX: f64 = 1.0;

/// Pixels as units of plotters.
pub(crate) fn units(px: f64) -> i32 {
    (px * UNITS_PER_PX).round() as i32
}

/// Pixels in millimetres, to the micrometre.
pub(crate) fn millimetres(px: f64) -> f64 {
    (px / PX_PER_MM * 1e3).round() / 1e3
}

/// An error of plotters.
pub(crate) type PlotError = DrawingAreaErrorKind<std::io::Error>;

/// The result of drawing something.
pub(crate) type DrawResult = Result<(), PlotError>;

/// A drawing area. Positions are in pixels from its upper left corner, 96 per inch.
pub(crate) struct Sheet<'a> {
    pub(crate) area: DrawingArea<SVGBackend<'a>, Shift>,
    /// SVG elements of images, drawn below everything else.
    images: String,
}

/// Size, colour and alignment of a text relative to its position.
#[derive(Clone, Copy)]
pub(crate) struct Lettering {
    /// Size of the font, in pixels.
    pub(crate) size: f64,
    pub(crate) across: HPos,
    pub(crate) along: VPos,
    /// Whether the text runs upwards.
    pub(crate) upright: bool,
    pub(crate) colour: RGBColor,
}

/// Size of the heading above all maps, in pixels: no text is larger.
pub(crate) const HEADING_PX: f64 = 14.0;

/// Text to the right of its position, vertically centred.
pub(crate) const LETTERS: Lettering =
    Lettering { size: 13.0, across: HPos::Left, along: VPos::Center, upright: false, colour: INK };

impl Lettering {
    pub(crate) fn sized(self, size: f64) -> Lettering {
        Lettering { size, ..self }
    }

    pub(crate) fn centred(self) -> Lettering {
        Lettering { across: HPos::Center, ..self }
    }

    pub(crate) fn style<'b>(self) -> TextStyle<'b> {
        let transform = if self.upright { FontTransform::Rotate270 } else { FontTransform::None };
        let size = self.size * UNITS_PER_PX * FONT_SIZE_WRITTEN;
        let font = FontDesc::new(FontFamily::Name(typeset::FAMILY), size, FontStyle::Normal).transform(transform);
        TextStyle { font, color: self.colour.to_backend_color(), pos: Pos::new(self.across, self.along) }
    }
}

/// The SVG of what `draw` draws on a sheet of this width and height in pixels. Its text is still
/// text.
pub(crate) fn sheet(size: [f64; 2], draw: impl FnOnce(&mut Sheet) -> DrawResult) -> Result<String, DrawError> {
    // Whole pixels, so that PNG and SVG have the same extent.
    let [width, height] = size.map(f64::ceil);
    let mut drawn = String::new();
    let size = (units(width) as u32, units(height) as u32);
    let images = {
        let area = SVGBackend::with_string(&mut drawn, size).into_drawing_area();
        let mut sheet = Sheet { area, images: String::new() };
        draw(&mut sheet)?;
        sheet.area.present()?;
        sheet.images
    };
    let [across, down] = [width, height].map(millimetres);
    let elements = drawn.split_once('\n').map_or("", |(_, elements)| elements);
    let head = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{across}mm\" height=\"{down}mm\" viewBox=\"0 0 {} {}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        size.0, size.1
    );
    Ok(head + &images + &typeset::marked_up(elements))
}

impl Sheet<'_> {
    /// Draws an image below everything else.
    pub(crate) fn image(&mut self, [left, top, width, height]: [f64; 4], image: &RasterImage) {
        self.images += &format!(
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" image-rendering=\"smooth\" href=\"{}\"/>\n",
            units(left),
            units(top),
            units(width),
            units(height),
            image.data_url()
        );
    }

    /// Draws a text.
    pub(crate) fn text(&self, at: [f64; 2], text: &str, letters: Lettering) -> DrawResult {
        self.area.draw_text(text, &letters.style(), whole(at))
    }

    /// Fills a polygon.
    pub(crate) fn fill(&self, corners: &[[f64; 2]], colour: RGBColor) -> DrawResult {
        self.area.draw(&Polygon::new(corners.iter().copied().map(whole).collect::<Vec<_>>(), colour.filled()))
    }

    /// Draws a line through these points.
    pub(crate) fn line(&self, points: &[[f64; 2]], colour: RGBColor, width: f64) -> DrawResult {
        let style = colour.stroke_width(units(width) as u32);
        self.area.draw(&PathElement::new(points.iter().copied().map(whole).collect::<Vec<_>>(), style))
    }

    /// Draws the closed outline of a polygon.
    pub(crate) fn outline(&self, corners: &[[f64; 2]], colour: RGBColor, width: f64) -> DrawResult {
        let closed: Vec<[f64; 2]> = corners.iter().chain(corners.first()).copied().collect();
        self.line(&closed, colour, width)
    }

    /// Fills a polygon and draws its outline.
    pub(crate) fn shape(&self, corners: &[[f64; 2]], fill: RGBColor, line: RGBColor, width: f64) -> DrawResult {
        self.fill(corners, fill)?;
        self.outline(corners, line, width)
    }

    /// Draws the closed outline of a polygon in dashes.
    pub(crate) fn dashed_outline(&self, corners: &[[f64; 2]], colour: RGBColor, width: f64) -> DrawResult {
        const DASH_PX: f64 = 5.0;
        for (index, from) in corners.iter().enumerate() {
            let to = corners[(index + 1) % corners.len()];
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            // An odd number of pieces, so that each side begins and ends with a dash.
            let pieces = 2 * (length / DASH_PX / 2.0).floor() as usize + 1;
            let at = |piece: usize| {
                let t = piece as f64 / pieces as f64;
                [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])]
            };
            for piece in (0..pieces).step_by(2) {
                self.line(&[at(piece), at(piece + 1)], colour, width)?;
            }
        }
        Ok(())
    }

    /// Draws a filled circle.
    pub(crate) fn disc(&self, centre: [f64; 2], radius: f64, colour: RGBColor) -> DrawResult {
        self.area.draw(&Circle::new(whole(centre), units(radius), colour.filled()))
    }

    /// Draws the outline of a circle.
    pub(crate) fn ring(&self, centre: [f64; 2], radius: f64, colour: RGBColor, width: f64) -> DrawResult {
        self.area.draw(&Circle::new(whole(centre), units(radius), colour.stroke_width(units(width) as u32)))
    }
}

/// The corners of the rectangle between two opposite corners.
pub(crate) fn rectangle([left, top]: [f64; 2], [right, bottom]: [f64; 2]) -> [[f64; 2]; 4] {
    [[left, top], [right, top], [right, bottom], [left, bottom]]
}

fn whole([x, y]: [f64; 2]) -> (i32, i32) {
    (units(x), units(y))
}
