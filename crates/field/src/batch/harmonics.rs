//! Moments of tiles in regular solid harmonics (docs/physics.md, section 2.8).

use std::f64::consts::PI;

use glam::DVec3;

/// Complex numbers by degree l and order m, 0 <= m <= l; those of order -m are (-1)^m times their conjugates.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    degree: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

fn start(degree: usize) -> usize {
    degree * (degree + 1) / 2
}

impl Moments {
    /// All zero, up to `degree`.
    pub(super) fn new(degree: usize) -> Moments {
        let count = start(degree + 1);
        Moments { degree, re: vec![0.0; count], im: vec![0.0; count] }
    }

    /// Zero beyond |m| = l.
    pub(super) fn at(&self, l: usize, m: isize) -> [f64; 2] {
        let (order, negative) = (m.unsigned_abs(), m < 0);
        if order > l {
            return [0.0; 2];
        }
        let [re, im] = [self.re[start(l) + order], self.im[start(l) + order]];
        match (negative, order % 2 == 0) {
            (false, _) => [re, im],
            (true, true) => [re, -im],
            (true, false) => [-re, im],
        }
    }

    /// Adds other ones.
    pub(super) fn add(&mut self, other: &Moments) {
        for (own, other) in self.re.iter_mut().zip(&other.re).chain(self.im.iter_mut().zip(&other.im)) {
            *own += other;
        }
    }

    /// The moments of a point become those of a bar along `axis` around it with the same total, `half` long to either side: the mean over it of a harmonic
    /// is the sum of half^2k / (2k + 1)! times its derivatives of order 2k, of which `terms` are taken.
    fn spread(&mut self, axis: usize, half: f64, terms: usize) {
        let before = self.clone();
        for k in (1..=terms).rev() {
            let factor = half * half / (2 * k * (2 * k + 1)) as f64;
            for l in (2..=self.degree).rev() {
                for m in 0..=l {
                    let [re, im] = self.second_derivative(axis, l, m as isize);
                    let index = start(l) + m;
                    self.re[index] = before.re[index] + factor * re;
                    self.im[index] = before.im[index] + factor * im;
                }
            }
        }
    }

    /// By Eq. P22, of lower degrees.
    fn second_derivative(&self, axis: usize, l: usize, m: isize) -> [f64; 2] {
        let own = self.at(l - 2, m);
        if axis == 2 {
            return own;
        }
        let (above, below) = (self.at(l - 2, m + 2), self.at(l - 2, m - 2));
        let sign = if axis == 0 { 0.25 } else { -0.25 };
        [0, 1].map(|part: usize| sign * (above[part] + below[part]) - 0.5 * own[part])
    }
}

/// The regular solid harmonics at a point, scaled as the moments are, degree after degree.
struct Harmonics {
    /// Of the degree before the last, of the last, and of the one at work.
    re: [Vec<f64>; 3],
    im: [Vec<f64>; 3],
}

/// Adds the regular solid harmonics at `point` to the moments of each component, with these weights.
fn add_point(moments: &mut [Moments; 3], room: &mut Harmonics, point: DVec3, weights: DVec3) {
    let degree = moments[0].degree;
    let square = point.length_squared();
    let Harmonics { re: [re_2, re_1, re_0], im: [im_2, im_1, im_0] } = room;
    for l in 0..=degree {
        // (l + m)(l - m) R_l = (2l - 1) z R_(l-1) - r^2 R_(l-2)
        for m in 0..l {
            let over = 1.0 / ((l + m) * (l - m)) as f64;
            let along = (2 * l - 1) as f64 * point.z * over;
            let back = if m + 2 <= l { square * over } else { 0.0 };
            re_0[m] = along * re_1[m] - back * re_2[m];
            im_0[m] = along * im_1[m] - back * im_2[m];
        }
        if l == 0 {
            (re_0[0], im_0[0]) = (1.0, 0.0);
        } else {
            // R_ll = (x + i y) R_(l-1)(l-1) / 2l
            let (re, im, over) = (re_1[l - 1], im_1[l - 1], 0.5 / l as f64);
            re_0[l] = over * (point.x * re - point.y * im);
            im_0[l] = over * (point.x * im + point.y * re);
        }
        let span = start(l)..start(l + 1);
        for (moments, weight) in moments.iter_mut().zip(weights.to_array()) {
            for (sum, value) in moments.re[span.clone()].iter_mut().zip(&*re_0) {
                *sum += weight * value;
            }
            for (sum, value) in moments.im[span.clone()].iter_mut().zip(&*im_0) {
                *sum += weight * value;
            }
        }
        // The oldest becomes the next to be written.
        std::mem::swap(re_2, re_1);
        std::mem::swap(re_1, re_0);
        std::mem::swap(im_2, im_1);
        std::mem::swap(im_1, im_0);
    }
}

/// The moments M of the scalar potential (Eq. P21) of cuboids with equal sides, given by centre and polarization, up to `degree`, of which
/// `terms` of the series in their size are taken.
pub(super) fn moments_of_tiles(size: [f64; 3], tiles: &[(DVec3, DVec3)], degree: usize, terms: usize) -> Moments {
    let mut uniform = [0, 1, 2].map(|_| Moments::new(degree - 1));
    let row = || [0, 1, 2].map(|_| vec![0.0; degree + 1]);
    let mut room = Harmonics { re: row(), im: row() };
    let volume_over_4pi = size[0] * size[1] * size[2] / (4.0 * PI);
    for &(centre, polarization_t) in tiles {
        add_point(&mut uniform, &mut room, centre, polarization_t * volume_over_4pi);
    }
    for moments in &mut uniform {
        for (axis, side) in size.into_iter().enumerate() {
            moments.spread(axis, 0.5 * side, terms);
        }
    }
    let mut potential = Moments::new(degree);
    let [x, y, z] = uniform;
    for l in 1..=degree {
        for m in 0..=l {
            // The conjugate of J grad R, by Eq. P22.
            let order = m as isize;
            let ([xr, xi], [yr, yi]) = (x.at(l - 1, order + 1), y.at(l - 1, order + 1));
            let above = [xr + yi, xi - yr];
            let ([xr, xi], [yr, yi]) = (x.at(l - 1, order - 1), y.at(l - 1, order - 1));
            let below = [xr - yi, xi + yr];
            let [zr, zi] = z.at(l - 1, order);
            potential.re[start(l) + m] = zr + 0.5 * (below[0] - above[0]);
            potential.im[start(l) + m] = -(zi + 0.5 * (below[1] - above[1]));
        }
    }
    potential
}
