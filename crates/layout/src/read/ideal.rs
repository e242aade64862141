//! `[ideal]`: the sinusoidal film to compare with.

use magsplice_ideal::{IdealFilm, IdealFilmFault};

use crate::read::faults::TableFaults;
use crate::read::strength_rules::check_material;
use crate::tables::ideal::IdealTable;

/// The ideal film, or `None` after adding its faults.
pub(crate) fn resolve(table: &IdealTable, faults: &mut TableFaults) -> Option<IdealFilm> {
    check_material("amplitude_t", table.amplitude_t, faults);
    IdealFilm::new(table.wavelength_mm, table.thickness_mm, table.amplitude_t)
        .map_err(|broken| {
            for fault in broken.0 {
                let rule = fault.rule();
                faults.add(match fault {
                    IdealFilmFault::Wavelength(value) => format!("wavelength_mm = {value}, {rule}"),
                    IdealFilmFault::Thickness(value) => format!("thickness_mm = {value}, {rule}"),
                    IdealFilmFault::Amplitude(value) => format!("amplitude_t = {value}, {rule}"),
                    other => other.to_string(),
                });
            }
        })
        .ok()
}
