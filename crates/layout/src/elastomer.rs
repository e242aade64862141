//! `[elastomer]`: the elastic layer between film and sensor.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{FINITE, POSITIVE, TableFaults};
use crate::one_or_three::OneOrThree;
use crate::written_as::{As, is_default};

/// Smallest Poisson ratio of a stable material.
const LEAST_POISSON_RATIO: f64 = -1.0;

/// Largest Poisson ratio, of a layer that keeps its volume.
const MOST_POISSON_RATIO: f64 = 0.5;

/// The elastic layer between film and sensor (Dai 2024, Eqs. 16 and 17).
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(rename = "ElastomerTable")]
pub struct Elastomer {
    /// Contact area, in mm^2.
    pub area_mm2: f64,
    /// Thickness without load, in mm.
    pub thickness_mm: f64,
    /// Young's modulus, in MPa.
    pub youngs_modulus_mpa: f64,
    /// Poisson ratio: above -1, and at most 0.5.
    pub poisson_ratio: f64,
    /// Calibrated stiffness over that of Eqs. 16 and 17 along x, y, z: the coefficients a_1 to a_3.
    /// Default: 1.
    #[serde(default = "one", skip_serializing_if = "is_one", with = "As::<OneOrThree>")]
    #[schemars(with = "Option<OneOrThree>")]
    pub scale: DVec3,
    /// Calibrated force without displacement along x, y, z, in N: the coefficients b_1 to b_3.
    /// Default: 0.
    #[serde(default, skip_serializing_if = "is_default", with = "As::<OneOrThree>")]
    #[schemars(with = "Option<OneOrThree>")]
    pub force_at_rest_n: DVec3,
}

fn one() -> DVec3 {
    DVec3::ONE
}

fn is_one(scale: &DVec3) -> bool {
    *scale == DVec3::ONE
}

impl Elastomer {
    /// Force over displacement along each axis by Hooke's law, in N/mm: A G / h in shear with
    /// G = E / (2 (1 + nu)), and A E / h normal to the layer.
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

    /// Adds the faults of the layer.
    pub(crate) fn check(&self, faults: &mut TableFaults) {
        let before = faults.count();
        faults.number("area_mm2", self.area_mm2, POSITIVE);
        faults.number("thickness_mm", self.thickness_mm, POSITIVE);
        faults.number("youngs_modulus_mpa", self.youngs_modulus_mpa, POSITIVE);
        let is_stable = self.poisson_ratio > LEAST_POISSON_RATIO && self.poisson_ratio <= MOST_POISSON_RATIO;
        let rule = format_args!("must be above {LEAST_POISSON_RATIO} and at most {MOST_POISSON_RATIO}");
        faults.require(is_stable, "poisson_ratio", self.poisson_ratio, rule);
        OneOrThree::from(self.scale).check("scale", POSITIVE, faults);
        OneOrThree::from(self.force_at_rest_n).check("force_at_rest_n", FINITE, faults);
        let stiffness = self.stiffness_n_per_mm();
        if faults.count() == before && !(stiffness.is_finite() && stiffness.cmpgt(DVec3::ZERO).all()) {
            faults.add(format!("the stiffness is {stiffness} N/mm, must be a finite number greater than 0"));
        }
    }
}
