//! Corners and planes shared by the tiles of a cluster, and groups of tiles of equal strength.

use std::f64::consts::PI;

use magsplice_cuboid::block::Block;
use magsplice_cuboid::closed_form::gradient::GradientTerms;
use magsplice_cuboid::closed_form::terms::{AA, BB, CC, Form, Group, Terms};
use magsplice_simd::compensated_sum::TwoSum;
use rustc_hash::FxHashMap;

use super::tile_terms::{NO_GROUP, OWN, TileTerms};
use crate::tolerances::{
    GROUP_DISTANCE, GROUP_THICKNESSES, MOST_CORNERS, MOST_GROUPS, MOST_PLANES, RODS_PER_GROUP, TILES_PER_GROUP,
};

/// The tables of a cluster for the closed form in vectors.
#[derive(Clone, Debug)]
pub struct CornerTables {
    /// Power of two that brings lengths to order one.
    pub scale: f64,
    /// Axis and coordinate of each plane.
    pub planes: Vec<(usize, TwoSum)>,
    /// The three planes that meet in each corner, two corners at a time.
    pub corners: Vec<[[u16; 3]; 2]>,
    /// Number of such pairs for half a tile, rounded up.
    pub corner_pairs_per_step: usize,
    /// The terms of each tile.
    pub tiles: Vec<TileTerms>,
    /// Tiles that share a product.
    pub groups: Vec<Group>,
    /// Largest total volume of the tiles of a group, or of a single tile, scaled.
    pub largest_group_volume: f64,
    /// Largest number of tiles in one group.
    pub largest_group: usize,
    /// Whether some of the tiles are rods.
    pub has_rods: bool,
}

impl CornerTables {
    /// Tables of `blocks` in these forms, whose lengths `scale` brings to order one; `None` if the
    /// tables would be too long.
    pub(super) fn new(blocks: &[Block], forms: &[Form], scale: f64) -> Option<CornerTables> {
        let thickness = |b: &Block| b.size.iter().copied().fold(f64::INFINITY, f64::min) * scale;
        let thickest = blocks.iter().map(thickness).fold(0.0, f64::max);
        let most_volume = (GROUP_THICKNESSES / GROUP_DISTANCE * thickest).powi(3);
        let (mut numbers, mut groups) = (Numbers::default(), OpenGroups { most_volume, ..OpenGroups::default() });
        let mut tiles: Vec<TileTerms> = blocks
            .iter()
            .zip(forms)
            .map(|(block, &form)| {
                let (planes, corners) = numbers.place(block);
                let terms = Terms::new(block, scale, form);
                let numbers = [0, 1, 2, 3, 4, 5].map(|element: usize| groups.number_of(element, &terms));
                TileTerms::new(&terms, planes, corners, numbers)
            })
            .collect();
        groups.leave_alone(&mut tiles);
        let fits = numbers.corners.len() <= MOST_CORNERS
            && numbers.planes.len() <= MOST_PLANES
            && groups.all.len() <= MOST_GROUPS;
        let corners: Vec<[[u16; 3]; 2]> =
            numbers.corners.chunks(2).map(|pair| [pair[0], *pair.last().expect("one or two")]).collect();
        let corner_pairs_per_step = corners.len().div_ceil(2 * tiles.len().max(1));
        fits.then_some(CornerTables {
            scale,
            planes: numbers.planes,
            corners,
            corner_pairs_per_step,
            tiles,
            groups: groups.all,
            largest_group_volume: groups.largest_volume,
            largest_group: groups.largest,
            has_rods: forms.contains(&Form::Rod),
        })
    }
}

impl CornerTables {
    /// The terms of the gradient of a tile in these tables.
    pub fn gradient_terms(&self, tile: &TileTerms) -> GradientTerms {
        let axes = [0, 2, 4].map(|plane: usize| self.planes[usize::from(tile.planes[plane])].0);
        // A coefficient has the sign of the factor of its element. T_cc is an element, or minus the
        // sum of the other two.
        let part = |element: usize, along: usize| {
            tile.coefficients[element][axes[along]] * 2.0 * PI * tile.factors[element].signum()
        };
        let polarization_t = [part(AA, 0), part(BB, 1), part(CC, 2) - part(AA, 2)];
        GradientTerms::new(axes, tile.squares.map(f64::sqrt), polarization_t, self.scale)
    }
}

/// Groups by kind and coefficient. Another group of the same kind follows a full group.
#[derive(Default)]
struct OpenGroups {
    all: Vec<Group>,
    /// Number, tiles and volume of the group that takes the next term.
    open: FxHashMap<(bool, [u64; 3]), (u16, usize, f64)>,
    most_volume: f64,
    largest_volume: f64,
    largest: usize,
}

impl OpenGroups {
    fn number_of(&mut self, element: usize, terms: &Terms) -> u16 {
        if !terms.is_needed(element) {
            return NO_GROUP;
        }
        let key = (element >= AA, terms.coefficients[element].map(f64::to_bits));
        let volume = terms.volume();
        let most = if terms.form == Form::Rod { RODS_PER_GROUP } else { TILES_PER_GROUP };
        let open = self.open.get(&key).copied();
        let (number, tiles, volume) = match open {
            Some((number, tiles, sum)) if tiles < most && sum + volume <= self.most_volume => {
                (number, tiles + 1, sum + volume)
            }
            _ => {
                self.all.push(terms.group(element));
                ((self.all.len() - 1) as u16, 1, volume)
            }
        };
        self.largest_volume = self.largest_volume.max(volume);
        self.largest = self.largest.max(tiles);
        self.open.insert(key, (number, tiles, volume));
        number
    }

    /// Removes groups of a single element, which need no table.
    fn leave_alone(&mut self, tiles: &mut [TileTerms]) {
        let mut counts = vec![0; self.all.len()];
        for number in tiles.iter().flat_map(|tile| tile.groups).filter(|number| *number != NO_GROUP) {
            counts[usize::from(number)] += 1;
        }
        let mut left = 0;
        let numbers: Vec<u16> = counts
            .iter()
            .map(|&count| {
                left += u16::from(count > 1);
                if count > 1 { left - 1 } else { OWN }
            })
            .collect();
        for tile in tiles {
            for number in tile.groups.iter_mut().filter(|number| **number != NO_GROUP) {
                *number = numbers[usize::from(*number)];
            }
            tile.has_own = tile.groups.contains(&OWN);
        }
        let mut number = 0;
        self.all.retain(|_| {
            number += 1;
            counts[number - 1] > 1
        });
    }
}

/// Numbers of distinct planes and corners.
#[derive(Default)]
struct Numbers {
    planes: Vec<(usize, TwoSum)>,
    corners: Vec<[u16; 3]>,
    known_planes: [FxHashMap<[u64; 2], u16>; 3],
    known_corners: FxHashMap<[u16; 3], u16>,
}

impl Numbers {
    fn place(&mut self, block: &Block) -> ([[u16; 2]; 3], [u16; 8]) {
        let planes = [0, 1, 2].map(|axis: usize| block.faces[axis].map(|plane| self.plane(axis, plane)));
        let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|corner: usize| {
            let at = [planes[0][corner >> 2], planes[1][corner >> 1 & 1], planes[2][corner & 1]];
            *self.known_corners.entry(at).or_insert_with(|| {
                self.corners.push(at);
                (self.corners.len() - 1) as u16
            })
        });
        (planes, corners)
    }

    fn plane(&mut self, axis: usize, plane: TwoSum) -> u16 {
        let planes = &mut self.planes;
        *self.known_planes[axis].entry([plane.hi.to_bits(), plane.lo.to_bits()]).or_insert_with(|| {
            planes.push((axis, plane));
            (planes.len() - 1) as u16
        })
    }
}
