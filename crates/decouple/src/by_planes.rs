//! The uniformity of parameters measured at points on planes.

use glam::DVec3;

use crate::parameters::Parameters;
use crate::per_parameter::{Parameter, PerParameter};

/// Largest difference of two coordinates of one plane, as a fraction of the extent of the points.
const SAME_PLANE: f64 = 1e-6;

/// The uniformity RMSE of R_x, R_y, S_z over points on planes normal to their own axes: the
/// population standard deviation over each plane, averaged over the planes with two points or more.
/// On a grid it is [`Decoupling::uniformity_rmse`](crate::Decoupling::uniformity_rmse). `None`
/// where no plane has two points.
///
/// # Panics
/// If the numbers of parameters and points differ.
pub fn uniformity_by_planes(points: &[DVec3], parameters: &[Parameters]) -> PerParameter<Option<f64>> {
    assert_eq!(points.len(), parameters.len(), "parameters at each point");
    let of = |parameter: Parameter| {
        let axis = parameter.axis().index();
        let mut values: Vec<(f64, f64)> =
            points.iter().zip(parameters).map(|(point, all)| (point[axis], all.get(parameter))).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let extent = values.last()?.0 - values.first()?.0;
        let planes = values.chunk_by(|a, b| b.0 - a.0 <= SAME_PLANE * extent);
        let deviations: Vec<f64> = planes
            .filter(|plane| plane.len() > 1)
            .map(|plane| {
                let count = plane.len() as f64;
                let mean = plane.iter().map(|(_, value)| value).sum::<f64>() / count;
                (plane.iter().map(|(_, value)| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
            })
            .collect();
        (!deviations.is_empty()).then(|| deviations.iter().sum::<f64>() / deviations.len() as f64)
    };
    Parameter::ALL.map(of).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_with_one_point_do_not_count() {
        let points = [DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 0.0, 0.0)];
        let parameters = [1.0, 3.0, 7.0].map(|value| Parameters { r_x: value, r_y: value, s_z: value });
        let PerParameter { r_x, r_y, s_z } = uniformity_by_planes(&points, &parameters);
        // x = 0 has 1 and 3, y = 0 has 1 and 7, and z = 0 has all three of mean 11 / 3.
        assert_eq!((r_x, r_y), (Some(1.0), Some(3.0)));
        let variance = [1.0_f64, 3.0, 7.0].iter().map(|value| (value - 11.0 / 3.0).powi(2)).sum::<f64>() / 3.0;
        assert!((s_z.unwrap() - variance.sqrt()).abs() < 1e-14);
        assert_eq!(uniformity_by_planes(&points[..1], &parameters[..1]), PerParameter::default());
    }
}
