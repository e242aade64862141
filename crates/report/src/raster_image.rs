//! Images made of pixels inside a figure, and data URLs.

use base64::prelude::{BASE64_STANDARD, Engine};
use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};

use crate::colours::Rgb;

/// An opaque image.
pub(crate) struct RasterImage(Pixmap);

impl RasterImage {
    /// An image of `width` times `height` pixels, at least 1 by 1. `colour` gives the colour at a
    /// column and a row, with row 0 at the top.
    pub(crate) fn new(width: usize, height: usize, colour: impl Fn(usize, usize) -> Rgb) -> RasterImage {
        let mut pixels = Pixmap::new(width.max(1) as u32, height.max(1) as u32)
            .expect("an image of a figure has a few hundred pixels per side");
        for (index, pixel) in pixels.pixels_mut().iter_mut().enumerate() {
            let [r, g, b] = colour(index % width, index / width);
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).expect("opaque colours are valid");
        }
        RasterImage(pixels)
    }

    /// The image as a data URL with a PNG.
    pub(crate) fn data_url(&self) -> String {
        data_url("image/png", &self.0.encode_png().expect("a small image can be encoded"))
    }
}

/// Bytes as a data URL.
pub(crate) fn data_url(media_type: &str, bytes: &[u8]) -> String {
    format!("data:{media_type};base64,{}", BASE64_STANDARD.encode(bytes))
}
