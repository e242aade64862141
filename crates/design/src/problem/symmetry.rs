//! Symmetry operations of the plane, and orbits: tiles that are images of each other.

use glam::DVec3;
use magsplice_layout::Symmetry;
use magsplice_magnet::Tile;

use crate::tolerances::SAME_TILE;

/// A reflection or rotation of the plane that maps the pair of axes onto itself; one of eight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SymmetryOperation {
    /// Whether x and y are exchanged first.
    pub(crate) exchange: bool,
    /// Factors of x and y after that, 1 or -1.
    pub(crate) signs: [f64; 2],
}

impl SymmetryOperation {
    pub(crate) const IDENTITY: SymmetryOperation = SymmetryOperation { exchange: false, signs: [1.0, 1.0] };

    /// All operations of a symmetry, the identity first.
    pub(crate) fn all(symmetry: Symmetry) -> Vec<SymmetryOperation> {
        let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let plain = signs.map(|signs| SymmetryOperation { exchange: false, signs });
        match symmetry {
            Symmetry::None => vec![SymmetryOperation::IDENTITY],
            Symmetry::Mirror => plain.to_vec(),
            Symmetry::FourFold => {
                let exchanged = signs.map(|signs| SymmetryOperation { exchange: true, signs });
                plain.into_iter().chain(exchanged).collect()
            }
        }
    }

    /// The image of a point or of an arrow. Polarization is mapped like an arrow drawn on the tile,
    /// and its field then is too.
    pub(crate) fn apply(self, v: DVec3) -> DVec3 {
        let (x, y) = if self.exchange { (v.y, v.x) } else { (v.x, v.y) };
        DVec3::new(self.signs[0] * x, self.signs[1] * y, v.z)
    }

    pub(crate) fn apply_to_size(self, size: DVec3) -> DVec3 {
        self.apply(size).abs()
    }

    pub(crate) fn inverse(self) -> SymmetryOperation {
        let [x, y] = self.signs;
        SymmetryOperation { signs: if self.exchange { [y, x] } else { [x, y] }, ..self }
    }
}

/// A tile and its images.
#[derive(Clone, Debug)]
pub(crate) struct Orbit {
    /// Index of the representative; where there is a choice, a tile with x >= y >= 0.
    pub(crate) tile: usize,
    /// Indices of all tiles, each with the operation that maps the representative to it; the
    /// representative first.
    pub(crate) images: Vec<(SymmetryOperation, usize)>,
    /// Whether the representative lies on the mirrors x = 0 and y = 0.
    pub(crate) on_mirror: [bool; 2],
    /// Whether the representative lies on the mirror x = y.
    pub(crate) on_diagonal: bool,
}

impl Orbit {
    /// Whether symmetry determines the direction of the polarization in the plane.
    pub(crate) fn is_fixed_direction(&self) -> bool {
        self.on_mirror[0] || self.on_mirror[1] || self.on_diagonal
    }
}

/// Sorts tiles into orbits.
///
/// # Errors
/// Indices of the tiles that lack an image.
pub(crate) fn orbits(tiles: &[Tile], symmetry: Symmetry) -> Result<Vec<Orbit>, Vec<usize>> {
    let operations = SymmetryOperation::all(symmetry);
    let mut done = vec![false; tiles.len()];
    let mut orbits = Vec::new();
    let mut without = Vec::new();
    // Tiles in the domain x >= y >= 0 come first, so that they become representatives.
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
        let mut images: Vec<(SymmetryOperation, usize)> = Vec::new();
        let (mut on_mirror, mut on_diagonal) = ([false; 2], false);
        for &operation in &operations {
            let Some(image) = tiles.iter().position(|other| is_image(tile, other, operation)) else {
                without.push(index);
                break;
            };
            if image == index {
                on_mirror[0] |= operation == SymmetryOperation { exchange: false, signs: [-1.0, 1.0] };
                on_mirror[1] |= operation == SymmetryOperation { exchange: false, signs: [1.0, -1.0] };
                on_diagonal |= operation == SymmetryOperation { exchange: true, signs: [1.0, 1.0] };
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

fn is_image(tile: &Tile, other: &Tile, operation: SymmetryOperation) -> bool {
    let slack = SAME_TILE * tile.size().max_element();
    let j = tile.scene_polarization_t();
    operation.apply(tile.position()).distance(other.position()) <= slack
        && operation.apply_to_size(tile.size()).distance(other.size()) <= slack
        && operation.apply(j).distance(other.scene_polarization_t()) <= SAME_TILE * j.length()
        && (operation == SymmetryOperation::IDENTITY
            || tile.rotation().is_near_identity() && other.rotation().is_near_identity())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_form_a_group() {
        let all = SymmetryOperation::all(Symmetry::FourFold);
        let v = DVec3::new(1.0, 2.0, 3.0);
        for a in &all {
            assert_eq!(a.inverse().apply(a.apply(v)), v);
            for b in &all {
                assert_eq!(all.iter().filter(|c| c.apply(v) == a.apply(b.apply(v))).count(), 1);
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
        // Tiles that are images of each other are named once.
        assert_eq!(orbits(&pair, Symmetry::FourFold).unwrap_err(), [0]);
        assert_eq!(orbits(&pair, Symmetry::None).unwrap().len(), 2);
        let odd = [tile(2.0, 0.0, DVec3::X), tile(-2.0, 0.0, DVec3::X)];
        assert_eq!(orbits(&odd, Symmetry::Mirror).unwrap_err(), [0, 1]);
    }

    /// Orbits under all symmetries: the first tile has x >= y >= 0, its images are those of the
    /// operations, and it knows the mirrors that it lies on.
    #[test]
    fn orbits_begin_in_the_first_eighth() {
        let tile = |x: f64, y: f64, j: DVec3| Tile::new(DVec3::new(x, y, 0.5), DVec3::new(1.0, 1.0, 2.0), j).unwrap();
        let images = |x: f64, y: f64, symmetry: Symmetry| -> Vec<Tile> {
            let mut tiles: Vec<Tile> = Vec::new();
            for operation in SymmetryOperation::all(symmetry).into_iter().rev() {
                let at = DVec3::new(x, y, 0.0);
                let image = operation.apply(at);
                if tiles.iter().all(|known| known.position().truncate() != image.truncate()) {
                    tiles.push(tile(image.x, image.y, operation.apply(at)));
                }
            }
            tiles
        };
        for (x, y, symmetry, count, on_mirror, on_diagonal) in [
            (3.0, 2.0, Symmetry::FourFold, 8, [false; 2], false),
            (3.0, 3.0, Symmetry::FourFold, 4, [false; 2], true),
            (3.0, 0.0, Symmetry::FourFold, 4, [false, true], false),
            (2.0, 3.0, Symmetry::Mirror, 4, [false; 2], false),
            (0.0, 3.0, Symmetry::Mirror, 2, [true, false], false),
        ] {
            let tiles = images(x, y, symmetry);
            assert_eq!(tiles.len(), count);
            let found = orbits(&tiles, symmetry).unwrap();
            assert_eq!(found.len(), 1, "{x} {y}");
            let Orbit { tile: first, images, .. } = &found[0];
            assert_eq!(tiles[*first].position().truncate().to_array(), [x, y]);
            assert_eq!((found[0].on_mirror, found[0].on_diagonal), (on_mirror, on_diagonal));
            assert_eq!(found[0].is_fixed_direction(), on_diagonal || on_mirror != [false; 2]);
            assert_eq!((images.len(), images[0]), (count, (SymmetryOperation::IDENTITY, *first)));
            for (operation, index) in images {
                assert_eq!(operation.apply(tiles[*first].position()), tiles[*index].position());
            }
        }
    }

    /// Positions, sizes and polarizations of images may differ by a millionth, and rotated tiles
    /// have no images.
    #[test]
    fn images_agree_to_a_millionth() {
        let tile = |x: f64, width: f64, j: f64| {
            Tile::new(DVec3::new(x, 0.0, 0.5), DVec3::new(width, 2.0, 1.0), DVec3::new(j, 0.0, 0.0)).unwrap()
        };
        let mirror = SymmetryOperation { exchange: false, signs: [-1.0, 1.0] };
        let first = tile(3.0, 4.0, 0.1);
        // A millionth of the longest side, 4 mm, and of the polarization.
        for (other, is_so) in [
            (tile(-3.0, 4.0, -0.1), true),
            (tile(-3.0 - 3.9e-6, 4.0, -0.1), true),
            (tile(-3.0 - 4.1e-6, 4.0, -0.1), false),
            (tile(-3.0, 4.0 + 3.9e-6, -0.1), true),
            (tile(-3.0, 4.0 + 4.1e-6, -0.1), false),
            (tile(-3.0, 4.0, -0.1 - 0.9e-7), true),
            (tile(-3.0, 4.0, -0.1 - 1.1e-7), false),
            (tile(-3.0, 4.0, 0.1), false),
        ] {
            assert_eq!(is_image(&first, &other, mirror), is_so, "{other:?}");
        }
        let turned = first.rotated(glam::DQuat::from_rotation_z(0.1)).unwrap();
        assert!(is_image(&turned, &turned, SymmetryOperation::IDENTITY));
        let half = tile(0.0, 4.0, 0.0);
        let turned = half.rotated(glam::DQuat::from_rotation_z(0.1)).unwrap();
        assert!(
            is_image(&half, &half, mirror) && !is_image(&half, &turned, mirror) && !is_image(&turned, &half, mirror)
        );
    }
}
