//! Films in numbers a workshop can use.

use glam::DVec3;
use magsplice_field::Tile;

use crate::affine::Affine;
use crate::descent::Found;
use crate::pattern::{Pattern, Shape, image, unit_vector};
use crate::setting::Setting;

/// The tiles of a film with faces and angles at multiples of the resolution, as far as they were free.
///
/// Faces that touch are rounded alike, so they touch afterwards and nothing overlaps. Where a size is shared, or only centres move, sizes and centres are rounded;
/// these films are made with room for that.
pub(crate) fn rounded(setting: &Setting, pattern: &Pattern, found: &Found) -> Option<Vec<Tile>> {
    let mut tiles = vec![None; pattern.tiles];
    for shape in &pattern.shapes {
        let tile = rounded_tile(setting, shape, &found.at)?;
        for &(operation, index) in &shape.orbit.images {
            tiles[index] = Some(image(&tile, operation)?);
        }
    }
    tiles.into_iter().collect()
}

fn rounded_tile(setting: &Setting, shape: &Shape, at: &[f64]) -> Option<Tile> {
    let step = setting.brief.resolution_mm;
    let (mut position, mut size) = (DVec3::ZERO, DVec3::ZERO);
    for axis in 0..3 {
        let [lower, upper] = &shape.faces[axis];
        let centre = lower.plus(upper).times(0.5);
        let side = upper.minus(lower);
        let free = |number: &Affine| !number.terms.is_empty();
        if axis < 2 && free(lower) && free(upper) && !shape.by_centre {
            let [lower, upper] = [lower, upper].map(|face| to_multiple(face.at(at), step));
            (position[axis], size[axis]) = (decimal(0.5 * (lower + upper)), decimal(upper - lower));
        } else {
            let place = |number: &Affine, step: f64| {
                if free(number) { to_multiple(number.at(at), step) } else { number.constant }
            };
            // About a centre that stays a tile only becomes smaller, so that it keeps its distance.
            size[axis] = if axis < 2 && free(&side) && !free(&centre) && !shape.shares_size {
                decimal((side.at(at) / step + WHOLE).floor() * step).max(setting.problem.bounds.smallest_cut_mm)
            } else {
                place(&side, step)
            };
            // On a lower face that stays the centre follows the size.
            position[axis] = match axis {
                2 => decimal(lower.at(at) + 0.5 * size[axis]),
                _ if free(&centre) => {
                    let [low, high] = setting.problem.bounds.outline_mm[axis];
                    let half = 0.5 * size[axis];
                    decimal(place(&centre, step).min(high - half).max(low + half))
                }
                _ => centre.constant,
            };
        }
    }
    let strength = shape.strength.at(at);
    let free_angle = !shape.direction.terms.is_empty() || !shape.tilt.terms.is_empty();
    let j = if free_angle {
        let step = setting.brief.resolution_deg;
        let in_degrees = [&shape.direction, &shape.tilt].map(|angle| to_multiple(angle.at(at).to_degrees(), step));
        strength * unit_vector(in_degrees)
    } else {
        shape.polarization_t(at)
    };
    Tile::new(position, size, j).ok()?.rotated(shape.rotation).ok()
}

/// A size this fraction of a step below a multiple is that multiple.
const WHOLE: f64 = 1e-3;

/// The nearest multiple, as its decimals say it.
pub(crate) fn to_multiple(value: f64, step: f64) -> f64 {
    decimal((value / step).round() * step)
}

/// The same number without the noise of its last digits: 0.1 + 0.2 is 0.3.
pub(crate) fn decimal(value: f64) -> f64 {
    format!("{value:.12}").parse::<f64>().unwrap_or(value) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_are_decimals() {
        assert_eq!(to_multiple(0.30000000000000004, 0.1), 0.3);
        assert_eq!(to_multiple(-2.3456, 0.001), -2.346);
        assert_eq!(to_multiple(-1e-9, 0.001).to_bits(), 0.0_f64.to_bits());
    }
}
