//! The distances at which each method of a cluster reaches the error bound.

use glam::DVec3;
use magsplice_cuboid::block::Block;
use magsplice_cuboid::method::{MOST_FAR, Method, MethodRanges, series, squared};
use magsplice_cuboid::shape::Shape;
use magsplice_cuboid::tolerances::{MULTIPOLE_ORDERS, SINGLE_TILE_COST, SMALLER_ANGLE};
use magsplice_expansion::tolerances::EXPANSION_DEGREES;
use magsplice_simd::power_of_two::power_of_two_reciprocal;

use super::corner_tables::CornerTables;
use crate::tolerances::{GROUP_DISTANCE, LARGEST_ERROR_OF_PART, PRODUCT_RANGE, SMALL_GROUP, STRETCH};

const _: () = assert!(MULTIPOLE_ORDERS.len() + EXPANSION_DEGREES.len() < MOST_FAR);

/// Centre and half size of the box around blocks of one frame.
fn around(blocks: &[Block]) -> ([f64; 3], [f64; 3]) {
    let face = |block: &Block, axis: usize, upper: usize| block.faces[axis][upper].hi;
    let least = [0, 1, 2].map(|axis| blocks.iter().map(|b| face(b, axis, 0)).fold(f64::INFINITY, f64::min));
    let most = [0, 1, 2].map(|axis| blocks.iter().map(|b| face(b, axis, 1)).fold(f64::NEG_INFINITY, f64::max));
    let middle = [0, 1, 2].map(|axis: usize| 0.5 * least[axis] + 0.5 * most[axis]);
    (middle, [0, 1, 2].map(|axis: usize| 0.5 * most[axis] - 0.5 * least[axis]))
}

/// Radius of the sphere around the box of the blocks.
pub(super) fn radius_of(blocks: &[Block]) -> f64 {
    let [x, y, z] = around(blocks).1;
    x.hypot(y).hypot(z)
}

/// The power of two that brings the lengths of a cluster to order one.
pub(super) fn scale_of(blocks: &[Block]) -> f64 {
    power_of_two_reciprocal(around(blocks).1.into_iter().fold(0.0, f64::max))
}

/// Whether the closed form of a cluster extends at least as far from its centre as the cluster.
pub(super) fn is_compact(ranges: &MethodRanges) -> bool {
    ranges.closed_form_to >= ranges.half_size.iter().map(|h| h * h).sum()
}

/// The ranges of a cluster.
///
/// `parts` are the cuboids of the closed form, with their tables, and `tiles` is the number of
/// cuboids of the other methods.
pub(super) fn ranges_of_cluster(parts: &[Block], tables: &CornerTables, tiles: usize) -> MethodRanges {
    let (centre, half) = around(parts);
    let scale = scale_of(parts);
    let half_size = half.map(|h| h * scale);
    let radius = half_size.iter().map(|h| h * h).sum::<f64>().sqrt();
    let shapes: Vec<Shape> = parts.iter().map(|b| Shape::new(b, scale)).collect();
    let most_of = |length: fn(&Shape) -> f64| shapes.iter().map(length).fold(0.0, f64::max);
    let forms = tables.tiles.iter().map(|tile| tile.form);
    let nearest =
        shapes.iter().zip(forms.clone()).map(|(shape, form)| shape.closed_form_from(form)).fold(0.0, f64::max);
    let group_volume = tables.largest_group_volume;
    let near = nearest.max(GROUP_DISTANCE * group_volume.cbrt()).max(1.0 / PRODUCT_RANGE);
    // The error of a part is its field, about |J| volume / distance^3, times the ratio of the
    // distance to its second side, or to the longest side of a rod.
    let magnitude = |(block, shape): (&Block, &Shape)| {
        shape.volume * block.polarization_t.abs().element_sum().max(f64::MIN_POSITIVE)
    };
    let magnitudes: Vec<f64> = parts.iter().zip(&shapes).map(magnitude).collect();
    let reaches: Vec<f64> = shapes.iter().zip(forms).map(|(shape, form)| shape.closed_form_to(form)).collect();
    let per_reach: f64 = magnitudes.iter().zip(&reaches).map(|(magnitude, reach)| magnitude / reach).sum();
    let mean_reach = magnitudes.iter().sum::<f64>() / per_reach;
    let least_reach = reaches.iter().copied().fold(f64::INFINITY, f64::min);
    let reach = mean_reach.min(LARGEST_ERROR_OF_PART * least_reach).min(PRODUCT_RANGE);
    let closed_form_to = (reach - radius).max(0.0);
    let stretched = ((STRETCH * reach).min(PRODUCT_RANGE) - radius).max(0.0);
    let half_diagonal = most_of(|s| s.half_diagonal);
    let sphere = farthest_corner(parts, centre) * scale;
    let expansions =
        EXPANSION_DEGREES.into_iter().map(|(degree, radii)| (radii * sphere, Method::Expansion { degree }));
    // Orders slower than the closed form of one tile are used where no method evaluates the cluster
    // as a whole.
    let series = series(|half_diagonals| half_diagonals * half_diagonal + radius);
    let candidates: Vec<(f64, Method)> =
        series.filter(|(_, method)| method.cost(1) <= SINGLE_TILE_COST).chain(expansions).collect();
    MethodRanges {
        scale,
        centre,
        half_size,
        closed_form_from: near * near,
        small_elements_from: f64::INFINITY,
        small_elements_from_centre: f64::INFINITY,
        small_groups_from: if tables.has_rods || tables.largest_group > SMALL_GROUP {
            f64::INFINITY
        } else {
            (group_volume / SMALLER_ANGLE).cbrt().powi(2)
        },
        closed_form_to: closed_form_to * closed_form_to,
        stretched_closed_form_to: stretched * stretched,
        far: cheapest(&candidates, tiles, closed_form_to).into_iter().map(squared).collect(),
    }
}

/// The fastest of the candidates at each distance. Each candidate applies from its own distance on.
/// No candidate applies where the closed form, which ends at `closed_form_to`, is faster.
fn cheapest(candidates: &[(f64, Method)], tiles: usize, closed_form_to: f64) -> Vec<(f64, Method)> {
    let mut distances: Vec<f64> = candidates.iter().map(|(least, _)| *least).chain([closed_form_to]).collect();
    distances.sort_by(f64::total_cmp);
    let mut steps: Vec<(f64, Method)> = Vec::new();
    for distance in distances {
        let usable = candidates.iter().filter(|(least, _)| *least <= distance).map(|(_, method)| *method);
        let Some(best) = usable.min_by(|a, b| a.cost(tiles).total_cmp(&b.cost(tiles))) else { continue };
        let closed_form_is_cheaper = distance < closed_form_to && best.cost(tiles) > Method::ClosedForm.cost(tiles);
        if !closed_form_is_cheaper && steps.last().is_none_or(|(_, method)| *method != best) {
            steps.push((distance, best));
        }
    }
    steps
}

/// Distance of the farthest corner of the blocks from `centre`.
pub fn farthest_corner(blocks: &[Block], centre: [f64; 3]) -> f64 {
    let corner = |block: &Block| {
        let reach = |axis: usize| {
            let [low, high] = block.faces[axis];
            (low.hi - centre[axis]).abs().max((high.hi - centre[axis]).abs())
        };
        DVec3::from([0, 1, 2].map(reach)).length()
    };
    blocks.iter().map(corner).fold(0.0, f64::max)
}
