//! The ideal, sinusoidally magnetized film.
//!
//! Dai, Wu, Meng, Zhang, Zhao, "A Magnet Splicing Method for Constructing a Three-Dimensional
//! Self-Decoupled Magnetic Tactile Sensor", Magnetochemistry 2024, 10(1), 6: Eqs. 1 and 2.

use std::f64::consts::TAU;
use std::fmt;

use glam::DVec3;

/// An infinite film in 0 <= z <= thickness with polarization J = m0 (sin kx, sin ky, 0),
/// k = 2 pi / wavelength (Eq. 1).
///
/// # Units
/// Wavelength and thickness are in the unit of length of the points, the amplitude m0 is in tesla.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_ideal::IdealFilm;
///
/// let film = IdealFilm::new(10.0, 1.0, 0.12)?; // mm, mm, T
/// let b_t = film.flux_density_t(DVec3::new(0.0, 0.0, -5.0)).expect("below the film");
/// assert!((b_t.z - 2.419e-3).abs() < 1e-6);
/// # Ok::<(), magsplice_ideal::IdealFilmFaults>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "UncheckedFilm"))]
pub struct IdealFilm {
    wavelength: f64,
    thickness: f64,
    amplitude_t: f64,
}

/// A deserialized film, before [`IdealFilm::new`] checks it.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct UncheckedFilm {
    wavelength: f64,
    thickness: f64,
    amplitude_t: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<UncheckedFilm> for IdealFilm {
    type Error = IdealFilmFaults;

    fn try_from(film: UncheckedFilm) -> Result<IdealFilm, IdealFilmFaults> {
        IdealFilm::new(film.wavelength, film.thickness, film.amplitude_t)
    }
}

/// An invalid number of an ideal film.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum IdealFilmFault {
    /// The wavelength is not a positive finite number.
    Wavelength(f64),
    /// The thickness is not a positive finite number.
    Thickness(f64),
    /// The amplitude is zero or not finite.
    Amplitude(f64),
}

/// All invalid numbers of an ideal film.
#[derive(Clone, Debug, PartialEq)]
pub struct IdealFilmFaults(pub Vec<IdealFilmFault>);

impl IdealFilm {
    /// The film of Eq. 1 with these numbers.
    ///
    /// # Errors
    /// All faults at once.
    pub fn new(wavelength: f64, thickness: f64, amplitude_t: f64) -> Result<IdealFilm, IdealFilmFaults> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let mut faults = Vec::new();
        if !positive(wavelength) {
            faults.push(IdealFilmFault::Wavelength(wavelength));
        }
        if !positive(thickness) {
            faults.push(IdealFilmFault::Thickness(thickness));
        }
        if !amplitude_t.is_finite() || amplitude_t == 0.0 {
            faults.push(IdealFilmFault::Amplitude(amplitude_t));
        }
        if faults.is_empty() {
            Ok(IdealFilm { wavelength, thickness, amplitude_t })
        } else {
            Err(IdealFilmFaults(faults))
        }
    }

    /// Wavelength of the magnetization.
    pub fn wavelength(&self) -> f64 {
        self.wavelength
    }

    /// Thickness d of the film.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Amplitude m0 of the polarization, in tesla.
    pub fn amplitude_t(&self) -> f64 {
        self.amplitude_t
    }

    /// k = 2 pi / wavelength.
    pub fn wavenumber(&self) -> f64 {
        TAU / self.wavelength
    }

    /// K = m0 (1 - e^(-kd)) / 2, the amplitude of B at the lower face, in tesla (Eq. 2).
    pub fn surface_amplitude_t(&self) -> f64 {
        -0.5 * self.amplitude_t * (-self.wavenumber() * self.thickness).exp_m1()
    }

    /// J in tesla (Eq. 1); zero outside of the film, which fills 0 <= z <= d.
    pub fn polarization_t(&self, point: DVec3) -> DVec3 {
        if !(0.0..=self.thickness).contains(&point.z) {
            return DVec3::ZERO;
        }
        let k = self.wavenumber();
        self.amplitude_t * DVec3::new((k * point.x).sin(), (k * point.y).sin(), 0.0)
    }

    /// B below the film, in tesla (Eq. 2); `None` where z >= 0, outside the domain of Eq. 2, or
    /// where a phase is not finite.
    ///
    /// # Accuracy
    /// The error is a few units of round-off of `K e^(kz)`, plus the round-off of `kx` and `ky` as
    /// phases.
    pub fn flux_density_t(&self, point: DVec3) -> Option<DVec3> {
        if !(point.z < 0.0) {
            return None;
        }
        let k = self.wavenumber();
        let (sin_x, cos_x) = (k * point.x).sin_cos();
        let (sin_y, cos_y) = (k * point.y).sin_cos();
        let b = DVec3::new(-sin_x, -sin_y, cos_x + cos_y) * (self.surface_amplitude_t() * (k * point.z).exp());
        b.is_finite().then_some(b)
    }
}

impl IdealFilmFault {
    /// The text of the broken rule. It follows the name and the value of the quantity.
    pub fn rule(&self) -> &'static str {
        match self {
            IdealFilmFault::Wavelength(_) | IdealFilmFault::Thickness(_) => "must be a finite number greater than 0",
            IdealFilmFault::Amplitude(_) => "must be a finite number other than 0",
        }
    }
}

impl fmt::Display for IdealFilmFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, value) = match self {
            IdealFilmFault::Wavelength(value) => ("wavelength", value),
            IdealFilmFault::Thickness(value) => ("thickness", value),
            IdealFilmFault::Amplitude(value) => ("amplitude_t", value),
        };
        write!(f, "{name} = {value}, {}", self.rule())
    }
}

impl std::error::Error for IdealFilmFault {}

impl fmt::Display for IdealFilmFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.0.iter().enumerate() {
            let separator = if i == 0 { "" } else { "; " };
            write!(f, "{separator}{fault}")?;
        }
        Ok(())
    }
}

impl std::error::Error for IdealFilmFaults {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.first().map(|fault| fault as _)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Dai 2024 with lambda = 10 mm, d = 1 mm, m0 = 0.12 T.
    fn published() -> IdealFilm {
        IdealFilm::new(10.0, 1.0, 0.12).unwrap()
    }

    #[test]
    fn eq_2_at_a_generic_point() {
        assert_relative_eq!(published().surface_amplitude_t(), 0.02799, max_relative = 1e-4);
        let b = published().flux_density_t(DVec3::new(2.0, -1.0, -5.0)).unwrap();
        // From mpmath at 40 digits. The phases and the exponent are rounded, which adds a few units
        // of round-off.
        let want = [-1.150_386_977_445_826e-3, 7.109_782_522_767_793e-4, 1.352_360_999_543_941e-3];
        for (got, want) in b.to_array().into_iter().zip(want) {
            assert_relative_eq!(got, want, max_relative = 1e-14);
        }
    }

    #[test]
    fn eq_1_fills_the_film_only() {
        let j = |x: f64, y: f64, z: f64| published().polarization_t(DVec3::new(x, y, z));
        let sine = 0.12 * std::f64::consts::FRAC_1_SQRT_2;
        assert!((j(1.25, -3.75, 0.5) - DVec3::new(sine, -sine, 0.0)).length() < 1e-16);
        assert!((j(2.5, 5.0, 1.0) - DVec3::new(0.12, 0.0, 0.0)).length() < 1e-16);
        assert_eq!((j(2.5, 2.5, -1e-9), j(2.5, 2.5, 1.1)), (DVec3::ZERO, DVec3::ZERO));
    }

    #[test]
    fn eq_2_ends_at_the_film() {
        assert_eq!(published().flux_density_t(DVec3::ZERO), None);
        assert_eq!(published().flux_density_t(DVec3::NAN), None);
        assert!(published().flux_density_t(DVec3::new(0.0, 0.0, -1e-9)).is_some());
    }

    #[test]
    fn all_faults_are_reported() {
        assert_eq!(IdealFilm::new(0.0, f64::NAN, f64::INFINITY).unwrap_err().0.len(), 3);
    }
}
