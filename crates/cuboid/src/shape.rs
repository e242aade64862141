//! Lengths of a cuboid that determine where each method reaches the error bound.

use crate::block::Block;
use crate::closed_form::terms::Form;
use crate::tolerances::{
    CLOSED_FORM_REACH, LONGEST_ROD, MULTIPOLE_ORDERS, NEAR_FRACTION, RADIUS_BISECTIONS, SMALL_ANGLE,
};

/// Lengths of a cuboid in its scale.
pub struct Shape {
    /// Longest side.
    pub largest: f64,
    /// Second longest side.
    pub second: f64,
    /// Distance from the centre to a corner.
    pub half_diagonal: f64,
    /// Mean of the fourth power of the distance from the centre, over the fourth power of the half
    /// diagonal.
    fourth_moment: f64,
    /// Product of the sides.
    pub volume: f64,
}

impl Shape {
    /// The shape of a block whose lengths are multiplied by `scale`.
    pub fn new(block: &Block, scale: f64) -> Shape {
        Shape::from_sides(block.size.map(|s| s * scale))
    }

    /// The shape of a cuboid with these sides.
    pub fn from_sides(mut sides: [f64; 3]) -> Shape {
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

    /// The closed form of the cuboid alone: the form of rods, if the compact form would end before
    /// the series begins.
    pub fn form(&self) -> Form {
        let [(_, series_from), ..] = MULTIPOLE_ORDERS;
        let leaves_gap = CLOSED_FORM_REACH * self.second < series_from * self.half_diagonal;
        if leaves_gap { Form::Rod } else { Form::Compact }
    }

    /// Smallest distance from the cuboid at which its closed form reaches the error bound.
    pub fn closed_form_from(&self, form: Form) -> f64 {
        NEAR_FRACTION * if form == Form::Rod { self.second } else { self.largest }
    }

    /// The side whose ratio to the distance of a point is the growth of the closed form's error.
    pub fn side_of_error(&self, form: Form) -> f64 {
        if form == Form::Rod { self.largest } else { self.second }
    }

    /// Largest distance from the centre at which the closed form reaches the error bound; zero if
    /// its numbers could overflow.
    pub fn closed_form_to(&self, form: Form) -> f64 {
        if self.largest <= LONGEST_ROD * self.second { CLOSED_FORM_REACH * self.side_of_error(form) } else { 0.0 }
    }

    /// Upper bound of the mean of 1 / |r - r'|^3 over the cuboid, times r^3, at a distance r from
    /// the centre; `q` is the half diagonal over r, below 1.
    ///
    /// It is 1 + 2 q^2 + m (S - 1 - 6 q^2), m the fourth moment. The part of even degree l in r' is
    /// at most (l + 1) (l + 2) / 2 (r' / r)^l of 1 / r^3; S is the sum of these over all l where r'
    /// is the half diagonal. Odd parts cancel, and from l = 4 on the mean of r'^l is at most m of
    /// its largest value.
    pub fn mean_inverse_cube(&self, q: f64) -> f64 {
        let sum = 0.5 * ((1.0 - q).powi(-3) + (1.0 + q).powi(-3));
        1.0 + 2.0 * q * q + self.fourth_moment * (sum - 1.0 - 6.0 * q * q)
    }

    /// A distance from the centre beyond which half of 4 pi T is at most [`SMALL_ANGLE`] for every
    /// element. Half of 4 pi T is at most the integral of dV / |r - r'|^3.
    pub fn small_elements_from(&self) -> f64 {
        let bound = |radius: f64| self.volume / radius.powi(3) * self.mean_inverse_cube(self.half_diagonal / radius);
        // The distance is between these two numbers.
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
