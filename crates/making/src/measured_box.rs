//! A box of measured tiles, sorted by the parts of a layout.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use magsplice_layout::{Layout, MAX_NAME_BYTES, Part, rearranges_text, ten_decimals};
use magsplice_magnet::MU_0;

use crate::assignment::{CutTile, PlaceGroup};

/// Smallest ratio of a measured value to the ordered value. Outside the limits a unit is wrong, or
/// a tile belongs to another part.
const LEAST_FACTOR: f64 = 0.5;

/// Largest ratio of a measured value to the ordered value.
const MOST_FACTOR: f64 = 2.0;

/// Largest angle from the ordered direction. Beyond it a tile was turned during its measurement.
const MOST_ANGLE_DEG: f64 = 45.0;

/// Directions written with few decimals differ by this much from the limit, which they reach.
const ANGLE_ROUNDING_DEG: f64 = 1e-6;

/// Cubic metres of a cubic millimetre.
const M3_PER_MM3: f64 = 1e-9;

/// Largest number of characters of a text that a message repeats.
const MOST_SHOWN: usize = 200;

/// The measurements of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredTile<'a> {
    /// The name.
    pub name: &'a str,
    /// The part: its number, from 1, in the order of [`Layout::parts`], or the name of a tile or
    /// kind of this part alone. `None` if the layout has one part, or the sides identify it.
    pub part: Option<&'a str>,
    /// The sides in the order of the part's sides, NaN for one that was not measured. `None` if
    /// none was.
    pub size_mm: Option<DVec3>,
    /// The magnetization.
    pub magnet: MeasuredMagnet,
}

/// The magnetization of a tile, along its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeasuredMagnet {
    /// J in tesla.
    Polarization(DVec3),
    /// The magnetic moment in A m2.
    Moment(DVec3),
    /// |J| in tesla, along the direction of the part.
    Strength(f64),
}

/// A box of measured tiles for the parts of a layout.
#[derive(Clone, Debug)]
pub struct MeasuredBox<'a> {
    parts: Vec<Part>,
    /// The part identified by the name of each tile and of each kind.
    part_names: HashMap<&'a str, usize>,
    groups: Vec<PlaceGroup>,
    names: HashSet<String>,
    has_sizes: bool,
}

impl PlaceGroup {
    /// The places of each part of a layout, without tiles.
    pub fn from_layout(layout: &Layout) -> Vec<PlaceGroup> {
        layout.parts().iter().map(PlaceGroup::from_part).collect()
    }

    fn from_part(part: &Part) -> PlaceGroup {
        PlaceGroup {
            size_mm: part.size_mm,
            polarization_t: part.strength_t * part.direction,
            places: part.tiles.clone(),
            tiles: Vec::new(),
        }
    }
}

impl<'a> MeasuredBox<'a> {
    /// An empty box.
    pub fn new(layout: &'a Layout) -> MeasuredBox<'a> {
        let parts = layout.parts();
        MeasuredBox {
            part_names: part_names(layout, &parts),
            groups: parts.iter().map(PlaceGroup::from_part).collect(),
            parts,
            names: HashSet::new(),
            has_sizes: false,
        }
    }

    /// Adds a tile.
    ///
    /// # Errors
    /// Every broken rule, in words: the part must be known, the name unused, and measured values
    /// near the ordered values.
    pub fn add(&mut self, tile: &MeasuredTile) -> Result<(), Vec<String>> {
        let mut faults: Vec<String> = self.name_fault(tile.name).into_iter().collect();
        let number = match self.part(tile) {
            Ok(number) => number,
            Err(fault) => {
                faults.push(fault);
                return Err(faults);
            }
        };
        let part = &self.parts[number];
        let measured = |size_mm: DVec3| DVec3::select(size_mm.is_nan_mask(), part.size_mm, size_mm);
        let size_mm = tile.size_mm.map_or(part.size_mm, measured);
        for axis in 0..3 {
            let (size, ordered) = (size_mm[axis], part.size_mm[axis]);
            if !(LEAST_FACTOR..=MOST_FACTOR).contains(&(size / ordered)) {
                let side = ["first", "second", "third"][axis];
                faults.push(format!(
                    "the {side} side is {size} mm, must be within {LEAST_FACTOR} to {MOST_FACTOR} times the {ordered} mm \
                     of part {}",
                    number + 1
                ));
            }
        }
        let polarization_t = match tile.magnet {
            MeasuredMagnet::Polarization(j_t) => j_t,
            MeasuredMagnet::Moment(moment) => moment * (MU_0 / (size_mm.element_product() * M3_PER_MM3)),
            MeasuredMagnet::Strength(strength_t) => strength_t * part.direction,
        };
        if faults.is_empty() {
            faults.extend(polarization_fault(polarization_t, part, number));
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        self.has_sizes |= size_mm != part.size_mm;
        self.names.insert(tile.name.to_owned());
        self.groups[number].tiles.push(CutTile { name: tile.name.to_owned(), polarization_t, size_mm });
        Ok(())
    }

    /// Number of tiles.
    pub fn tile_count(&self) -> usize {
        self.names.len()
    }

    /// Number of parts of the layout.
    pub fn part_count(&self) -> usize {
        self.parts.len()
    }

    /// Whether the sides of any tile differ from the sides of its part.
    pub fn has_sizes(&self) -> bool {
        self.has_sizes
    }

    /// The places of each part, with the tiles in the order of their addition.
    pub fn into_groups(self) -> Vec<PlaceGroup> {
        self.groups
    }

    fn name_fault(&self, name: &str) -> Option<String> {
        let shown = beginning(name);
        if name.is_empty() {
            return Some("has no name in the column of tiles".to_owned());
        }
        if name.len() > MAX_NAME_BYTES {
            return Some(format!("tile \"{shown}\" has {} bytes, must have at most {MAX_NAME_BYTES}", name.len()));
        }
        if self.names.contains(name) {
            return Some(format!("tile \"{shown}\" is already in the box"));
        }
        name.chars()
            .any(rearranges_text)
            .then(|| format!("tile \"{shown}\" has control characters or marks of direction"))
    }

    /// The index of the part of a tile.
    fn part(&self, tile: &MeasuredTile) -> Result<usize, String> {
        let count = self.parts.len();
        if let Some(part) = tile.part {
            let by_number = part.parse().ok().filter(|number| (1..=count).contains(number));
            let found = by_number.map(|number: usize| number - 1).or_else(|| self.part_names.get(part).copied());
            return found.ok_or_else(|| {
                format!(
                    "part = \"{}\", must be a number from 1 to {count}, as `magsplice tiles` lists the parts, or the name \
                     of a tile or of a kind of one part",
                    beginning(part)
                )
            });
        }
        if count == 1 {
            return Ok(0);
        }
        let Some(size_mm) = tile.size_mm else {
            return Err(format!("has no part, must have the number of one in a column part, 1 to {count}, or sizes"));
        };
        let known = |size_mm: DVec3| DVec3::select(size_mm.is_nan_mask(), DVec3::ZERO, size_mm);
        // The nearest part, if no other part is nearly as near. Sizes of parts differ by more than
        // the errors of cuts.
        let mut by_distance: Vec<(f64, usize)> = self
            .parts
            .iter()
            .enumerate()
            .map(|(number, part)| (known(part.size_mm - size_mm).length(), number))
            .collect();
        by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
        match by_distance[..] {
            [(near, number), (next, _), ..] if next > 2.0 * near && near < 0.25 * known(size_mm).length() => Ok(number),
            _ => {
                let DVec3 { x, y, z } = size_mm;
                Err(format!("its sizes ({x}, {y}, {z}) mm fit no single part: give the part in a column part"))
            }
        }
    }
}

/// The beginning of a text.
pub(crate) fn beginning(text: &str) -> String {
    text.chars().take(MOST_SHOWN).collect()
}

/// The part identified by the name of each tile and of each kind. Kinds of several parts are
/// omitted.
fn part_names<'a>(layout: &'a Layout, parts: &[Part]) -> HashMap<&'a str, usize> {
    let mut of_kinds: HashMap<&str, Option<usize>> = HashMap::new();
    let mut names = HashMap::new();
    for (number, part) in parts.iter().enumerate() {
        for named in part.tiles.iter().map(|&tile| &layout.tiles[tile]) {
            names.insert(named.name.as_str(), number);
            if let Some(kind) = &named.kind {
                let of_kind = of_kinds.entry(kind).or_insert(Some(number));
                *of_kind = of_kind.filter(|of_kind| *of_kind == number);
            }
        }
    }
    let kinds = of_kinds.into_iter().filter_map(|(kind, part)| Some((kind, part?)));
    kinds.for_each(|(kind, part)| {
        names.entry(kind).or_insert(part);
    });
    names
}

fn polarization_fault(polarization_t: DVec3, part: &Part, number: usize) -> Option<String> {
    let (strength_t, ordered_t) = (polarization_t.length(), part.strength_t);
    if ordered_t == 0.0 {
        return None;
    }
    if !(LEAST_FACTOR..=MOST_FACTOR).contains(&(strength_t / ordered_t)) {
        return Some(format!(
            "its polarization is {} T, must be within {LEAST_FACTOR} to {MOST_FACTOR} times the {ordered_t} T of part {}",
            ten_decimals(strength_t),
            number + 1
        ));
    }
    let angle_deg = polarization_t.angle_between(part.direction).to_degrees();
    (angle_deg > MOST_ANGLE_DEG - ANGLE_ROUNDING_DEG).then(|| {
        format!(
            "its polarization is {angle_deg:.1} deg from the polarization of part {}, must be less than {MOST_ANGLE_DEG} deg: turn the \
             axes so that x is along the first side of the part, y along the second, as `magsplice tiles` lists them",
            number + 1
        )
    })
}
