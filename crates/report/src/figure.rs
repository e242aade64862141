//! A finished figure.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Indent, Options, Tree, WriteOptions};

use crate::error::DrawError;

/// Pixels of the PNG per pixel of the SVG. 3 gives 288 dots per inch.
const PNG_SCALE: f32 = 3.0;
/// Decimals of coordinates in the SVG, in pixels.
const DECIMALS: u8 = 3;

/// A figure as SVG and as PNG, both drawn from the same shapes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Figure {
    /// Name of its files, without extension.
    pub name: &'static str,
    /// What the figure shows, in one to three sentences.
    pub caption: String,
    /// The SVG, with text as outlines, at 96 pixels per inch.
    pub svg: String,
    /// The same as PNG, at 288 pixels per inch.
    pub png: Vec<u8>,
}

impl Figure {
    /// A figure from SVG whose text is still text.
    pub(crate) fn new(name: &'static str, caption: String, svg: &str, options: &Options) -> Result<Figure, DrawError> {
        let tree = Tree::from_str(svg, options)?;
        let written = WriteOptions {
            coordinates_precision: DECIMALS,
            transforms_precision: DECIMALS + 2,
            indent: Indent::None,
            ..WriteOptions::default()
        };
        let [width, height] = [tree.size().width(), tree.size().height()].map(|px| (px * PNG_SCALE).ceil() as u32);
        let mut pixels = Pixmap::new(width, height).ok_or("its width or height is 0")?;
        resvg::render(&tree, Transform::from_scale(PNG_SCALE, PNG_SCALE), &mut pixels.as_mut());
        let png = pixels.encode_png()?;
        Ok(Figure { name, caption, svg: tree.to_string(&written), png })
    }
}
