//! The uniformity of parameters measured at points on planes.

use std::fmt;

use glam::DVec3;
use magsplice_magnet::Axis;

use crate::parameters::Parameters;
use crate::per_parameter::{Parameter, PerParameter};

/// Largest extent of a plane along its normal, as a fraction of the wavelength.
///
/// Parameters are moved to the middle of their plane by the slope of the ideal film, so only the
/// difference of the slopes remains. A film whose slope is off by 10 % adds at most 0.1 x 2 pi /
/// 100 / 2 = 0.003 to the deviation of a plane as wide as this; scatter of 2 um at a wavelength of
/// 10 mm adds 0.0001. The step of a scan is usually a twentieth of the wavelength.
const WIDEST_PLANE: f64 = 0.01;

/// Largest extent of a plane along its normal, as a fraction of the distance to the next plane. Of
/// random positions some are close together by chance, but gaps of all lengths occur between them.
/// Planes have a range of lengths without gaps.
const WIDEST_PLANE_OVER_GAP: f64 = 0.25;

/// The uniformity RMSE of R_x, R_y, S_z over points on planes normal to their own axes: the
/// population standard deviation over each plane, averaged over the planes with two points or more.
/// On a grid it is [`Decoupling::uniformity_rmse`](crate::Decoupling::uniformity_rmse).
///
/// # Planes
/// The positions need not lie exactly on planes, because stages return to a position only to some
/// micrometres. Points form a plane if their coordinates differ by at most a hundredth of the
/// wavelength, and by at most a quarter of the distance to any other plane. Parameters are moved to
/// the mean coordinate of their plane by the slope of the ideal film, -k, -k and k.
///
/// # Errors
/// [`NoPlanes`] for a parameter if fewer than half of the points share a plane with another, so
/// that the planes there are may be accidental.
///
/// # Panics
/// If the numbers of parameters and points differ.
pub fn uniformity_by_planes(
    points: &[DVec3],
    parameters: &[Parameters],
    wavelength: f64,
) -> PerParameter<Result<f64, NoPlanes>> {
    assert_eq!(points.len(), parameters.len(), "parameters at each point");
    let wavenumber = std::f64::consts::TAU / wavelength;
    let of = |parameter: Parameter| {
        let axis = parameter.axis();
        let slope = if parameter == Parameter::Sz { wavenumber } else { -wavenumber };
        let mut values: Vec<(f64, f64)> =
            points.iter().zip(parameters).map(|(point, all)| (point[axis.index()], all.get(parameter))).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let coordinates: Vec<f64> = values.iter().map(|(at, _)| *at).collect();
        let widest = WIDEST_PLANE * wavelength;
        let within_plane = largest_gap_in_planes(&coordinates, widest).ok_or(NoPlanes { axis, widest_mm: widest })?;
        let deviations: Vec<f64> = values
            .chunk_by(|a, b| b.0 - a.0 <= within_plane)
            .filter(|plane| plane.len() > 1)
            .map(|plane| deviation_over(plane, slope))
            .collect();
        Ok(deviations.iter().sum::<f64>() / deviations.len() as f64)
    };
    Parameter::ALL.map(of).into()
}

/// Fewer than half of the points share a plane normal to an axis with another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoPlanes {
    /// The normal of the planes.
    pub axis: Axis,
    /// Largest extent of a plane along its normal, a hundredth of the wavelength, in the unit of
    /// lengths, which is millimetres in layouts.
    pub widest_mm: f64,
}

impl fmt::Display for NoPlanes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let NoPlanes { axis, widest_mm } = self;
        write!(
            f,
            "most positions share no plane normal to {axis} with another: {axis} must differ by at most {widest_mm} \
             mm (a hundredth of the wavelength) in a plane, and by four times as much from plane to plane"
        )
    }
}

impl std::error::Error for NoPlanes {}

#[cfg(feature = "serde")]
impl serde::Serialize for NoPlanes {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The population standard deviation of values, given with their coordinates, after moving each to
/// the mean coordinate by `slope`.
fn deviation_over(plane: &[(f64, f64)], slope: f64) -> f64 {
    let count = plane.len() as f64;
    let middle = plane.iter().map(|(at, _)| at).sum::<f64>() / count;
    let moved: Vec<f64> = plane.iter().map(|(at, value)| value - slope * (at - middle)).collect();
    let mean = moved.iter().sum::<f64>() / count;
    (moved.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// Largest gap between neighbours of one plane. `None` if fewer than half of the coordinates, given
/// in ascending order, share a plane with another.
///
/// Gaps are closed in ascending order. The coarsest division counts whose widest plane is at most
/// `widest`, and at most [`WIDEST_PLANE_OVER_GAP`] of the next gap.
fn largest_gap_in_planes(coordinates: &[f64], widest: f64) -> Option<f64> {
    let mut gaps: Vec<(f64, usize)> =
        coordinates.windows(2).enumerate().map(|(left, pair)| (pair[1] - pair[0], left)).collect();
    gaps.sort_by(|a, b| a.0.total_cmp(&b.0));
    // At the ends of each plane, its other end.
    let mut other_end: Vec<usize> = (0..coordinates.len()).collect();
    let (mut alone, mut extent) = (coordinates.len(), 0.0);
    let mut found = None;
    for (index, (gap, left)) in gaps.iter().enumerate() {
        let (low, high) = (other_end[*left], other_end[left + 1]);
        alone -= usize::from(low == *left) + usize::from(high == left + 1);
        (other_end[low], other_end[high]) = (high, low);
        extent = f64::max(extent, coordinates[high] - coordinates[low]);
        if extent > widest {
            break;
        }
        let next = gaps.get(index + 1).map_or(f64::INFINITY, |(gap, _)| *gap);
        let is_apart = next > *gap && extent <= WIDEST_PLANE_OVER_GAP * next;
        if is_apart && 2 * alone <= coordinates.len() {
            found = Some(*gap);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use magsplice_magnet::Grid;

    const WAVELENGTH: f64 = 10.0;

    /// Numbers from -1 to 1 that repeat in every run.
    fn scatter() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / 2_f64.powi(52) - 1.0
        }
    }

    /// Parameters with the slopes of the ideal film and uniformities of about 0.05.
    fn parameters(at: DVec3) -> Parameters {
        let k = std::f64::consts::TAU / WAVELENGTH;
        let error = 0.05 * (at.x + 2.0 * at.y + at.z).sin();
        Parameters { r_x: -k * at.x + error, r_y: -k * at.y + error, s_z: k * at.z + error }
    }

    fn uniformity(points: &[DVec3]) -> PerParameter<Result<f64, NoPlanes>> {
        let parameters: Vec<Parameters> = points.iter().map(|at| parameters(*at)).collect();
        uniformity_by_planes(points, &parameters, WAVELENGTH)
    }

    fn grid(step: f64) -> Vec<DVec3> {
        let upper = step * DVec3::new(4.0, 4.0, 2.0);
        Grid::new(-upper, upper, [9, 9, 5]).expect("a grid").points().collect()
    }

    #[test]
    fn planes_with_one_point_do_not_count() {
        let points = [DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 0.0, 0.0)];
        let parameters = [1.0, 3.0, 7.0].map(|value| Parameters { r_x: value, r_y: value, s_z: value });
        let PerParameter { r_x, r_y, s_z } = uniformity_by_planes(&points, &parameters, WAVELENGTH);
        // x = 0 has 1 and 3, y = 0 has 1 and 7, and z = 0 has all three of mean 11 / 3.
        assert_eq!((r_x, r_y), (Ok(1.0), Ok(3.0)));
        let variance = [1.0_f64, 3.0, 7.0].iter().map(|value| (value - 11.0 / 3.0).powi(2)).sum::<f64>() / 3.0;
        assert!((s_z.unwrap() - variance.sqrt()).abs() < 1e-14);
        for few in [&points[..1], &[]] {
            assert!(uniformity(few).to_array().iter().all(Result::is_err));
        }
    }

    /// Positions of a stage, in micrometres, also where many positions of a plane are equal.
    #[test]
    fn scattered_positions_form_the_planes_of_the_grid() {
        for (step, scatter_mm, digit) in
            [(0.5, 0.002, 1e4), (0.5, 0.002, 1e3), (0.5, 0.02, 1e4), (0.02, 0.001, 1e5), (0.05, 0.0, 1e4)]
        {
            let exact = uniformity(&grid(step)).map(Result::unwrap);
            let mut random = scatter();
            let mut moved = |c: f64| ((c + scatter_mm * random()) * digit).round() / digit;
            let points: Vec<DVec3> =
                grid(step).iter().map(|at| DVec3::new(moved(at.x), moved(at.y), moved(at.z))).collect();
            let found = uniformity(&points).map(Result::unwrap);
            for parameter in Parameter::ALL {
                let error = (found[parameter] - exact[parameter]).abs();
                // The error of the parameters changes by up to 0.1 per mm.
                assert!(error < 1e-9 + 0.1 * scatter_mm, "{step} {scatter_mm} {parameter:?}: {found:?} {exact:?}");
            }
        }
    }

    /// Random positions have neighbours, but no planes.
    #[test]
    fn accidental_planes_do_not_count() {
        for count in [10, 40, 405, 4000] {
            for digit in [1e9, 1e4] {
                let mut random = scatter();
                let mut coordinate = |half: f64| ((half * random()) * digit).round() / digit;
                let points: Vec<DVec3> =
                    (0..count).map(|_| DVec3::new(coordinate(2.0), coordinate(2.0), coordinate(1.0))).collect();
                for found in uniformity(&points).to_array() {
                    let reason = found.expect_err(&format!("{count} points")).to_string();
                    assert!(reason.contains("must differ by at most 0.1"), "{reason}");
                }
            }
        }
    }

    /// Positions of one plane, whose other coordinates are random.
    #[test]
    fn one_plane_is_enough() {
        let mut random = scatter();
        let points: Vec<DVec3> =
            (0..50).map(|_| DVec3::new(2.0 * random(), 2.0 * random(), -4.0 + 0.005 * random())).collect();
        let PerParameter { r_x, r_y, s_z } = uniformity(&points);
        assert!(r_x.is_err() && r_y.is_err() && s_z.unwrap() > 0.01);
    }
}
