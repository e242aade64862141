//! The error of a parameter's change against the ideal film.

use glam::DVec3;

use crate::parameters::{Parameters, half_turn};
use crate::per_parameter::PerParameter;

/// The change of the parameters from `at_reference`, minus the change of the ideal film over the
/// displacement `moved`: -k x, -k y, k z.
pub(crate) fn ideal_error(p: &Parameters, at_reference: &Parameters, moved: DVec3, k: f64) -> PerParameter {
    PerParameter {
        r_x: half_turn(p.r_x - at_reference.r_x + k * moved.x),
        r_y: half_turn(p.r_y - at_reference.r_y + k * moved.y),
        s_z: p.s_z - at_reference.s_z - k * moved.z,
    }
}

/// Sums of the squares of errors.
#[derive(Default)]
pub(crate) struct SquareSums {
    sums: PerParameter,
    count: f64,
}

impl SquareSums {
    pub(crate) fn add(&mut self, error: PerParameter) {
        self.sums.r_x += error.r_x.powi(2);
        self.sums.r_y += error.r_y.powi(2);
        self.sums.s_z += error.s_z.powi(2);
        self.count += 1.0;
    }

    /// The root mean squares; NaN without errors.
    pub(crate) fn rmse(&self) -> PerParameter {
        let root = |sum: f64| (sum / self.count).sqrt();
        PerParameter { r_x: root(self.sums.r_x), r_y: root(self.sums.r_y), s_z: root(self.sums.s_z) }
    }
}
