//! Colours that are readable in print and by colour-blind readers: scales for values, a colour
//! circle for directions.

use colorgrad::{BasisGradient, Color, Gradient, GradientBuilder, preset};
use glam::DVec3;
use plotters::prelude::RGBColor;

/// Red, green, blue.
pub(crate) type Rgb = [u8; 3];

/// The colour where there is no value.
pub(crate) const NO_VALUE: Rgb = [190, 190, 190];

/// Blue of the palette of Okabe and Ito.
pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
/// Vermilion of the palette of Okabe and Ito.
pub(crate) const VERMILION: RGBColor = RGBColor(213, 94, 0);

/// Bluish green of the palette of Okabe and Ito.
pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);

/// Values count as of one sign if they reach at most this fraction of their range beyond zero.
const ONE_SIGN_TOLERANCE: f64 = 0.02;

/// A range of values and the palette that shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColourScale {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) palette: Palette,
}

/// A palette, chosen by what is coloured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Palette {
    /// Surfaces with values of one sign: viridis.
    Sequential,
    /// Surfaces with values of both signs: blue below zero, white at zero, red above.
    Diverging,
    /// Lines and arrows on white: viridis without its palest colours.
    Lines,
}

/// The fraction of viridis that [`Palette::Lines`] uses.
const LINES_FRACTION: f32 = 0.86;

impl ColourScale {
    /// The scale for a range of values whose zero has a meaning: the diverging scale for both
    /// signs. Values of one sign get all colours of the sequential scale, from zero, or from the
    /// value nearest to zero if it is more than half the value at the other end. The range may be
    /// empty.
    pub(crate) fn signed([low, high]: [f64; 2]) -> ColourScale {
        let [least, most] = [low, high];
        let (low, high) = if low <= high { (low.min(0.0), high.max(0.0)) } else { (0.0, 0.0) };
        let slight = ONE_SIGN_TOLERANCE * (high - low);
        match (-low > slight, high > slight) {
            (false, true) => ColourScale::without_zero([if least > 0.5 * high { least } else { 0.0 }, high]),
            (true, false) => ColourScale::without_zero([low, if most < 0.5 * low { most } else { 0.0 }]),
            _ => ColourScale::symmetric(high.max(-low)),
        }
    }

    /// The sequential scale for a range of values whose zero has no meaning, such as logarithms.
    /// The range may be empty.
    pub(crate) fn without_zero([low, high]: [f64; 2]) -> ColourScale {
        if low > high {
            return ColourScale { low: 0.0, high: 1.0, palette: Palette::Sequential };
        }
        // A constant also needs a range.
        let most = low.abs().max(high.abs());
        let half = if high - low > 1e-9 * most { 0.0 } else { (0.1 * most).max(f64::MIN_POSITIVE.sqrt()) };
        ColourScale { low: low - half, high: high + half, palette: Palette::Sequential }
    }

    /// The diverging scale from `-reach` to `reach`, or to 1 if `reach` is not a positive number.
    fn symmetric(reach: f64) -> ColourScale {
        let reach = if reach > 0.0 && reach.is_finite() { reach } else { 1.0 };
        ColourScale { low: -reach, high: reach, palette: Palette::Diverging }
    }

    /// The function from values to colours.
    pub(crate) fn mapper(self) -> ColourMapper {
        ColourMapper(if self.palette == Palette::Diverging { preset::rd_bu() } else { preset::viridis() }, self)
    }
}

/// A colour scale with its gradient prepared.
pub(crate) struct ColourMapper(BasisGradient, ColourScale);

impl ColourMapper {
    pub(crate) fn colour(&self, value: f64) -> Rgb {
        if !value.is_finite() {
            return NO_VALUE;
        }
        let ColourScale { low, high, palette } = self.1;
        let t = match palette {
            Palette::Sequential | Palette::Lines => (value - low) / (high - low),
            Palette::Diverging => 0.5 + 0.5 * value / high.max(-low),
        };
        let t = t.clamp(0.0, 1.0) as f32;
        rgb(&self.0.at(match palette {
            Palette::Sequential => t,
            // From blue for negative values to red for positive ones.
            Palette::Diverging => 1.0 - t,
            Palette::Lines => LINES_FRACTION * t,
        }))
    }
}

/// 256 colours from one end of a palette to the other, for the page.
pub(crate) fn colour_table(palette: Palette) -> Vec<Rgb> {
    let map = ColourScale { low: -127.5, high: 127.5, palette }.mapper();
    (0..256).map(|i| map.colour(f64::from(i) - 127.5)).collect()
}

fn rgb(colour: &Color) -> Rgb {
    let [r, g, b, _] = colour.to_rgba8();
    [r, g, b]
}

/// Colours for the direction of a polarization. In the plane it is a circle through vermilion (+x),
/// yellow (+y), blue (-x) and purple (-y) of the palette of Okabe and Ito. A direction that points
/// up is whiter, one that points down is darker. Arrows and marks show the same directions.
pub(crate) struct DirectionColours(BasisGradient);

impl DirectionColours {
    pub(crate) fn new() -> DirectionColours {
        let circle =
            ["#d55e00", "#e8a317", "#f0e442", "#7fb86b", "#0072b2", "#7d7ab8", "#cc79a7", "#d4685a", "#d55e00"];
        DirectionColours(GradientBuilder::new().html_colors(&circle).build().expect("nine valid colours"))
    }

    pub(crate) fn colour(&self, polarization: DVec3) -> Rgb {
        let Some(direction) = polarization.try_normalize() else { return NO_VALUE };
        let turn = (direction.y.atan2(direction.x) / std::f64::consts::TAU).rem_euclid(1.0);
        let colour = rgb(&self.0.at(turn as f32)).map(f64::from);
        let (end, share) = if direction.z > 0.0 { (250.0, direction.z) } else { (70.0, -direction.z) };
        // Squared, so that a slightly tilted polarization keeps the colour of its direction.
        let share = share * share;
        colour.map(|c| (c + (end - c) * share).round() as u8)
    }
}

/// The colours of tiles in figures, by the directions of their polarizations: red, green and blue
/// from 0 to 255.
pub fn tile_colours(polarizations: impl IntoIterator<Item = DVec3>) -> Vec<[u8; 3]> {
    let directions = DirectionColours::new();
    let colour = |polarization| light(directions.colour(polarization));
    polarizations.into_iter().map(colour).map(|RGBColor(r, g, b)| [r, g, b]).collect()
}

/// A paler colour, for large surfaces that carry text.
pub(crate) fn light(colour: Rgb) -> RGBColor {
    let [r, g, b] = colour.map(|c| (f64::from(c) * 0.5 + 255.0 * 0.5).round() as u8);
    RGBColor(r, g, b)
}

/// The same colour as a type of plotters.
pub(crate) fn plotters_colour(colour: Rgb) -> RGBColor {
    RGBColor(colour[0], colour[1], colour[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_both_signs_get_a_diverging_scale_with_white_at_zero() {
        let scale = ColourScale::signed([-1.0, 0.2]);
        assert_eq!(scale, ColourScale { low: -1.0, high: 1.0, palette: Palette::Diverging });
        let map = scale.mapper();
        let middle = map.colour(0.0);
        assert!(middle.iter().all(|&c| c > 235), "{middle:?}");
        // Blue below zero, red above.
        assert!(map.colour(-1.0)[2] > map.colour(-1.0)[0] && map.colour(1.0)[0] > map.colour(1.0)[2]);
        assert_eq!(map.colour(f64::NAN), NO_VALUE);
        // Values of one sign have all colours, from zero or from the value nearest to it.
        for (range, [low, high]) in [([0.3, 1.0], [0.0, 1.0]), ([0.8, 1.0], [0.8, 1.0]), ([-1.0, -0.1], [-1.0, 0.0])] {
            assert_eq!(ColourScale::signed(range), ColourScale { low, high, palette: Palette::Sequential });
        }
        assert_eq!(ColourScale::signed([0.0, 0.0]), ColourScale::symmetric(1.0));
    }

    #[test]
    fn constants_and_missing_values_get_a_scale_of_positive_length() {
        for range in [[f64::INFINITY, f64::NEG_INFINITY], [0.0, 0.0], [3.0, 3.0], [-2.0, -2.0]] {
            for scale in [ColourScale::signed(range), ColourScale::without_zero(range)] {
                assert!(scale.low < scale.high, "{range:?}: {scale:?}");
            }
        }
        let logarithms = ColourScale::without_zero([-2.0, 3.0]);
        assert_eq!(logarithms, ColourScale { low: -2.0, high: 3.0, palette: Palette::Sequential });
    }
}
