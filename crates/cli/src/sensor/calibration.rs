//! Results of `calibrate`.

use magsplice::prelude::DVec3;
use magsplice::sensor::Stiffness;

/// The stiffness along x, y, z, in N/mm and N.
pub(crate) struct Calibration {
    /// Number of readings.
    pub(crate) readings: usize,
    /// Stiffness of [elastomer] by Hooke's law, in N/mm.
    pub(crate) hooke_n_per_mm: Option<DVec3>,
    /// By displacements from the field of the layout.
    pub(crate) by_field: [Stiffness; 3],
    /// By those of the closed form, with an ideal film.
    pub(crate) by_closed_form: Option<[Stiffness; 3]>,
}
