//! Lengths of a cuboid that decide which method reaches the error bound where.

use crate::block::Block;
use crate::tolerances::{RADIUS_BISECTIONS, SMALL_ANGLE};

/// Lengths of a cuboid in its scale.
pub struct Shape {
    /// Longest side.
    pub largest: f64,
    /// Second longest side.
    pub second: f64,
    /// Distance from the centre to a corner.
    pub half_diagonal: f64,
    /// Mean of the fourth power of the distance from the centre, over that of the half diagonal.
    fourth_moment: f64,
    /// Product of the sides.
    pub volume: f64,
}

impl Shape {
    /// The shape of a block whose lengths are multiplied by `scale`.
    pub fn new(block: &Block, scale: f64) -> Shape {
        let mut sides = block.size.map(|s| s * scale);
        sides.sort_by(f64::total_cmp);
        let [third, second, largest] = sides;
        let [a, b, c] = sides.map(|s| 0.25 * s * s);
        let square = a + b + c;
        Shape {
            largest,
            second,
            half_diagonal: square.sqrt(),
            fourth_moment: ((a * a + b * b + c * c) / 5.0 + (a * b + b * c + c * a) / 4.5) / (square * square),
            volume: third * second * largest,
        }
    }

    /// A distance from the centre beyond which no element has half of 4 pi T above [`SMALL_ANGLE`].
    ///
    /// With q the half diagonal over the distance r, half of 4 pi T is at most the integral of
    /// dV / |r - r'|^3 <= V / r^3 (1 + 2 q^2 + m (S - 1 - 6 q^2)), m the fourth moment. The part of
    /// even degree l in r' is at most (l + 1) (l + 2) / 2 (r' / r)^l of 1 / r^3; S is the sum of
    /// these over all l where r' is the half diagonal. Odd parts cancel, and from l = 4 on the mean
    /// of r'^l is at most m of its largest value.
    pub fn small_elements_from(&self) -> f64 {
        let bound = |radius: f64| {
            let q = self.half_diagonal / radius;
            let sum = 0.5 * ((1.0 - q).powi(-3) + (1.0 + q).powi(-3));
            self.volume / radius.powi(3) * (1.0 + 2.0 * q * q + self.fourth_moment * (sum - 1.0 - 6.0 * q * q))
        };
        // The distance is not below the first number, and at most the second.
        let mut low = (self.volume / SMALL_ANGLE).cbrt();
        let mut high = low + self.half_diagonal;
        for _ in 0..RADIUS_BISECTIONS {
            let middle = 0.5 * (low + high);
            if middle > self.half_diagonal && bound(middle) <= SMALL_ANGLE {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }
}
