//! Text of figures: symbols with subscripts, numbers on axes, and the font.

use std::ops::RangeInclusive;
use std::sync::Arc;

use resvg::usvg::{Options, fontdb};

/// Names of the coordinate axes.
pub(crate) const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// The family of the fonts in `fonts/`: Roboto, reduced to Latin, Greek, Cyrillic and mathematical
/// characters.
pub(crate) const FAMILY: &str = "Roboto";

const FONTS: [&[u8]; 2] = [include_bytes!("../fonts/Roboto-Regular.ttf"), include_bytes!("../fonts/Roboto-Italic.ttf")];

// plotters has no subscripts. Its texts contain these characters of Unicode's private use area,
// which `marked_up` replaces with elements of the SVG.
const SYMBOL: char = '\u{e000}';
const SUBSCRIPT: char = '\u{e001}';
const END: char = '\u{e002}';

/// A symbol in italics with an upright subscript, such as B_x.
pub(crate) fn symbol(letter: &str, subscript: &str) -> String {
    format!("{SYMBOL}{letter}{SUBSCRIPT}{subscript}{END}")
}

/// A symbol in italics.
pub(crate) fn variable(letter: &str) -> String {
    symbol(letter, "")
}

/// The characters that the fonts have for text: Latin, Greek, Cyrillic, punctuation.
const TEXT_CHARACTERS: [RangeInclusive<char>; 5] =
    [' '..='~', '\u{a0}'..='\u{24f}', '\u{370}'..='\u{3ff}', '\u{400}'..='\u{45f}', '\u{2010}'..='\u{2027}'];

/// Text from a layout, with U+FFFD for each character that the fonts lack. This also replaces the
/// private characters above and control characters, which XML forbids.
pub(crate) fn plain(text: &str) -> String {
    let known = |c: char| TEXT_CHARACTERS.iter().any(|range| range.contains(&c));
    text.chars().map(|c| if known(c) { c } else { '\u{fffd}' }).collect()
}

/// SVG with the private characters replaced with elements.
pub(crate) fn marked_up(svg: &str) -> String {
    svg.replace(SYMBOL, "<tspan font-style=\"italic\">")
        .replace(SUBSCRIPT, "</tspan><tspan font-size=\"72%\" baseline-shift=\"sub\">")
        .replace(END, "</tspan>")
}

/// A number for an axis: at most six significant digits, no trailing zeros, a true minus sign.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs();
    let text = if (1e-3..1e5).contains(&magnitude) {
        let decimals = (5.0 - magnitude.log10().floor()).clamp(0.0, 8.0) as usize;
        let text = format!("{magnitude:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        let text = format!("{magnitude:.3e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{}", digits.trim_end_matches('0').trim_end_matches('.'), power.replace('-', "\u{2212}"))
    };
    if value < 0.0 { format!("\u{2212}{text}") } else { text }
}

/// A number on an axis with this range. A value that is round-off relative to the range is 0.
pub(crate) fn on_axis(value: f64, [low, high]: [f64; 2]) -> String {
    number(if value.abs() <= 1e-9 * (high - low).abs() { 0.0 } else { value })
}

/// Options of resvg with the fonts of this crate only, so that a figure is the same on every
/// machine.
pub(crate) fn options() -> Options<'static> {
    let mut fonts = fontdb::Database::new();
    for font in FONTS {
        fonts.load_font_data(font.to_vec());
    }
    Options { font_family: FAMILY.to_owned(), fontdb: Arc::new(fonts), ..Options::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_true_minus_and_no_trailing_zeros() {
        let texts = [0.0, -2.0, 0.25, 1234.5, 2.5e-7, -1e12, 0.1 + 0.2].map(number);
        assert_eq!(texts, ["0", "\u{2212}2", "0.25", "1234.5", "2.5e\u{2212}7", "\u{2212}1e12", "0.3"]);
    }

    #[test]
    fn private_and_control_characters_in_names_are_replaced() {
        assert_eq!(plain("a\u{e000}b\u{1}\n\u{78c1}ß"), "a\u{fffd}b\u{fffd}\u{fffd}\u{fffd}ß");
    }
}
