//! Colours: readable in print and by the colour-blind.

use colorgrad::{BasisGradient, Color, Gradient, GradientBuilder, preset};
use glam::DVec3;
use plotters::prelude::RGBColor;

pub(crate) type Rgb = [u8; 3];

/// Where there is no value.
pub(crate) const NO_VALUE: Rgb = [190, 190, 190];

/// Width of frames and axes, in pixels.
pub(crate) const INK_LINE: f64 = 1.0;

/// Okabe and Ito's blue and vermilion.
pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const VERMILION: RGBColor = RGBColor(213, 94, 0);

/// A range that reaches this little to the other side of zero, as a fraction of its length, counts as one of one sign.
const OF_ONE_SIGN: f64 = 0.02;

/// Values to colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) kind: Kind,
}

/// What a scale's colours are for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// Surfaces; values of one sign: viridis.
    OneSigned,
    /// Surfaces; values of both signs, zero white: red and blue.
    Signed,
    /// Lines and arrows on white: viridis without its palest part.
    Lines,
}

/// Where the colours for lines end.
const END_OF_LINES: f32 = 0.86;

impl Scale {
    /// The scale for these values: symmetric about zero if they have both signs, else from their least to their most.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Scale {
        let (low, high) = values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Scale { low: 0.0, high: 1.0, kind: Kind::OneSigned };
        }
        let slight = OF_ONE_SIGN * (high - low);
        if low < -slight && high > slight {
            return Scale::symmetric(low.abs().max(high));
        }
        // A constant needs a range too.
        let least_range = 1e-9 * low.abs().max(high.abs());
        if high - low <= least_range {
            let half = if low == 0.0 && high == 0.0 { 1.0 } else { 0.1 * low.abs().max(high.abs()) };
            return Scale { low: low - half, high: high + half, kind: Kind::OneSigned };
        }
        Scale { low, high, kind: Kind::OneSigned }
    }

    /// The scale from the least to the most of values whose zero means nothing, such as logarithms.
    pub(crate) fn without_zero(values: impl Iterator<Item = f64> + Clone) -> Scale {
        let least = values.clone().filter(|v| v.is_finite()).fold(f64::INFINITY, f64::min);
        let shifted = Scale::of(values.map(|v| v - least));
        let (low, high) = (shifted.low + least, shifted.high + least);
        if low < high && high.is_finite() { Scale { low, high, kind: Kind::OneSigned } } else { shifted }
    }

    /// A scale for differences.
    pub(crate) fn symmetric(reach: f64) -> Scale {
        let reach = if reach > 0.0 && reach.is_finite() { reach } else { 1.0 };
        Scale { low: -reach, high: reach, kind: Kind::Signed }
    }

    /// The symmetric scale for these values.
    pub(crate) fn symmetric_of(values: impl Iterator<Item = f64>) -> Scale {
        Scale::symmetric(values.filter(|v| v.is_finite()).fold(0.0, |most, v| most.max(v.abs())))
    }

    /// The colour of every value, from the least to the most.
    pub(crate) fn map(self) -> Map {
        Map(if self.kind == Kind::Signed { preset::rd_bu() } else { preset::viridis() }, self)
    }
}

/// A scale with its colours at hand.
pub(crate) struct Map(BasisGradient, Scale);

impl Map {
    pub(crate) fn colour(&self, value: f64) -> Rgb {
        if !value.is_finite() {
            return NO_VALUE;
        }
        let Scale { low, high, kind } = self.1;
        let t = ((value - low) / (high - low)).clamp(0.0, 1.0) as f32;
        rgb(&self.0.at(match kind {
            Kind::OneSigned => t,
            // From blue for negative values to red for positive ones.
            Kind::Signed => 1.0 - t,
            Kind::Lines => END_OF_LINES * t,
        }))
    }
}

/// 256 colours from one end of a kind of scale to the other, for the page.
pub(crate) fn table(kind: Kind) -> Vec<Rgb> {
    let map = Scale { low: 0.0, high: 255.0, kind }.map();
    (0..256).map(|i| map.colour(f64::from(i))).collect()
}

fn rgb(colour: &Color) -> Rgb {
    let [r, g, b, _] = colour.to_rgba8();
    [r, g, b]
}

/// Colours for the direction of a polarization: a circle through Okabe and Ito's vermilion (+x), yellow (+y), blue (-x) and purple (-y), towards white
/// where it points up and towards black where it points down. Arrows and marks say the same.
pub(crate) struct Directions(BasisGradient);

impl Directions {
    pub(crate) fn new() -> Directions {
        let circle =
            ["#d55e00", "#e8a317", "#f0e442", "#7fb86b", "#0072b2", "#7d7ab8", "#cc79a7", "#d4685a", "#d55e00"];
        Directions(GradientBuilder::new().html_colors(&circle).build().expect("nine valid colours"))
    }

    pub(crate) fn colour(&self, polarization: DVec3) -> Rgb {
        let Some(direction) = polarization.try_normalize() else { return NO_VALUE };
        let turn = (direction.y.atan2(direction.x) / std::f64::consts::TAU).rem_euclid(1.0);
        let colour = rgb(&self.0.at(turn as f32)).map(f64::from);
        let (end, share) = if direction.z > 0.0 { (250.0, direction.z) } else { (70.0, -direction.z) };
        // Steep only towards the vertical: a tile that is slightly tilted keeps the colour of its direction.
        let share = share * share;
        colour.map(|c| (c + (end - c) * share).round() as u8)
    }
}

/// The colour for large surfaces with letters on them.
pub(crate) fn light(colour: Rgb) -> RGBColor {
    let [r, g, b] = colour.map(|c| (f64::from(c) * 0.5 + 255.0 * 0.5).round() as u8);
    RGBColor(r, g, b)
}

pub(crate) fn plot(colour: Rgb) -> RGBColor {
    RGBColor(colour[0], colour[1], colour[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_the_middle_of_a_signed_scale() {
        let scale = Scale::of([-1.0, 0.2, f64::NAN].into_iter());
        assert_eq!(scale, Scale { low: -1.0, high: 1.0, kind: Kind::Signed });
        let map = scale.map();
        let middle = map.colour(0.0);
        assert!(middle.iter().all(|&c| c > 235), "{middle:?}");
        // Blue below zero, red above.
        assert!(map.colour(-1.0)[2] > map.colour(-1.0)[0] && map.colour(1.0)[0] > map.colour(1.0)[2]);
        assert_eq!(map.colour(f64::NAN), NO_VALUE);
    }

    #[test]
    fn constants_and_nothing_have_a_scale() {
        assert_eq!(Scale::of([3.0, 3.0].into_iter()).kind, Kind::OneSigned);
        for values in [vec![], vec![0.0], vec![3.0, 3.0], vec![-2.0]] {
            let scale = Scale::of(values.into_iter());
            assert!(scale.low < scale.high);
        }
        let logarithms = Scale::without_zero([-2.0, 3.0].into_iter());
        assert_eq!(logarithms, Scale { low: -2.0, high: 3.0, kind: Kind::OneSigned });
        for values in [vec![], vec![-7.0], vec![f64::NAN]] {
            let scale = Scale::without_zero(values.into_iter());
            assert!(scale.low < scale.high);
        }
    }
}
