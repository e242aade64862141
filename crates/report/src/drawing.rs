//! A finished figure.

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Indent, Tree, WriteOptions};

use crate::error::{DrawError, ReportError};
use crate::figures::map_grid::MapGrid;
use crate::pdf;
use crate::sheet::millimetres;
use crate::typeset::{FAMILY, OPTIONS};

/// Resolution of PNG files.
const DOTS_PER_INCH: f64 = 300.0;
/// Pixels of SVG files per inch.
const PX_PER_INCH: f64 = 96.0;
/// Decimals of coordinates in the SVG, in pixels.
const DECIMALS: u8 = 3;

/// The form of text in SVG files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SvgText {
    /// Text, which can be searched and edited. Where Roboto is not installed, a similar font takes
    /// its place.
    #[default]
    Text,
    /// Outlines of Roboto, the same on every machine.
    Outlines,
}

/// A figure as SVG and as PNG, both drawn from the same shapes, and its data as CSV.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Drawing {
    /// Name of its files, without extension.
    pub name: &'static str,
    /// What the figure shows, in one to three sentences.
    pub caption: String,
    /// The SVG. Its size is given in millimetres.
    pub svg: String,
    /// The same as PNG, at 300 dots per inch, which the file states.
    pub png: Vec<u8>,
    /// The numbers that the figure shows, with one header line.
    pub csv: String,
    /// The SVG with text as outlines, for the page.
    pub(crate) outlined: String,
}

/// A figure before its text becomes outlines.
pub(crate) struct FigureDraft {
    pub(crate) name: &'static str,
    pub(crate) caption: String,
    pub(crate) svg: String,
    /// The data behind the figure.
    pub(crate) csv: String,
    /// The maps of which it consists, if it does, for a figure of one component.
    pub(crate) maps: Option<MapGrid>,
}

impl FigureDraft {
    /// The figure of which this SVG was drawn.
    pub(crate) fn new(
        name: &'static str,
        caption: impl Into<String>,
        svg: Result<String, DrawError>,
        csv: String,
    ) -> Result<FigureDraft, ReportError> {
        let svg = svg.map_err(|source| ReportError::Drawing { figure: name, source })?;
        Ok(FigureDraft { name, caption: caption.into(), svg, csv, maps: None })
    }

    /// The figure of these maps.
    pub(crate) fn of_maps(
        name: &'static str,
        caption: impl Into<String>,
        maps: MapGrid,
        csv: String,
    ) -> Result<FigureDraft, ReportError> {
        let draft = FigureDraft::new(name, caption, maps.draw(), csv)?;
        Ok(FigureDraft { maps: Some(maps), ..draft })
    }

    /// The figure as SVG and PNG.
    pub(crate) fn rendered(self, text: SvgText) -> Result<Drawing, ReportError> {
        self.scaled(text, 1.0)
    }

    /// The figure as SVG and PNG, this many times as large.
    pub(crate) fn scaled(self, text: SvgText, scale: f64) -> Result<Drawing, ReportError> {
        let figure = self.name;
        Drawing::new(self, text, scale).map_err(|source| ReportError::Drawing { figure, source })
    }

    /// Width of the sheet in pixels, 96 per inch.
    pub(crate) fn width_px(&self) -> Result<f64, ReportError> {
        let failed = |source: DrawError| ReportError::Drawing { figure: self.name, source };
        let tree = Tree::from_str(&self.svg, &OPTIONS).map_err(|error| failed(error.into()))?;
        Ok(f64::from(tree.size().width()).round())
    }
}

impl Drawing {
    fn new(
        FigureDraft { name, caption, svg, csv, .. }: FigureDraft,
        text: SvgText,
        of_px: f64,
    ) -> Result<Drawing, DrawError> {
        let tree = Tree::from_str(&svg, &OPTIONS)?;
        let written = WriteOptions {
            coordinates_precision: DECIMALS,
            transforms_precision: DECIMALS + 2,
            indent: Indent::None,
            ..WriteOptions::default()
        };
        let size = [tree.size().width(), tree.size().height()].map(|px| f64::from(px).round());
        let scale = of_px * DOTS_PER_INCH / PX_PER_INCH;
        let [width, height] = size.map(|px| (px * scale).ceil() as u32);
        let mut pixels = Pixmap::new(width, height).ok_or("its width or height is 0")?;
        // A fraction of a pixel at the right and at the bottom is not covered by the sheet.
        pixels.fill(Color::WHITE);
        resvg::render(&tree, Transform::from_scale(scale as f32, scale as f32), &mut pixels.as_mut());
        let outlined = sized(&tree.to_string(&written), size, of_px);
        let svg = match text {
            SvgText::Text => with_fallbacks(&resized(&svg, size, of_px)),
            SvgText::Outlines => outlined.clone(),
        };
        Ok(Drawing { name, caption, svg, png: encoded(&pixels)?, csv, outlined })
    }

    /// The heading of the figure on a page.
    pub(crate) fn heading(&self) -> &'static str {
        match self.name {
            "layout" => "The tiles from above",
            "recoil" => "Recoil of the tiles",
            "vectors" => "Field vectors",
            "field-lowest" => "Field on the lowest plane",
            "field-middle" => "Field on the middle plane",
            "field-highest" => "Field on the highest plane",
            "parameters-level" => "Decoupling parameters on planes of constant z",
            "parameters-upright" => "Decoupling parameters on vertical planes",
            "parameters-along-axes" => "Decoupling parameters along their axes",
            "made-displacement" => "Displacement errors of films as made",
            "made-uniformity" => "Uniformity errors of films as made",
            "resolution" => "Resolution of the sensor",
            "experiment" => "Moving the film along each axis",
            name => name,
        }
    }

    /// The figure as PDF of one page of its size, with text as outlines, which need no font.
    ///
    /// # Errors
    /// [`ReportError::Drawing`] if it holds something that has no counterpart.
    pub fn pdf(&self) -> Result<Vec<u8>, ReportError> {
        let failed = |source: DrawError| ReportError::Drawing { figure: self.name, source };
        let tree = Tree::from_str(&self.outlined, &OPTIONS).map_err(|error| failed(error.into()))?;
        pdf::page(&tree).map_err(failed)
    }

    /// Names and contents of the files: SVG, PNG and CSV.
    pub fn files(&self) -> [(String, &[u8]); 3] {
        let named = |ending: &str| format!("{}.{ending}", self.name);
        [(named("svg"), self.svg.as_bytes()), (named("png"), &self.png), (named("csv"), self.csv.as_bytes())]
    }
}

/// The SVG that usvg wrote, with its size in millimetres.
fn sized(svg: &str, [width, height]: [f64; 2], scale: f64) -> String {
    let (head, rest) = svg.split_once('>').unwrap_or((svg, ""));
    let kept =
        head.split(' ').filter(|part| !["width=", "height=", "viewBox="].iter().any(|key| part.starts_with(key)));
    // The four numbers of a view box contain spaces, so a part of them is a number and a quote.
    let kept: Vec<&str> = kept.filter(|part| part.starts_with('<') || part.contains('=')).collect();
    let [across, down] = [width, height].map(|px| millimetres(scale * px));
    format!("{} width=\"{across}mm\" height=\"{down}mm\" viewBox=\"0 0 {width} {height}\">{rest}", kept.join(" "))
}

/// The SVG that was drawn for this size in pixels, this many times as large.
fn resized(svg: &str, size: [f64; 2], scale: f64) -> String {
    let written = |scale: f64| {
        let [width, height] = size.map(|px| millimetres(scale * px));
        format!("width=\"{width}mm\" height=\"{height}mm\"")
    };
    svg.replacen(&written(1.0), &written(scale), 1)
}

/// The SVG with fonts that are similar to Roboto where that is not installed.
fn with_fallbacks(svg: &str) -> String {
    let named = format!("font-family=\"{FAMILY}\"");
    svg.replace(&named, &format!("font-family=\"{FAMILY}, Arial, Helvetica, sans-serif\""))
}

/// The pixels as PNG, with the resolution that the file is meant for.
fn encoded(pixels: &Pixmap) -> Result<Vec<u8>, DrawError> {
    const INCHES_PER_METRE: f64 = 1.0 / 0.0254;
    let per_metre = (DOTS_PER_INCH * INCHES_PER_METRE).round() as u32;
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // Files are half as large again as by default, and a report takes a quarter less time.
    encoder.set_compression(png::Compression::Fast);
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }));
    // Figures are drawn on white paper, so every pixel is opaque.
    let (pixels, _) = pixels.data().as_chunks::<4>();
    let colours: Vec<[u8; 3]> = pixels.iter().map(|[red, green, blue, _]| [*red, *green, *blue]).collect();
    encoder.write_header()?.write_image_data(colours.as_flattened())?;
    Ok(file)
}
