//! `[ideal]`: the sinusoidal film to compare with.

use magsplice_ideal::{IdealFilm, IdealFilmFault};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::TableFaults;
use crate::plausible::check_material;

/// The sinusoidal film of Dai 2024, Eq. 1, to compare with.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct IdealTable {
    /// Wavelength of the sinusoidal polarization, in mm.
    #[schemars(extend("example" = "10.0"))]
    wavelength_mm: f64,
    /// Thickness of the film, in mm.
    #[schemars(extend("example" = "1.0"))]
    thickness_mm: f64,
    /// Amplitude m0 of each component of the polarization, in T.
    #[schemars(extend("example" = "0.12"))]
    amplitude_t: f64,
}

impl IdealTable {
    /// The ideal film, or `None` after adding its faults.
    pub(crate) fn resolve(&self, faults: &mut TableFaults) -> Option<IdealFilm> {
        check_material("amplitude_t", self.amplitude_t, faults);
        let broken = match IdealFilm::new(self.wavelength_mm, self.thickness_mm, self.amplitude_t) {
            Ok(film) => return Some(film),
            Err(broken) => broken.0,
        };
        for fault in broken {
            let (key, value) = match fault {
                IdealFilmFault::Wavelength(value) => ("wavelength_mm", value),
                IdealFilmFault::Thickness(value) => ("thickness_mm", value),
                IdealFilmFault::Amplitude(value) => ("amplitude_t", value),
                other => {
                    faults.add(other.to_string());
                    continue;
                }
            };
            faults.require(false, key, value, fault.rule());
        }
        None
    }
}

impl From<IdealFilm> for IdealTable {
    fn from(film: IdealFilm) -> IdealTable {
        let (wavelength_mm, thickness_mm, amplitude_t) = (film.wavelength(), film.thickness(), film.amplitude_t());
        IdealTable { wavelength_mm, thickness_mm, amplitude_t }
    }
}
