//! The sensor below a film, and the elastic layer between them.

use glam::DVec3;
use magsplice_magnet::HallSensor;

use crate::rotation::Rotation;

/// The sensor that a layout states.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedSensor {
    /// The part whose numbers it has where the layout gives no others.
    pub part: Option<String>,
    /// Readings per second.
    pub rate_hz: Option<f64>,
    /// The rotation as written, from which the one of `element` was computed.
    pub rotation: Option<Rotation>,
    /// What it reads. Lengths in millimetres.
    pub element: HallSensor,
}

/// The elastic layer between film and sensor, after Dai 2024, Eqs. 16 and 17.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastomer {
    /// Contact area.
    pub area_mm2: f64,
    /// Thickness without load.
    pub thickness_mm: f64,
    /// Young's modulus. 1 MPa is 1 N/mm^2.
    pub youngs_modulus_mpa: f64,
    /// Poisson ratio.
    pub poisson_ratio: f64,
    /// Calibrated stiffness over that of Hooke's law, along each axis: a_1, a_2, a_3.
    pub scale: DVec3,
    /// Calibrated force without displacement: b_1, b_2, b_3.
    pub force_at_rest_n: DVec3,
}

impl Elastomer {
    /// Force over displacement along each axis by Hooke's law, in N/mm: A G / h in shear with G = E
    /// / (2 (1
    /// + nu)), and A E / h normal to the layer.
    pub fn hooke_n_per_mm(&self) -> DVec3 {
        let normal = self.area_mm2 * self.youngs_modulus_mpa / self.thickness_mm;
        let shear = normal / (2.0 * (1.0 + self.poisson_ratio));
        DVec3::new(shear, shear, normal)
    }

    /// Force over displacement with the calibrated scale, in N/mm.
    pub fn stiffness_n_per_mm(&self) -> DVec3 {
        self.scale * self.hooke_n_per_mm()
    }

    /// The force that displaces the film by this much.
    pub fn force_n(&self, displacement_mm: DVec3) -> DVec3 {
        self.stiffness_n_per_mm() * displacement_mm + self.force_at_rest_n
    }
}
