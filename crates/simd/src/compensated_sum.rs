//! Sums of two doubles without losing a digit (Knuth's two-sum), for coordinates and for the sum over tiles.

/// An unevaluated sum `hi + lo` with |lo| at most half a unit in the last place of `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoSum {
    pub hi: f64,
    pub lo: f64,
}

impl TwoSum {
    /// a + b, exactly.
    #[inline(always)]
    pub fn of(a: f64, b: f64) -> TwoSum {
        let hi = a + b;
        let b_part = hi - a;
        let lo = (a - (hi - b_part)) + (b - b_part);
        TwoSum { hi, lo }
    }

    #[inline(always)]
    pub fn exact(value: f64) -> TwoSum {
        TwoSum { hi: value, lo: 0.0 }
    }

    /// self - other, to about twice the precision of a double.
    #[inline(always)]
    pub fn minus(self, other: TwoSum) -> TwoSum {
        let head = TwoSum::of(self.hi, -other.hi);
        TwoSum::of(head.hi, head.lo + (self.lo - other.lo))
    }

    #[inline(always)]
    pub fn value(self) -> f64 {
        self.hi + self.lo
    }
}

/// A running sum whose error does not grow with the number of terms (Neumaier).
#[derive(Clone, Copy, Debug, Default)]
pub struct RunningSum {
    sum: f64,
    carry: f64,
}

impl RunningSum {
    #[inline(always)]
    pub fn add(&mut self, term: f64) {
        let step = TwoSum::of(self.sum, term);
        self.sum = step.hi;
        self.carry += step.lo;
    }

    #[inline(always)]
    pub fn value(self) -> f64 {
        self.sum + self.carry
    }
}
