//! Errors of the textbook closed form in single and in double precision.

use glam::DVec3;
use magsplice::field::{Quantity, Scene, Tile};
use magsplice_benches::{median, shipped_layout, working_volume};
use nalgebra::{RealField, convert};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::effort::DialEffort;

/// Median and largest relative error of |B|.
pub(crate) struct PrecisionErrors {
    pub(crate) median: f64,
    pub(crate) worst: f64,
}

/// Errors in single and in double precision.
pub(crate) struct PrecisionTable {
    /// Errors of random tiles at each distance, in sizes of the tile.
    pub(crate) by_distance: Vec<(f64, [PrecisionErrors; 2])>,
    /// Errors of the published film in its volume.
    pub(crate) film: [PrecisionErrors; 2],
}

/// Measures both precisions on random tiles and on the published film.
pub(crate) fn measure(effort: DialEffort) -> Result<PrecisionTable, String> {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let by_distance = [1.0, 3.0, 10.0, 30.0, 100.0, 1000.0].map(|distance| {
        let cases = (0..effort.single_cases).map(|_| {
            let mut vector = |from: f64, to: f64| DVec3::from([0, 1, 2].map(|_| random.random_range(from..to)));
            let (size, j, direction) = (vector(0.4, 1.0), vector(-1.0, 1.0), vector(-1.0, 1.0).normalize());
            (vec![Tile::new(DVec3::ZERO, size, j).expect("a valid tile")], vec![distance * direction])
        });
        errors(&cases.collect::<Vec<_>>()).map(|errors| (distance, errors))
    });
    let points = working_volume([11, 11, 6]).points().collect();
    let film = errors(&[(shipped_layout("published-film").bare_tiles(), points)])?;
    Ok(PrecisionTable { by_distance: by_distance.into_iter().collect::<Result<_, _>>()?, film })
}

/// Errors of both precisions against the exact field, over all cases.
fn errors(cases: &[(Vec<Tile>, Vec<DVec3>)]) -> Result<[PrecisionErrors; 2], String> {
    let mut all = [const { Vec::new() }; 2];
    for (tiles, points) in cases {
        let mut exact = vec![DVec3::ZERO; points.len()];
        Scene::new(tiles).field_into(Quantity::FluxDensity, points, &mut exact).map_err(|e| e.to_string())?;
        for (point, exact) in points.iter().zip(exact) {
            for (errors, found) in
                all.iter_mut().zip([textbook_field::<f32>(tiles, *point), textbook_field::<f64>(tiles, *point)])
            {
                errors.push((found - exact).length() / exact.length());
            }
        }
    }
    Ok(all.map(|e| PrecisionErrors { worst: e.iter().copied().fold(0.0, f64::max), median: median(e) }))
}

/// B of all tiles, computed in the precision of `T`.
fn textbook_field<T: RealField + Copy>(tiles: &[Tile], point: DVec3) -> DVec3 {
    let mut sum = [T::zero(); 3];
    for tile in tiles {
        let [half, j, offset] = [0.5 * tile.size(), tile.polarization_t(), point - tile.position()]
            .map(|v| v.to_array().map(|number| convert::<f64, T>(number)));
        let own = outside(half, j, offset);
        sum = [0, 1, 2].map(|axis| sum[axis] + own[axis]);
    }
    DVec3::from(sum.map(|b| nalgebra::try_convert(b).expect("a real number")))
}

/// B outside a cuboid as a sum over its corners (docs/physics.md, P1): arctangents on the diagonal,
/// logarithms off it.
fn outside<T: RealField + Copy>(half: [T; 3], j: [T; 3], point: [T; 3]) -> [T; 3] {
    let mut b = [T::zero(); 3];
    for corner in 0..8 {
        let side = [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { T::one() } else { -T::one() });
        let sign = side[0] * side[1] * side[2];
        let d = [0, 1, 2].map(|axis| point[axis] - side[axis] * half[axis]);
        let r = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        for row in 0..3 {
            let (next, last) = ((row + 1) % 3, (row + 2) % 3);
            b[row] += sign * j[row] * (d[next] * d[last] / (d[row] * r)).atan();
            b[row] -= sign * (j[next] * (d[last] + r).ln() + j[last] * (d[next] + r).ln());
        }
    }
    b.map(|b| b / (T::pi() * convert(4.0)))
}
