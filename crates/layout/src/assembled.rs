//! Layouts whose tiles are moved, turned, selected, or joined with the tiles of another layout.
//!
//! Planes of iron move with the tiles. Other tables are unchanged, such as the working volume.
//! Requirements and the brief apply to the original film, and are left out.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};
use magsplice_magnet::{Tile, TileFaults};

use crate::expectations::Expectations;
use crate::layout::{Layout, NamedTile, WholeDisc};
use crate::material::Material;
use crate::rotation::Rotation;
use crate::tolerance::FilmTolerance;
use crate::units::ten_decimals;

/// Units of round-off, of the largest number of a sum, up to which the sum gets ten decimals. A sum
/// of decimal numbers differs by a few; the round-off of tiles that touch is far more.
const DECIMAL_ROUNDINGS: f64 = 8.0;

/// Largest element of the difference of a rotation from a rotation by quarter turns about the axes.
/// It is round-off: tiles turned by such an angle are as far from their places as by the last digit
/// of their coordinates.
const QUARTER_TURN_ROUNDING: f64 = 1e-14;

impl Layout {
    /// The layout with its tiles moved by a vector in millimetres. Sums of numbers of ten decimals
    /// have ten decimals.
    ///
    /// # Errors
    /// If a position is out of range.
    pub fn moved(mut self, shift_mm: DVec3) -> Result<Layout, TileFaults> {
        self.iron = self.iron.after(|point| sum(point, shift_mm), |normal| normal);
        self.with_each_tile(|named| {
            let tile = named.tile;
            let moved = Tile::new(sum(tile.position(), shift_mm), tile.size(), tile.polarization_t())?;
            Ok(NamedTile { tile: moved.rotated(tile.rotation())?, ..named })
        })
    }

    /// The layout with its tiles turned as one rigid body about a point in millimetres. Quarter
    /// turns about the axes exchange the sides of tiles and keep ten decimals, so that edges that
    /// are parallel remain so to the last digit.
    ///
    /// # Errors
    /// If a position is out of range.
    pub fn rotated(mut self, rotation: Rotation, about_mm: DVec3) -> Result<Layout, TileFaults> {
        let rotation = rotation.quaternion();
        let turn = quarter_turns(rotation);
        let turned = |vector: DVec3| turn.map_or_else(|| rotation * vector, |turn| turn * vector);
        let placed = |point: DVec3| sum(about_mm, turned(point - about_mm));
        self.iron = self.iron.after(placed, turned);
        self.with_each_tile(|named| {
            let tile = named.tile;
            let position = placed(tile.position());
            let (size, polarization_t, own) = match turn {
                Some(turn) => {
                    let size = DMat3::from_cols_array(&turn.to_cols_array().map(f64::abs)) * tile.size();
                    let own = tile.rotation();
                    let turned = DVec3::new(own.x, own.y, own.z);
                    let axis = turn * turned;
                    (size, turn * tile.polarization_t(), DQuat::from_xyzw(axis.x, axis.y, axis.z, own.w))
                }
                None => (tile.size(), tile.polarization_t(), rotation * tile.rotation()),
            };
            let turned = Tile::new(position, size, polarization_t)?.rotated(own)?;
            // The kind has the sides of the tile.
            let kind = if size == tile.size() { named.kind } else { None };
            let NamedTile { permeability, disc, .. } = named;
            Ok(NamedTile { kind, permeability, disc, ..NamedTile::new(named.name, turned) })
        })
    }

    /// The layout with the tiles of these indices, in this order, and with their errors.
    ///
    /// # Panics
    /// If there is no tile with an index.
    pub fn with_selected_tiles(mut self, indices: &[usize]) -> Layout {
        if let Some(tolerance) = &mut self.tolerance {
            if !tolerance.tiles.is_empty() {
                tolerance.tiles = indices.iter().map(|&index| tolerance.tiles[index].clone()).collect();
            }
            for group in &mut tolerance.groups {
                let members: HashSet<usize> = group.tiles.iter().copied().collect();
                let is_member = |&position: &usize| members.contains(&indices[position]);
                group.tiles = (0..indices.len()).filter(is_member).collect();
            }
            tolerance.groups.retain(|group| !group.tiles.is_empty());
        }
        let tiles = indices.iter().map(|&index| self.tiles[index].clone()).collect();
        Layout { tiles, ..self.without_requirements() }
    }

    /// The layout with the tiles of another layout in addition. All other tables are those of
    /// `self`. The tiles of `other` keep their recoil permeability and their errors. Where both
    /// have tiles or groups of one name, the name of the second gets the suffix `-2`, or the next
    /// free number.
    pub fn joined(mut self, other: &Layout) -> Layout {
        let count = self.tiles.len();
        if self.tolerance.is_some() || other.tolerance.is_some() {
            let mut both = self.tolerance.take().unwrap_or_default();
            let more = other.tolerance.clone().unwrap_or_default();
            let of_each = |of: FilmTolerance, count: usize| match of.tiles.is_empty() {
                true => vec![Default::default(); count],
                false => of.tiles,
            };
            let mut names = FreeNames::of(both.groups.iter().map(|group| &group.name));
            for mut group in more.groups.clone() {
                group.name = names.free(&group.name);
                group.tiles.iter_mut().for_each(|tile| *tile += count);
                both.groups.push(group);
            }
            if !(both.tiles.is_empty() && more.tiles.is_empty()) {
                both.tiles = of_each(both.clone(), count);
                both.tiles.extend(of_each(more, other.tiles.len()));
            }
            self.tolerance = Some(both);
        }
        let Material { permeability, .. } = self.material;
        let mut names = FreeNames::of(self.tiles.iter().map(|named| &named.name));
        let discs = self.tiles.iter().filter_map(|named| named.disc.as_ref());
        let mut names_of_discs = FreeNames::of(discs.map(|disc| &disc.name).collect::<HashSet<_>>().into_iter());
        let mut discs: HashMap<&str, Arc<WholeDisc>> = HashMap::new();
        for named in &other.tiles {
            let disc = named.disc.as_ref().map(|disc| {
                let renamed =
                    || Arc::new(WholeDisc { name: names_of_discs.free(&disc.name), ..WholeDisc::clone(disc) });
                discs.entry(&disc.name).or_insert_with(renamed).clone()
            });
            let own = named.permeability.unwrap_or(other.material.permeability);
            let permeability = named.permeability.or((own != permeability).then_some(own));
            self.tiles.push(NamedTile { name: names.free(&named.name), permeability, disc, ..named.clone() });
        }
        self.without_requirements()
    }

    fn with_each_tile(
        mut self,
        changed: impl Fn(NamedTile) -> Result<NamedTile, TileFaults>,
    ) -> Result<Layout, TileFaults> {
        self.tiles = self.tiles.into_iter().map(changed).collect::<Result<_, _>>()?;
        Ok(self.without_requirements())
    }

    fn without_requirements(self) -> Layout {
        Layout { expectations: Expectations::default(), brief: None, ..self }
    }
}

/// The sum of two vectors, without the round-off of decimal numbers. Other digits are kept: ten
/// decimals of turned tiles would let tiles that touch overlap.
fn sum(a: DVec3, b: DVec3) -> DVec3 {
    let of = |axis: usize| {
        let (sum, largest) = (a[axis] + b[axis], a[axis].abs().max(b[axis].abs()));
        let decimal = ten_decimals(sum);
        let is_decimal = (decimal - sum).abs() <= DECIMAL_ROUNDINGS * f64::EPSILON * largest;
        if is_decimal { decimal } else { sum }
    };
    DVec3::new(of(0), of(1), of(2))
}

/// The matrix of a rotation by quarter turns about the axes, exact. `None` for other rotations.
fn quarter_turns(rotation: DQuat) -> Option<DMat3> {
    let matrix = DMat3::from_quat(rotation);
    let exact = DMat3::from_cols_array(&matrix.to_cols_array().map(f64::round));
    let is_one = (matrix - exact).to_cols_array().iter().all(|element| element.abs() <= QUARTER_TURN_ROUNDING);
    is_one.then_some(exact)
}

/// Names in use.
struct FreeNames(HashSet<String>);

impl FreeNames {
    fn of<'a>(names: impl Iterator<Item = &'a String>) -> FreeNames {
        FreeNames(names.cloned().collect())
    }

    /// The name, or with the first number that makes it unique, which is then in use.
    fn free(&mut self, name: &str) -> String {
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let mut candidates = std::iter::once(name.to_owned()).chain(numbered);
        let free = candidates.find(|name| !self.0.contains(name)).expect("there are infinitely many numbers");
        self.0.insert(free.clone());
        free
    }
}
