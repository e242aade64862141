//! Text of figures: symbols with subscripts, numbers on axes, and the font.

use std::ops::RangeInclusive;
use std::sync::{Arc, LazyLock};

use resvg::usvg::{Options, fontdb};

/// Names of the coordinate axes.
pub(crate) const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// Names of the decoupling parameters in plain text.
pub(crate) const PARAMETER_NAMES: [&str; 3] = ["R_x", "R_y", "S_z"];

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

/// The symbol of a decoupling parameter, 0 to 2 for R_x, R_y, S_z.
pub(crate) fn parameter(which: usize) -> String {
    symbol(["R", "R", "S"][which], AXIS_NAMES[which])
}

/// The equation of a plane normal to an axis, such as z = -3 mm.
pub(crate) fn plane(normal: usize, at_mm: f64) -> String {
    format!("{} = {} mm", variable(AXIS_NAMES[normal]), number(at_mm))
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

/// SVG with the private characters replaced with elements. A subscript is lowered by `dy`, which
/// all programs know, unlike `baseline-shift`; the letter after it is raised again.
pub(crate) fn marked_up(svg: &str) -> String {
    let svg = svg
        .replace(SYMBOL, "<tspan font-style=\"italic\">")
        .replace(&format!("{SUBSCRIPT}{END}"), "</tspan>")
        .replace(SUBSCRIPT, "</tspan><tspan font-size=\"72%\" dy=\"0.3em\">");
    let mut parts = svg.split(END);
    let mut marked = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        marked += "</tspan>";
        let mut rest = part.chars();
        match rest.next().filter(|_| !part.trim_start().starts_with('<')) {
            // A character reference must not be divided.
            Some('&') => {
                let (reference, rest) = part.split_once(';').unwrap_or((part, ""));
                marked += &format!("<tspan dy=\"-0.216em\">{reference};</tspan>{rest}");
            }
            Some(first) => marked += &format!("<tspan dy=\"-0.216em\">{first}</tspan>{}", rest.as_str()),
            None => marked += part,
        }
    }
    marked
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
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        let power: String = power.chars().map(superscript).collect();
        if digits == "1" { format!("10{power}") } else { format!("{digits} \u{d7} 10{power}") }
    };
    if value < 0.0 { format!("\u{2212}{text}") } else { text }
}

/// A number rounded to this many digits behind the first.
pub(crate) fn rounded(value: f64, digits: usize) -> String {
    number(format!("{value:.digits$e}").parse().unwrap_or(value))
}

/// A number rounded to thousandths.
pub(crate) fn thousandths(value: f64) -> String {
    number((1e3 * value).round() / 1e3)
}

/// A digit or a minus sign as superscript.
fn superscript(c: char) -> char {
    const DIGITS: [char; 10] = [
        '\u{2070}', '\u{b9}', '\u{b2}', '\u{b3}', '\u{2074}', '\u{2075}', '\u{2076}', '\u{2077}', '\u{2078}',
        '\u{2079}',
    ];
    c.to_digit(10).map_or('\u{207b}', |digit| DIGITS[digit as usize])
}

/// Maximum number of decimals on an axis.
const MAX_DECIMALS: usize = 6;

/// The numbers of an axis, all with as many decimals as the one that needs most. A value that is
/// round-off relative to the others is 0.
pub(crate) struct AxisNumbers {
    /// The largest magnitude among the values.
    most: f64,
    /// `None` where powers of ten are shorter.
    decimals: Option<usize>,
}

impl AxisNumbers {
    /// For an axis with these values.
    pub(crate) fn new(values: &[f64]) -> AxisNumbers {
        let most = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let exact = |decimals: &usize| {
            let scale = 10_f64.powi(*decimals as i32);
            values
                .iter()
                .all(|value| (value * scale - (value * scale).round()).abs() <= 1e-6 * (most * scale).max(1e-3))
        };
        let decimals = (0..=MAX_DECIMALS).find(exact).filter(|_| most == 0.0 || (1e-3..1e5).contains(&most));
        AxisNumbers { most, decimals }
    }

    /// The text of one of the values.
    pub(crate) fn text(&self, value: f64) -> String {
        let value = if value.abs() <= 1e-9 * self.most { 0.0 } else { value };
        match self.decimals {
            Some(decimals) => format!("{value:.decimals$}").replace('-', "\u{2212}"),
            None => number(value),
        }
    }
}

/// Options of resvg with the fonts of this crate only, so that a figure is the same on every
/// machine.
pub(crate) static OPTIONS: LazyLock<Options> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    for font in FONTS {
        fonts.load_font_data(font.to_vec());
    }
    Options { font_family: FAMILY.to_owned(), fontdb: Arc::new(fonts), ..Options::default() }
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_true_minus_and_no_trailing_zeros() {
        let texts = [0.0, -2.0, 0.25, 1234.5, 2.5e-7, -1e12, 0.1 + 0.2].map(number);
        let expected =
            ["0", "\u{2212}2", "0.25", "1234.5", "2.5 \u{d7} 10\u{207b}\u{2077}", "\u{2212}10\u{b9}\u{b2}", "0.3"];
        assert_eq!(texts, expected);
    }

    #[test]
    fn numbers_of_an_axis_have_the_same_decimals_and_no_round_off() {
        let texts = |values: &[f64]| -> Vec<String> {
            let numbers = AxisNumbers::new(values);
            values.iter().map(|value| numbers.text(*value)).collect()
        };
        assert_eq!(texts(&[-0.5, -1e-17, 0.5, 1.0]), ["\u{2212}0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(texts(&[-2.0, -0.0, 2.0]), ["\u{2212}2", "0", "2"]);
        assert_eq!(texts(&[0.1 + 0.2, 0.25]), ["0.30", "0.25"]);
        assert_eq!(texts(&[0.0, 2e-7]), ["0", "2 \u{d7} 10\u{207b}\u{2077}"]);
    }

    #[test]
    fn letter_after_a_subscript_is_raised_again() {
        let text = marked_up(&format!("<text>\n{} (mT)\n{}\n</text>", symbol("B", "x"), variable("z")));
        let sub = "<tspan font-style=\"italic\">B</tspan><tspan font-size=\"72%\" dy=\"0.3em\">x</tspan>";
        let z = "<tspan font-style=\"italic\">z</tspan>";
        assert_eq!(text, format!("<text>\n{sub}<tspan dy=\"-0.216em\"> </tspan>(mT)\n{z}\n</text>"));
    }

    #[test]
    fn private_and_control_characters_in_names_are_replaced() {
        assert_eq!(plain("a\u{e000}b\u{1}\n\u{78c1}ß"), "a\u{fffd}b\u{fffd}\u{fffd}\u{fffd}ß");
    }
}
