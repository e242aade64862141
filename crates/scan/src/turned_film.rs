//! A turn of a film against the positions of its scan.

use glam::{DMat3, DVec3};

/// Residual with a turn over the residual without one, below which the turn is the explanation.
const EXPLAINED: f64 = 0.5;

/// A turn of the film about z against the positions of a scan.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct FilmTurn {
    /// The angle, right-handed about z, to 0.02 degrees.
    pub angle_deg: f64,
    /// Standard deviation of the residuals of one component with it.
    pub residual_t: f64,
    /// The same without a turn, by the same fit: it leaves out outliers. Infinite where that fit
    /// fails.
    pub unturned_t: f64,
}

impl FilmTurn {
    /// The scan in the frame of the film: positions about their middle and readings, turned back.
    pub fn undone(&self, points: &[DVec3], readings_t: &[DVec3]) -> (Vec<DVec3>, Vec<DVec3>) {
        let (middle, back) = (middle(points), FilmTurn::back(self.angle_deg));
        let places = points.iter().map(|point| middle + back * (*point - middle)).collect();
        (places, readings_t.iter().map(|reading_t| back * *reading_t).collect())
    }

    /// Whether it leaves less than half of the residual without a turn, that of another fit too.
    pub fn explains(&self, residual_t: f64) -> bool {
        self.is_below(EXPLAINED, residual_t)
    }

    /// Whether it leaves less than a share of the residual without a turn, that of another fit too.
    pub fn is_below(&self, share: f64, residual_t: f64) -> bool {
        self.residual_t < share * residual_t.min(self.unturned_t)
    }

    pub(crate) fn back(angle_deg: f64) -> DMat3 {
        DMat3::from_rotation_z(-angle_deg.to_radians())
    }
}

/// The middle of a scan.
pub(crate) fn middle(points: &[DVec3]) -> DVec3 {
    let [lower, upper] = [DVec3::min, DVec3::max].map(|bound| points.iter().copied().reduce(bound).unwrap_or_default());
    0.5 * (lower + upper)
}
