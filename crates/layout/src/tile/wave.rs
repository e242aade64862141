//! A sinusoidal magnetization in slices.

use std::f64::consts::{PI, TAU};

use magsplice_magnet::Axis;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{FINITE, POSITIVE, TableFaults};
use crate::tile::interval::Interval;

/// Fewest slices of a wavelength: fewer have no fundamental wave, or one at any phase.
const LEAST_SLICES: usize = 3;

/// Most slices of a wavelength. Their error is below round-off a third of a wavelength away.
const MOST_SLICES: usize = 100;

/// Difference of a length from a whole number of slices, in slices: decimal lengths are not exact.
const WHOLE: f64 = 1e-6;

/// Share of the amplitude below which a slice has no polarization: sines of multiples of pi.
const NONE: f64 = 1e-12;

/// The axes along which waves are possible.
const AXES: [Axis; 2] = [Axis::X, Axis::Y];

/// The direction of a sinusoidal magnetization.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Direction {
    /// (sin kx, sin ky, 0), as the ideal film of Dai 2024, Eq. 1.
    InPlane,
    /// (0, 0, cos kx + cos ky).
    Upright,
    /// The sum of both: its field is below the film, and hardly above it.
    OneSided,
}

/// A sinusoidal magnetization along x, along y or the sum of both, in slices.
#[derive(Clone, Deserialize, JsonSchema, Serialize)]
#[schemars(extend("example" = "{ wavelength_mm = 10.0, slices = 8, direction = \"in-plane\", length_mm = [20.0, 20.0] }"))]
pub(crate) struct WaveTable {
    /// Wavelength, in mm.
    pub(crate) wavelength_mm: f64,
    /// Number of slices of a wavelength: 3 to 100.
    pub(crate) slices: usize,
    /// Direction of the magnetization: in-plane, upright, or one-sided, which is both.
    direction: Direction,
    /// Lengths of the film along x and y, in mm: whole numbers of slices along the waves.
    #[schemars(extend("example" = "[20.0, 20.0]"))]
    length_mm: [f64; 2],
    /// Axes of the waves. Default: ["x", "y"].
    axes: Option<Vec<Axis>>,
    /// Phase at the origin of the layout, in degrees, which is added to kx and ky. Default: 0.
    #[serde(default)]
    phase_deg: f64,
}

impl WaveTable {
    /// Adds the rules that it breaks.
    pub(crate) fn check(&self, faults: &mut TableFaults) {
        let before = faults.count();
        faults.number("wave.wavelength_mm", self.wavelength_mm, POSITIVE);
        let rule = format_args!("must be a whole number from {LEAST_SLICES} to {MOST_SLICES}");
        faults.require((LEAST_SLICES..=MOST_SLICES).contains(&self.slices), "wave.slices", self.slices, rule);
        faults.numbers("wave.length_mm", &self.length_mm, POSITIVE);
        faults.number("wave.phase_deg", self.phase_deg, FINITE);
        let axes = self.axes();
        if axes.is_empty() || axes.len() > 2 || axes.contains(&Axis::Z) || axes.len() == 2 && axes[0] == axes[1] {
            faults.add("wave.axes must be [\"x\"], [\"y\"] or [\"x\", \"y\"]");
        }
        let slice_mm = self.slice_mm();
        for axis in axes.iter().filter(|_| faults.count() == before) {
            let length_mm = self.length_mm[axis.index()];
            let slices = length_mm / slice_mm;
            if (slices - slices.round()).abs() > WHOLE * slices.max(1.0) || slices < 0.5 {
                let rule = format!("must be a whole number of slices of {slice_mm} mm");
                faults.add(format!("wave.length_mm[{}] = {length_mm}, {rule}", axis.index()));
                break;
            }
        }
    }

    fn axes(&self) -> &[Axis] {
        self.axes.as_deref().unwrap_or(&AXES)
    }

    fn slice_mm(&self) -> f64 {
        self.wavelength_mm / self.slices as f64
    }

    /// The intervals along x and along y from the lower corner on.
    pub(crate) fn intervals(&self, start_mm: [f64; 3]) -> [Vec<Interval>; 2] {
        let along = |axis: Axis, count: usize| {
            let (start, length) = (start_mm[axis.index()], self.length_mm[axis.index()]);
            match self.axes().contains(&axis) {
                true => self.slices_from(start, count),
                false => vec![Interval { centre: start + 0.5 * length, width: length, pattern: 0.0, upright: 0.0 }],
            }
        };
        let [columns, rows] = self.counts();
        [along(Axis::X, columns), along(Axis::Y, rows)]
    }

    /// Number of slices along x and y, or of intervals.
    pub(crate) fn counts(&self) -> [usize; 2] {
        AXES.map(|axis| match self.axes().contains(&axis) {
            true => (self.length_mm[axis.index()] / self.slice_mm()).round() as usize,
            false => 1,
        })
    }

    /// Slices of equal width from a coordinate on. Each has the wave at its centre over sinc(pi /
    /// N), so that the wave of the first order of all slices is the wave itself.
    fn slices_from(&self, start_mm: f64, count: usize) -> Vec<Interval> {
        let (width, half) = (self.slice_mm(), PI / self.slices as f64);
        let scale = half / half.sin();
        let rounded = |value: f64| if value.abs() < NONE { 0.0 } else { scale * value };
        let slice = |number: usize| {
            let centre = start_mm + (number as f64 + 0.5) * width;
            let (sine, cosine) = (TAU * centre / self.wavelength_mm + self.phase_deg.to_radians()).sin_cos();
            let (in_plane, upright) = (rounded(sine), rounded(cosine));
            let (pattern, upright) = match self.direction {
                Direction::InPlane => (in_plane, 0.0),
                Direction::Upright => (0.0, upright),
                Direction::OneSided => (in_plane, upright),
            };
            Interval { centre, width, pattern, upright }
        };
        (0..count).map(slice).collect()
    }

    /// The largest error of the field at a distance from the film, over the field of the wave
    /// there, of a film without end: near exp(-(N - 2) k z).
    pub(crate) fn error_at(&self, distance_mm: f64) -> f64 {
        (-(self.slices as f64 - 2.0) * TAU / self.wavelength_mm * distance_mm).exp()
    }
}
