//! The interface through which direct summation uses the far field of a cluster within a tolerance.

use fearless_simd::Level;

/// The field of a cluster outside a sphere around it, within a tolerance.
pub(crate) trait FarField {
    /// mu0 H in tesla, in the frame of the scene, at points given by axis. `degrees` receives the
    /// degree and the truncation error for each
    /// [`POINTS_PER_DEGREE`](magsplice_expansion::tolerances::POINTS_PER_DEGREE) points.
    fn fields(&self, level: Level, points: [&[f64]; 3], fields: [&mut [f64]; 3], degrees: &mut DegreesByPoints);
}

/// The degree of an expansion for each
/// [`POINTS_PER_DEGREE`](magsplice_expansion::tolerances::POINTS_PER_DEGREE) neighbouring points.
#[derive(Debug, Default)]
pub(crate) struct DegreesByPoints {
    /// The degree.
    pub(crate) degree: Vec<usize>,
    /// Upper bound of its truncation error, in tesla.
    pub(crate) truncation_error_t: Vec<f64>,
}

impl DegreesByPoints {
    /// Removes all points.
    pub(crate) fn clear(&mut self) {
        self.degree.clear();
        self.truncation_error_t.clear();
    }
}

/// A sphere in the frame of the scene, and the far field outside it.
#[derive(Clone, Copy)]
pub(crate) struct BeyondSphere<'a> {
    pub(crate) centre: [f64; 3],
    pub(crate) radius_squared: f64,
    pub(crate) far_field: &'a dyn FarField,
}
