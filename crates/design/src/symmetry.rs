//! Which tiles are images of each other.

use glam::DVec3;
use magsplice_field::Tile;
use magsplice_layout::Symmetry;

use crate::tolerances::SAME_TILE;

/// A reflection or turn of the plane that maps the axes onto themselves, or nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Operation {
    /// Whether x and y are exchanged first.
    pub(crate) exchange: bool,
    /// What x and y are multiplied by then.
    pub(crate) signs: [f64; 2],
}

impl Operation {
    pub(crate) const IDENTITY: Operation = Operation { exchange: false, signs: [1.0, 1.0] };

    pub(crate) fn all(symmetry: Symmetry) -> Vec<Operation> {
        let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let plain = signs.map(|signs| Operation { exchange: false, signs });
        match symmetry {
            Symmetry::None => vec![Operation::IDENTITY],
            Symmetry::Mirror => plain.to_vec(),
            Symmetry::FourFold => {
                let exchanged = signs.map(|signs| Operation { exchange: true, signs });
                plain.into_iter().chain(exchanged).collect()
            }
        }
    }

    /// Of a point, or of an arrow: polarization is mapped like an arrow drawn on the tile, and so then is its field.
    pub(crate) fn of(self, v: DVec3) -> DVec3 {
        let (x, y) = if self.exchange { (v.y, v.x) } else { (v.x, v.y) };
        DVec3::new(self.signs[0] * x, self.signs[1] * y, v.z)
    }

    pub(crate) fn of_size(self, size: DVec3) -> DVec3 {
        self.of(size).abs()
    }

    pub(crate) fn inverse(self) -> Operation {
        let [x, y] = self.signs;
        Operation { signs: if self.exchange { [y, x] } else { [x, y] }, ..self }
    }
}

/// A tile and its images.
#[derive(Clone, Debug)]
pub(crate) struct Orbit {
    /// The tile that stands for all: where there is a choice, one with x >= y >= 0.
    pub(crate) tile: usize,
    /// The tiles, each with the operation that makes it of that one; that one first.
    pub(crate) images: Vec<(Operation, usize)>,
    /// Whether the tile lies on the mirrors x = 0, y = 0.
    pub(crate) on_mirror: [bool; 2],
    /// Whether it lies on the mirror x = y.
    pub(crate) on_diagonal: bool,
}

impl Orbit {
    /// Whether the plane direction of its polarization is given by the symmetry.
    pub(crate) fn is_fixed_direction(&self) -> bool {
        self.on_mirror[0] || self.on_mirror[1] || self.on_diagonal
    }
}

/// The tiles sorted into orbits, or those that lack an image.
pub(crate) fn orbits(tiles: &[Tile], symmetry: Symmetry) -> Result<Vec<Orbit>, Vec<usize>> {
    let operations = Operation::all(symmetry);
    let mut done = vec![false; tiles.len()];
    let mut orbits = Vec::new();
    let mut without = Vec::new();
    // From the domain x >= y >= 0 first, so that its tiles stand for the others.
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    if symmetry != Symmetry::None {
        let outside = |tile: &Tile| {
            let (p, slack) = (tile.position(), SAME_TILE * tile.size().max_element());
            p.x < -slack || p.y < -slack || (symmetry == Symmetry::FourFold && p.x < p.y - slack)
        };
        order.sort_by_key(|&index| outside(&tiles[index]));
    }
    for index in order {
        if done[index] {
            continue;
        }
        let tile = &tiles[index];
        let mut images: Vec<(Operation, usize)> = Vec::new();
        let (mut on_mirror, mut on_diagonal) = ([false; 2], false);
        for &operation in &operations {
            let Some(image) = tiles.iter().position(|other| is_image(tile, other, operation)) else {
                without.push(index);
                break;
            };
            if image == index {
                on_mirror[0] |= operation == Operation { exchange: false, signs: [-1.0, 1.0] };
                on_mirror[1] |= operation == Operation { exchange: false, signs: [1.0, -1.0] };
                on_diagonal |= operation == Operation { exchange: true, signs: [1.0, 1.0] };
            }
            if !images.iter().any(|(_, known)| *known == image) {
                images.push((operation, image));
                done[image] = true;
            }
        }
        orbits.push(Orbit { tile: index, images, on_mirror, on_diagonal });
    }
    without.sort_unstable();
    if without.is_empty() { Ok(orbits) } else { Err(without) }
}

fn is_image(tile: &Tile, other: &Tile, operation: Operation) -> bool {
    let slack = SAME_TILE * tile.size().max_element();
    let j = tile.scene_polarization_t();
    operation.of(tile.position()).distance(other.position()) <= slack
        && operation.of_size(tile.size()).distance(other.size()) <= slack
        && operation.of(j).distance(other.scene_polarization_t()) <= SAME_TILE * j.length()
        && (operation == Operation::IDENTITY
            || tile.rotation().is_near_identity() && other.rotation().is_near_identity())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_form_a_group() {
        let all = Operation::all(Symmetry::FourFold);
        let v = DVec3::new(1.0, 2.0, 3.0);
        for a in &all {
            assert_eq!(a.inverse().of(a.of(v)), v);
            for b in &all {
                assert_eq!(all.iter().filter(|c| c.of(v) == a.of(b.of(v))).count(), 1);
            }
        }
    }

    #[test]
    fn tiles_without_an_image_are_named() {
        let tile = |x: f64, y: f64, j: DVec3| Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, j).unwrap();
        let pair = [tile(2.0, 0.0, DVec3::X), tile(-2.0, 0.0, -DVec3::X)];
        let found = orbits(&pair, Symmetry::Mirror).unwrap();
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].tile, found[0].images.len(), found[0].on_mirror), (0, 2, [false, true]));
        // One tile for all that are images of each other.
        assert_eq!(orbits(&pair, Symmetry::FourFold).unwrap_err(), [0]);
        assert_eq!(orbits(&pair, Symmetry::None).unwrap().len(), 2);
        let odd = [tile(2.0, 0.0, DVec3::X), tile(-2.0, 0.0, DVec3::X)];
        assert_eq!(orbits(&odd, Symmetry::Mirror).unwrap_err(), [0, 1]);
    }
}
