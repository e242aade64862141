//! Mirror planes of a set of tiles, and the cells that represent all cells.
//!
//! A mirror maps a polarization as an axial vector, unchanged along the axis and reversed across
//! it, or to its opposite. Where each tile has an image among the tiles, the solution has the same
//! planes: one cell of each orbit is unknown.

use glam::{DQuat, DVec3};
use magsplice_magnet::{BoundingBox, IronPlanes};

use crate::cells::cell_counts;
use crate::division::Division;
use crate::material::RecoilTile;
use crate::tolerances::MIRROR_ERROR;

/// The cells that represent all cells, and the images of each cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Orbits {
    /// One cell of each orbit.
    pub(crate) representatives: Vec<usize>,
    /// For each product of mirrors the image of each cell, and the signs of the components of its
    /// polarization. The first is the identity.
    pub(crate) images: Vec<(Vec<usize>, DVec3)>,
}

/// A plane through the centre of all tiles, across an axis.
struct Mirror {
    axis: usize,
    /// Image of each tile.
    images: Vec<usize>,
    /// Signs of the components of the polarization.
    signs: DVec3,
}

impl Orbits {
    /// Orbits of one cell each.
    pub(crate) fn trivial(count: usize) -> Orbits {
        Orbits { representatives: (0..count).collect(), images: vec![((0..count).collect(), DVec3::ONE)] }
    }

    /// The orbits of cells under the mirrors of their tiles and of the iron.
    pub(crate) fn new(tiles: &[RecoilTile], division: &Division, iron: &IronPlanes, level: usize) -> Orbits {
        let mut orbits = Orbits::trivial(division.cells.len());
        let keeps_iron = |mirror: &Mirror| iron.planes().iter().all(|plane| plane.normal()[mirror.axis] == 0.0);
        let mirrors = mirrors(tiles).into_iter().filter(keeps_iron);
        let mut starts = vec![0];
        for each in tiles {
            starts.push(starts[starts.len() - 1] + cell_counts(each.tile.size(), level).iter().product::<usize>());
        }
        for Mirror { axis, images, signs } in mirrors {
            let mut mirrored = Vec::with_capacity(division.cells.len());
            for (tile, image) in images.iter().enumerate() {
                // Cells are numbered along x first; cells of equal tiles correspond.
                let counts = cell_counts(tiles[tile].tile.size(), level);
                let stride: usize = counts[..axis].iter().product();
                mirrored.extend((0..starts[tile + 1] - starts[tile]).map(|cell| {
                    let along = cell / stride % counts[axis];
                    starts[*image] + cell + (counts[axis] - 1) * stride - 2 * along * stride
                }));
            }
            let products: Vec<_> = orbits
                .images
                .iter()
                .map(|(images, own)| (images.iter().map(|image| mirrored[*image]).collect(), *own * signs))
                .collect();
            orbits.images.extend(products);
        }
        let images = &orbits.images;
        orbits.representatives.retain(|cell| images.iter().all(|(images, _)| images[*cell] >= *cell));
        orbits
    }

    /// The number of products of mirrors that keep a cell in its place.
    pub(crate) fn stabilizer(&self, cell: usize) -> usize {
        self.images.iter().filter(|(images, _)| images[cell] == cell).count()
    }

    /// The values of all cells from the values of the representatives. Components reversed by a
    /// plane through a cell vanish.
    pub(crate) fn expand(&self, values: &[DVec3]) -> Vec<DVec3> {
        let mut all = vec![DVec3::ZERO; self.images[0].0.len()];
        for (cell, value) in self.representatives.iter().zip(values) {
            let own = self.images.iter().filter(|(images, _)| images[*cell] == *cell);
            let kept = own.fold(DVec3::ONE, |kept, (_, signs)| kept * (0.5 * (*signs + 1.0)));
            for (images, signs) in &self.images {
                all[images[*cell]] = kept * *value * *signs;
            }
        }
        all
    }
}

/// The mirrors that map all tiles to tiles.
fn mirrors(tiles: &[RecoilTile]) -> Vec<Mirror> {
    if tiles.iter().any(|each| each.tile.rotation() != DQuat::IDENTITY) {
        return Vec::new();
    }
    let bounds = BoundingBox::from_tiles(tiles.iter().map(|each| &each.tile));
    let (centre, size) = (bounds.centre(), bounds.upper - bounds.lower);
    let strongest = tiles.iter().map(|each| each.tile.polarization_t().length()).fold(0.0, f64::max);
    let of_axis = |axis: usize| {
        [1.0, -1.0].into_iter().find_map(|sign| {
            let signs = sign * (2.0 * DVec3::AXES[axis] - 1.0);
            let images = tiles
                .iter()
                .map(|each| {
                    let mut position = each.tile.position();
                    position[axis] = 2.0 * centre[axis] - position[axis];
                    tiles.iter().position(|other| {
                        let moved = (other.tile.position() - position).abs();
                        let resized = (other.tile.size() - each.tile.size()).abs();
                        let turned = other.tile.polarization_t() - signs * each.tile.polarization_t();
                        (moved + resized).max_element() <= MIRROR_ERROR * size.max_element()
                            && turned.length() <= MIRROR_ERROR * strongest
                            && other.permeability == each.permeability
                    })
                })
                .collect::<Option<Vec<usize>>>()?;
            Some(Mirror { axis, images, signs })
        })
    };
    (0..3).filter_map(of_axis).collect()
}
