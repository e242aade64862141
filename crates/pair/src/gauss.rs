//! Gauss rules: nodes and weights, whose sum is 1.
//!
//! The mean over two boxes of a function of the difference of two points is a mean over that
//! difference. Along each axis its density is the convolution of the densities in two intervals.
//! Gauss rules of n nodes for this density are exact for powers below 2n.

/// A node and its weight.
pub(crate) type Node = (f64, f64);

/// Gauss-Legendre rule of four nodes on [-1, 1].
pub(crate) const LEGENDRE_4: [Node; 4] = [
    (-0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
    (-0.339_981_043_584_856_26, 0.326_072_577_431_273_07),
    (0.339_981_043_584_856_26, 0.326_072_577_431_273_07),
    (0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
];

/// Gauss-Legendre rule of eight nodes on [-1, 1].
pub(crate) const LEGENDRE_8: [Node; 8] = [
    (-0.960_289_856_497_536_3, 0.050_614_268_145_188_13),
    (-0.796_666_477_413_626_7, 0.111_190_517_226_687_24),
    (-0.525_532_409_916_329, 0.156_853_322_938_943_63),
    (-0.183_434_642_495_649_8, 0.181_341_891_689_180_98),
    (0.183_434_642_495_649_8, 0.181_341_891_689_180_98),
    (0.525_532_409_916_329, 0.156_853_322_938_943_63),
    (0.796_666_477_413_626_7, 0.111_190_517_226_687_24),
    (0.960_289_856_497_536_3, 0.050_614_268_145_188_13),
];

/// The distribution of the sum of two numbers on [-a, a] and [-b, b].
#[derive(Clone, Copy)]
pub(crate) struct SumOfTwo {
    /// a + b
    scale: f64,
    /// Even moments from the second to the eighth, in units of the scale.
    moments: [f64; 4],
}

impl SumOfTwo {
    /// The sum of two uniform numbers.
    #[inline(always)]
    pub(crate) fn uniform(a: f64, b: f64) -> SumOfTwo {
        let scale = a + b;
        let (a, b) = ((a / scale) * (a / scale), (b / scale) * (b / scale));
        let m2 = (a + b) / 3.0;
        let m4 = (a * a + b * b) / 5.0 + 2.0 * a * b / 3.0;
        let m6 = (a * a * a + b * b * b) / 7.0 + a * b * (a + b);
        let m8 = (a.powi(4) + b.powi(4)) / 9.0 + 4.0 / 3.0 * a * b * (a * a + b * b) + 14.0 / 5.0 * a * a * b * b;
        SumOfTwo { scale, moments: [m2, m4, m6, m8] }
    }

    /// The sum of a number with a density like 1 - x^2 / a^2 and a uniform number.
    pub(crate) fn parabolic_and_uniform(a: f64, b: f64) -> SumOfTwo {
        let scale = a + b;
        let (a, b) = ((a / scale) * (a / scale), (b / scale) * (b / scale));
        let m2 = a / 5.0 + b / 3.0;
        let m4 = 3.0 / 35.0 * a * a + 2.0 / 5.0 * a * b + b * b / 5.0;
        let m6 = a.powi(3) / 21.0 + 3.0 / 7.0 * a * a * b + 3.0 / 5.0 * a * b * b + b.powi(3) / 7.0;
        let m8 =
            a.powi(4) / 33.0 + a * b * (4.0 / 9.0 * a * a + 6.0 / 5.0 * a * b + 4.0 / 5.0 * b * b) + b.powi(4) / 9.0;
        SumOfTwo { scale, moments: [m2, m4, m6, m8] }
    }

    /// The rule of two nodes.
    #[inline(always)]
    pub(crate) fn rule_of_two(self) -> [Node; 2] {
        let [m2, ..] = self.moments;
        let node = self.scale * m2.sqrt();
        [(-node, 0.5), (node, 0.5)]
    }

    /// The rule of three nodes.
    #[inline(always)]
    pub(crate) fn rule_of_three(self) -> [Node; 3] {
        let [m2, m4, ..] = self.moments;
        let (node, weight) = (self.scale * (m4 / m2).sqrt(), 0.5 * m2 * m2 / m4);
        [(-node, weight), (0.0, 1.0 - 2.0 * weight), (node, weight)]
    }

    /// The rule of four nodes. The polynomial t^4 + p t^2 + q is orthogonal to 1 and t^2.
    #[inline(always)]
    pub(crate) fn rule_of_four(self) -> [Node; 4] {
        let [m2, m4, m6, _] = self.moments;
        let p = (m2 * m4 - m6) / (m4 - m2 * m2);
        let [outer, inner] = squares_of_nodes(p, -m4 - p * m2);
        let of_outer = 0.5 * (m2 - inner) / (outer - inner);
        let of_inner = 0.5 - of_outer;
        let (outer, inner) = (self.scale * outer.sqrt(), self.scale * inner.sqrt());
        [(-outer, of_outer), (-inner, of_inner), (inner, of_inner), (outer, of_outer)]
    }

    /// The rule of five nodes. The polynomial t (t^4 + p t^2 + q) is orthogonal to t and t^3.
    #[inline(always)]
    pub(crate) fn rule_of_five(self) -> [Node; 5] {
        let [m2, m4, m6, m8] = self.moments;
        let determinant = m2 * m6 - m4 * m4;
        let [outer, inner] = squares_of_nodes((m4 * m6 - m2 * m8) / determinant, (m4 * m8 - m6 * m6) / determinant);
        // Weights of the pairs, exact for t^2 and t^4.
        let of_outer = (m4 - inner * m2) / (2.0 * outer * (outer - inner));
        let of_inner = (outer * m2 - m4) / (2.0 * inner * (outer - inner));
        let (outer, inner) = (self.scale * outer.sqrt(), self.scale * inner.sqrt());
        let centre = 1.0 - 2.0 * (of_outer + of_inner);
        [(-outer, of_outer), (-inner, of_inner), (0.0, centre), (inner, of_inner), (outer, of_outer)]
    }
}

/// The roots of x^2 + p x + q, the larger first.
fn squares_of_nodes(p: f64, q: f64) -> [f64; 2] {
    let outer = -0.5 * p + (0.25 * p * p - q).max(0.0).sqrt();
    [outer, q / outer]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule gives `mean(n)` as the mean of t^n for even powers below twice its number of nodes,
    /// and its nodes are inside.
    fn check(rule: &[Node], [a, b]: [f64; 2], mean: impl Fn(i32) -> f64) {
        assert!(rule.iter().all(|(t, weight)| t.abs() < a + b && *weight > 0.0), "{rule:?}");
        for power in (0..2 * rule.len() as i32).step_by(2) {
            let sum: f64 = rule.iter().map(|(t, weight)| weight * t.powi(power)).sum();
            let allowed = 1e-12 * (a + b).powi(power) * (1.0 + 1e-3 / (a * b));
            assert!((sum - mean(power)).abs() <= allowed, "{a} {b} {power}: {sum} {}", mean(power));
        }
    }

    #[test]
    fn rules_are_exact_below_twice_their_nodes() {
        for (a, b) in [(0.5, 0.5), (1.0, 1e-6), (0.3, 2.0)] {
            // The mean of (s + t)^n over both intervals, by its antiderivatives.
            let mean = |power: i32| {
                let n = f64::from(power);
                let corner = |x: f64| x.powi(power + 2) / ((n + 1.0) * (n + 2.0));
                (corner(a + b) - corner(a - b) - corner(b - a) + corner(-a - b)) / (4.0 * a * b)
            };
            let uniform = SumOfTwo::uniform(a, b);
            check(&uniform.rule_of_two(), [a, b], mean);
            check(&uniform.rule_of_three(), [a, b], mean);
            check(&uniform.rule_of_four(), [a, b], mean);
            check(&uniform.rule_of_five(), [a, b], mean);
        }
    }

    /// By Gauss-Legendre rules of eight nodes, exact up to the fifteenth power in each interval.
    #[test]
    fn levered_rule_is_exact_below_twice_its_nodes() {
        for (a, b) in [(0.5, 0.5), (1.0, 1e-3), (0.3, 2.0), (2.0, 0.3)] {
            let mean = |power: i32| -> f64 {
                let inner =
                    |x: f64| LEGENDRE_8.iter().map(|(y, weight)| weight * (a * x + b * y).powi(power)).sum::<f64>();
                LEGENDRE_8.iter().map(|(x, weight)| 1.5 * weight * (1.0 - x * x) * inner(*x)).sum()
            };
            check(&SumOfTwo::parabolic_and_uniform(a, b).rule_of_five(), [a, b], mean);
        }
    }
}
