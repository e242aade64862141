//! The interface of direct summation to the far field of a cluster within a tolerance.

use fearless_simd::Level;

/// The field of a cluster outside a sphere around it, within a tolerance.
pub trait FarField {
    /// mu0 H in tesla, in the frame of the scene, at points given by axis. `degrees` receives the
    /// degree and the truncation error for each
    /// [`POINTS_PER_DEGREE`](magsplice_expansion::tolerances::POINTS_PER_DEGREE) points.
    fn fields(&self, level: Level, points: [&[f64]; 3], fields: [&mut [f64]; 3], degrees: &mut DegreesByPoints);
}

/// The degree of an expansion for each
/// [`POINTS_PER_DEGREE`](magsplice_expansion::tolerances::POINTS_PER_DEGREE) neighbouring points.
#[derive(Debug, Default)]
pub struct DegreesByPoints {
    /// The degree.
    pub degree: Vec<usize>,
    /// Upper bound of its truncation error, in tesla.
    pub truncation_error_t: Vec<f64>,
}

impl DegreesByPoints {
    /// Removes all points.
    pub fn clear(&mut self) {
        self.degree.clear();
        self.truncation_error_t.clear();
    }
}

/// A sphere in the frame of the scene, and the far field outside it.
#[derive(Clone, Copy)]
pub struct BeyondSphere<'a> {
    /// Centre of the sphere.
    pub centre: [f64; 3],
    /// Square of its radius.
    pub radius_squared: f64,
    /// The field outside it.
    pub far_field: &'a dyn FarField,
}
