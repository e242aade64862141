//! The response of a head to an ideal film, and to stray fields.

use glam::{DMat3, DVec2, DVec3};

/// The response of a head to an ideal film, to a uniform field, and to one that changes linearly:
/// the sums of Eqs. 1 to 3 of the crate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HeadForm {
    /// Real and imaginary part of the sum of Eq. 1 for the waves along x and along y, for the
    /// weights of the axes that read each: B_x or B_y, and B_z.
    pub waves: [[DVec2; 2]; 2],
    /// The sum of the weights of each axis: its reading in a uniform field of 1 along this axis.
    pub uniform: DVec3,
    /// The sum of weights times places, a column for each coordinate of the place.
    pub linear: DMat3,
}

impl HeadForm {
    /// The form of sensors at places on the board, with a weight for each axis, below a film of
    /// this wavenumber.
    pub fn new(places: &[DVec3], weights: &[DVec3], wavenumber: f64) -> HeadForm {
        let pairs = || places.iter().zip(weights);
        let wave = |along: usize, read: usize| -> DVec2 {
            let of = |(place, weight): (&DVec3, &DVec3)| {
                weight[read] * (wavenumber * place.z).exp() * DVec2::from_angle(wavenumber * place[along])
            };
            pairs().map(of).sum()
        };
        let column = |coordinate: usize| pairs().map(|(place, weight)| *weight * place[coordinate]).sum();
        HeadForm {
            waves: [0, 1].map(|along| [wave(along, along), wave(along, 2)]),
            uniform: weights.iter().sum(),
            linear: DMat3::from_cols(column(0), column(1), column(2)),
        }
    }

    /// The factor c of Eq. 1: the mean of the real parts.
    pub fn factor(&self) -> f64 {
        self.waves.as_flattened().iter().map(|wave| wave.x).sum::<f64>() / 4.0
    }

    /// The distance from the form of Eq. 2: the largest difference of a sum of Eq. 1 from the
    /// factor, over the factor. Infinite without a factor.
    pub fn distance(&self) -> f64 {
        let factor = self.factor();
        let furthest = self.waves.as_flattened().iter().map(|wave| wave.distance(DVec2::new(factor, 0.0)));
        let furthest = furthest.fold(0.0, f64::max);
        if factor == 0.0 { f64::INFINITY } else { furthest / factor.abs() }
    }
}
