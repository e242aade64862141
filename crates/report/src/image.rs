//! Images made of pixels, within a figure.

use base64::prelude::{BASE64_STANDARD, Engine};
use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};

use crate::colours::Rgb;

pub(crate) struct Image(Pixmap);

impl Image {
    /// An image of `width` times `height` pixels; `colour` of column and row, the first row at the top. At least one of each.
    pub(crate) fn new(width: usize, height: usize, colour: impl Fn(usize, usize) -> Rgb) -> Image {
        let mut pixels = Pixmap::new(width.max(1) as u32, height.max(1) as u32).expect("a few hundred pixels a side");
        for (index, pixel) in pixels.pixels_mut().iter_mut().enumerate() {
            let [r, g, b] = colour(index % width, index / width);
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).expect("opaque colours are valid");
        }
        Image(pixels)
    }

    pub(crate) fn data_url(&self) -> String {
        data_url("image/png", &self.0.encode_png().expect("a small image can be encoded"))
    }
}

/// Bytes as an address that needs no file.
pub(crate) fn data_url(media_type: &str, bytes: &[u8]) -> String {
    format!("data:{media_type};base64,{}", BASE64_STANDARD.encode(bytes))
}
