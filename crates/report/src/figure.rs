//! A finished figure.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Indent, Options, Tree, WriteOptions};

/// PNGs have so many pixels for one of the SVG: 288 to the inch.
const PNG_SCALE: f32 = 3.0;
/// Decimals of coordinates in pixels.
const DECIMALS: u8 = 3;

/// A figure as SVG and as PNG, drawn from the same shapes.
pub struct Figure {
    /// Name of its files, without ending.
    pub name: String,
    /// What it shows, in a sentence.
    pub caption: String,
    /// SVG, its letters as outlines.
    pub svg: String,
    /// PNG of the same.
    pub png: Vec<u8>,
}

impl Figure {
    /// From SVG with letters as text.
    pub(crate) fn new(name: &str, caption: String, svg: &str, options: &Options) -> Result<Figure, String> {
        let tree = Tree::from_str(svg, options).map_err(|e| e.to_string())?;
        let written = WriteOptions {
            coordinates_precision: DECIMALS,
            transforms_precision: DECIMALS + 2,
            indent: Indent::None,
            ..WriteOptions::default()
        };
        let [width, height] = [tree.size().width(), tree.size().height()].map(|px| (px * PNG_SCALE).ceil() as u32);
        let mut pixels = Pixmap::new(width, height).ok_or("a figure of no size")?;
        resvg::render(&tree, Transform::from_scale(PNG_SCALE, PNG_SCALE), &mut pixels.as_mut());
        let png = pixels.encode_png().map_err(|e| e.to_string())?;
        Ok(Figure { name: name.to_owned(), caption, svg: tree.to_string(&written), png })
    }
}
