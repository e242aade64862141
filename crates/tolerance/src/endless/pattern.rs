//! The field of the endless pattern by its Fourier series (docs/physics.md, section 7.2).

use glam::{DVec2, DVec3};
use magsplice_decouple::Figures;
use magsplice_head::SensorHead;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{HallSensor, Tile};
use rayon::prelude::*;
use thiserror::Error;

use super::footprint::Footprint;
use crate::evaluation_grid::{EvaluationGrid, SampleError};

/// Largest sum of the neglected harmonics, as a fraction of mean |J| e^(-kh) at the height h of the
/// nearest point. The first harmonic of a film as thick as a tenth of its wavelength is about a
/// fifth of mean |J| e^(-kh).
const TRUNCATION: f64 = 1e-13;

/// The highest harmonic along each axis. It is enough down to a height of 0.05 wavelengths.
const MOST_HARMONICS: usize = 128;

/// The splicing pattern of a film without end: its part within half a wavelength of the axis x = y
/// = 0, repeated in x and y. Tiles are cut at the border.
///
/// # Units
/// Lengths in millimetres, flux densities in tesla.
///
/// # Accuracy
/// The neglected harmonics add at most 1e-13 of mean |J| e^(-kh) at the point nearest to
/// the film, by the bound of [`EndlessPattern::truncation_bound_t`]. Rounding is of the same order.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_ideal::IdealFilm;
/// use magsplice_magnet::Tile;
/// use magsplice_tolerance::EndlessPattern;
///
/// // Stripes along y, half a wavelength wide.
/// let stripe = |x: f64| Tile::new(DVec3::new(x, 0.0, 0.5), DVec3::new(5.0, 20.0, 1.0), DVec3::new(0.1 * x.signum(), 0.0, 0.0));
/// let pattern = EndlessPattern::new(&[stripe(-2.5)?, stripe(2.5)?], &IdealFilm::new(10.0, 1.0, 0.1)?)?;
/// let b_t = pattern.flux_density_t(&[DVec3::new(0.0, 3.0, -6.0)])?[0];
/// // The first harmonic of a square wave is 4 / pi of its height.
/// let first = 0.1 * 4.0 / std::f64::consts::PI * 0.5 * (1.0 - (-0.2 * std::f64::consts::PI).exp());
/// assert!((b_t.z / (first * (-1.2 * std::f64::consts::PI).exp()) - 1.0).abs() < 1e-2 && b_t.y.abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct EndlessPattern {
    ideal: IdealFilm,
    footprints: Vec<Footprint>,
    /// The lowest face.
    lowest: f64,
    /// Mean of |J| over the period, over all tiles above each other.
    mean_j_t: f64,
}

/// Why the endless pattern of a film, or its field, does not exist.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum EndlessPatternError {
    /// Tiles have no face parallel to the film, by their indices.
    #[error(
        "{} tiles are tilted against the film, so that their pattern has no Fourier series: tile {}{}; \
         a rotation must be about the normal of the film",
        .0.len(),
        .0.iter().take(NAMED_TILES).map(usize::to_string).collect::<Vec<_>>().join(", "),
        if .0.len() > NAMED_TILES { ", ..." } else { "" }
    )]
    Tilted(Vec<usize>),
    /// No tile lies within half a wavelength of the axis.
    #[error("no magnetized tile lies within half a wavelength of the axis x = y = 0 of the film")]
    Empty,
    /// A point is not below the film.
    #[error("the point ({}, {}, {}) mm is not below the film", point.x, point.y, point.z)]
    NotBelow {
        /// The point.
        point: DVec3,
    },
    /// A point is so near to the film that too many harmonics are needed.
    #[error(
        "a point is {height_mm} mm below the film, must be at least {least_mm:.3} mm for the Fourier series of the \
         pattern"
    )]
    TooNear {
        /// Its distance from the lowest face.
        height_mm: f64,
        /// The least distance.
        least_mm: f64,
    },
    /// The field of the pattern has no decoupling errors.
    #[error("the endless pattern: {0}")]
    NoErrors(#[source] SampleError),
}

impl EndlessPattern {
    /// The pattern of a film with the wavelength of an ideal one.
    ///
    /// # Errors
    /// If tiles are tilted against the film, or none lies in the central period.
    pub fn new(tiles: &[Tile], ideal: &IdealFilm) -> Result<EndlessPattern, EndlessPatternError> {
        let all: Vec<Option<Footprint>> = tiles.iter().map(Footprint::new).collect();
        let tilted: Vec<usize> = (0..all.len()).filter(|&tile| all[tile].is_none()).collect();
        if !tilted.is_empty() {
            return Err(EndlessPatternError::Tilted(tilted));
        }
        let half = 0.5 * ideal.wavelength();
        let footprints: Vec<Footprint> = all.into_iter().flatten().filter_map(|found| found.within(half)).collect();
        let lowest = footprints.iter().map(|found| found.ends[0]).fold(f64::INFINITY, f64::min);
        let mean_j_t =
            footprints.iter().map(|found| found.area() * found.j_t.length()).sum::<f64>() / (4.0 * half * half);
        if !(mean_j_t > 0.0) {
            return Err(EndlessPatternError::Empty);
        }
        Ok(EndlessPattern { ideal: *ideal, footprints, lowest, mean_j_t })
    }

    /// B at points below the film, in tesla.
    ///
    /// # Errors
    /// If a point is not below the film, or too near to it.
    pub fn flux_density_t(&self, points: &[DVec3]) -> Result<Vec<DVec3>, EndlessPatternError> {
        if let Some(point) = points.iter().find(|point| !(point.z < self.lowest && point.is_finite())) {
            return Err(EndlessPatternError::NotBelow { point: *point });
        }
        let height = points.iter().map(|point| self.lowest - point.z).fold(f64::INFINITY, f64::min);
        let most = self.harmonics_at(height)?;
        let k = self.ideal.wavenumber();
        let harmonics: Vec<(i32, i32)> = half_plane(most).collect();
        let coefficients: Vec<[f64; 2]> = harmonics.par_iter().map(|(m, n)| self.potential(*m, *n)).collect();
        let at_point = |point: &DVec3| {
            let phases = |x: f64| -> Vec<(f64, f64)> { (0..=most).map(|m| (m as f64 * k * x).sin_cos()).collect() };
            let (along_x, along_y) = (phases(point.x), phases(point.y));
            let mut b_t = DVec3::ZERO;
            for ((m, n), [real, imaginary]) in harmonics.iter().zip(&coefficients) {
                let (sine_x, cosine_x) = along_x[m.unsigned_abs() as usize];
                let (sine_y, cosine_y) = along_y[n.unsigned_abs() as usize];
                let sine_y = if *n < 0 { -sine_y } else { sine_y };
                let (cosine, sine) = (cosine_x * cosine_y - sine_x * sine_y, sine_x * cosine_y + cosine_x * sine_y);
                let q = k * DVec2::new(f64::from(*m), f64::from(*n));
                let decay = (q.length() * (point.z - self.lowest)).exp();
                let (c_real, c_imaginary) = (real * cosine - imaginary * sine, real * sine + imaginary * cosine);
                b_t += decay * DVec3::new(q.x * c_imaginary, q.y * c_imaginary, -q.length() * c_real);
            }
            // The harmonics -m, -n are the complex conjugates.
            2.0 * b_t
        };
        Ok(points.par_iter().map(at_point).collect())
    }

    /// An upper bound, in tesla, of the sum of all harmonics with m or n beyond `most` in
    /// magnitude, at this height below the lowest face (docs/physics.md, Eq. P61).
    pub fn truncation_bound_t(&self, most: usize, height_mm: f64) -> f64 {
        let x = (-self.ideal.wavenumber() * height_mm).exp();
        let most = most as f64;
        let sum = x.powf(most + 1.0) * (most + 1.0 - most * x) / (1.0 - x).powi(2);
        8.0 * std::f64::consts::FRAC_1_SQRT_2 * self.mean_j_t * sum
    }

    /// The errors of decoupling and displacement of the pattern against the ideal film.
    ///
    /// # Errors
    /// As [`EndlessPattern::flux_density_t`], and if the parameters do not exist in the volume.
    pub fn errors(&self, volume: &EvaluationGrid) -> Result<Figures, EndlessPatternError> {
        self.errors_of_head(volume, &SensorHead::from(HallSensor::default()))
    }

    /// [`EndlessPattern::errors`] of the weighted sum of the sensors of a head.
    ///
    /// # Errors
    /// As [`EndlessPattern::errors`].
    pub fn errors_of_head(&self, volume: &EvaluationGrid, head: &SensorHead) -> Result<Figures, EndlessPatternError> {
        let points: Vec<DVec3> = volume.grid.points().chain([volume.reference]).collect();
        let mut field_t = vec![DVec3::ZERO; points.len()];
        for of in &head.elements {
            let places: Vec<DVec3> = points.iter().map(|point| *point + of.place).collect();
            let read_t = self.flux_density_t(&places)?;
            field_t.iter_mut().zip(read_t).for_each(|(sum, b_t)| *sum += of.weight * b_t);
        }
        let last = points.len() - 1;
        volume.figures(&field_t[..last], field_t[last], &self.ideal).map_err(EndlessPatternError::NoErrors)
    }

    /// The highest harmonic that is needed at a height.
    fn harmonics_at(&self, height_mm: f64) -> Result<usize, EndlessPatternError> {
        let k = self.ideal.wavenumber();
        let is_enough = |most: &usize, height: f64| {
            self.truncation_bound_t(*most, height) <= TRUNCATION * self.mean_j_t * (-k * height).exp()
        };
        (1..=MOST_HARMONICS).find(|most| is_enough(most, height_mm)).ok_or_else(|| {
            // The bound falls with the height: bisection.
            let (mut near, mut enough) = (height_mm, self.ideal.wavelength());
            for _ in 0..30 {
                let middle = 0.5 * (near + enough);
                if is_enough(&MOST_HARMONICS, middle) { enough = middle } else { near = middle }
            }
            EndlessPatternError::TooNear { height_mm, least_mm: enough }
        })
    }

    /// The coefficient of the scalar potential of B at the lowest face (docs/physics.md, Eq. P59).
    fn potential(&self, m: i32, n: i32) -> [f64; 2] {
        let q = self.ideal.wavenumber() * DVec2::new(f64::from(m), f64::from(n));
        let length = q.length();
        let area = self.ideal.wavelength().powi(2);
        let mut sum = [0.0; 2];
        for part in &self.footprints {
            let [real, imaginary] = part.transform(q);
            let [below, above] = part.ends.map(|end| end - self.lowest);
            let thickness = -(-length * below).exp() * (-length * (above - below)).exp_m1() / (2.0 * length);
            let (in_plane, normal) = (q.dot(part.j_t.truncate()) / length, part.j_t.z);
            // (real + i imaginary) * (-i in_plane - normal)
            sum[0] += thickness / area * (imaginary * in_plane - real * normal);
            sum[1] -= thickness / area * (real * in_plane + imaginary * normal);
        }
        sum
    }
}

/// One of each pair of harmonics (m, n) and (-m, -n), but for (0, 0).
fn half_plane(most: usize) -> impl Iterator<Item = (i32, i32)> {
    let most = most as i32;
    let on_axis = (1..=most).map(|n| (0, n));
    on_axis.chain((1..=most).flat_map(move |m| (-most..=most).map(move |n| (m, n))))
}

/// Largest number of tiles that a message lists.
const NAMED_TILES: usize = 10;

#[cfg(test)]
mod tests {
    use super::*;

    /// The bound is the sum of the geometric series of n x^n beyond the highest harmonic n, with
    /// x = e^(-kh). Stripes that fill the period have the mean |J| of one stripe.
    #[test]
    fn truncation_bound_is_the_sum_of_its_series() {
        let stripe = |x: f64| {
            Tile::new(DVec3::new(x, 0.0, 0.5), DVec3::new(5.0, 20.0, 1.0), 0.1 * x.signum() * DVec3::X).unwrap()
        };
        let ideal = IdealFilm::new(10.0, 1.0, 0.1).unwrap();
        let pattern = EndlessPattern::new(&[stripe(-2.5), stripe(2.5)], &ideal).unwrap();
        for (most, height_mm) in [(1, 4.0), (5, 1.0), (20, 0.5)] {
            let x = (-std::f64::consts::TAU / 10.0 * height_mm).exp();
            let series: f64 = (most as i32 + 1..2000).map(|n| f64::from(n) * x.powi(n)).sum();
            let expected_t = 8.0 / 2.0_f64.sqrt() * 0.1 * series;
            let bound_t = pattern.truncation_bound_t(most, height_mm);
            assert!((bound_t / expected_t - 1.0).abs() < 1e-12, "{most} {height_mm}: {bound_t} {expected_t}");
        }
    }
}
