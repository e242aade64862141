//! Exact sums of two doubles (Knuth's two-sum), for coordinates and for sums over tiles.

/// An unevaluated sum `hi + lo` with |lo| at most half a unit in the last place of `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoSum {
    /// The rounded sum.
    pub hi: f64,
    /// Its rounding error.
    pub lo: f64,
}

impl TwoSum {
    /// The exact sum a + b.
    #[inline(always)]
    pub fn new(a: f64, b: f64) -> TwoSum {
        let hi = a + b;
        let b_part = hi - a;
        let lo = (a - (hi - b_part)) + (b - b_part);
        TwoSum { hi, lo }
    }

    /// A number without rounding error.
    #[inline(always)]
    pub fn exact(value: f64) -> TwoSum {
        TwoSum { hi: value, lo: 0.0 }
    }

    /// self - other, to about twice the precision of a double.
    #[inline(always)]
    pub fn minus(self, other: TwoSum) -> TwoSum {
        let head = TwoSum::new(self.hi, -other.hi);
        TwoSum::new(head.hi, head.lo + (self.lo - other.lo))
    }

    /// The sum, rounded.
    #[inline(always)]
    pub fn value(self) -> f64 {
        self.hi + self.lo
    }
}
