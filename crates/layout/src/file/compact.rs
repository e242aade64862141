//! Writing a layout compactly: kinds, mirror images, angles in degrees, one line for each tile.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use glam::DVec3;
use magsplice_magnet::Axis;
use serde::Serialize;

use crate::faults::Faults;
use crate::file::LayoutFile;
use crate::layout::{Layout, NamedTile};
use crate::limits::MAX_NAME_BYTES;
use crate::material::RecoilPermeability;
use crate::rotation::RotationTable;
use crate::tile::repeat::{self, MirrorTable};
use crate::tile::room::Room;
use crate::units::{direction_from_degrees, ten_decimals};

impl Layout {
    /// The layout as TOML for people: one line for each tile, without its mirror images at x = 0
    /// and y = 0. Sizes and strengths that several lines share become kinds. Polarizations are
    /// strengths with angles in degrees.
    ///
    /// Parsing the text gives the same tiles, number for number, in another order, and mirror
    /// images have the names of images. Numbers that no short form gives exactly are written in the
    /// plain form.
    ///
    /// # Panics
    /// If the path of the expected field is not UTF-8, which no layout file can express.
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{COMMENTED_LAYOUT, Layout};
    ///
    /// let layout = Layout::parse(COMMENTED_LAYOUT, "commented")?;
    /// let text = layout.to_compact_toml();
    /// assert_eq!(Layout::parse(&text, "compact")?.tiles.len(), 56);
    /// assert!(text.lines().count() < layout.to_toml().lines().count() / 3);
    /// # Ok::<(), magsplice_layout::LayoutError>(())
    /// ```
    pub fn to_compact_toml(&self) -> String {
        let (lines, names) = lines(&self.tiles);
        let file = self.without_tiles(&names.iter().map(String::as_str).collect::<Vec<_>>());
        let rest = file.to_toml();
        let LayoutFile { format, name, description, history, overlap_mm, .. } = file;
        let head = LayoutFile { format, name, description, history, overlap_mm, ..LayoutFile::default() };
        let mut text = head.to_toml();
        // TOML requires the keys of a file before its tables.
        let tables = rest[text.len()..].trim_start();
        let kinds = kinds(&lines);
        if !kinds.is_empty() {
            text.push('\n');
        }
        for (index, (size_mm, strength_t)) in kinds.iter().enumerate() {
            let size_mm = numbers(*size_mm);
            let _ =
                writeln!(text, "kind.{} = {{ size_mm = {size_mm}, strength_t = {strength_t:?} }}", kind_name(index));
        }
        text += "\ntile = [\n";
        for line in &lines {
            let _ = writeln!(text, "  {{ {} }},", line.keys(&kinds));
        }
        text + "]\n\n" + tables
    }
}

/// A tile and the axes along which it is mirrored.
struct Line<'a> {
    named: &'a NamedTile,
    axes: &'static [Axis],
    /// Strength and the angles in the plane and out of it, in degrees, if they give the
    /// polarization exactly.
    angles: Option<(f64, [f64; 2])>,
}

impl Line<'_> {
    fn keys(&self, kinds: &[(DVec3, f64)]) -> String {
        let NamedTile { name, tile, rotation, permeability, .. } = self.named;
        let mut keys = vec![format!("name = {}", toml::Value::String(name.clone()))];
        let known = self.kind().and_then(|kind| kinds.iter().position(|known| *known == kind));
        match known {
            Some(index) => keys.push(format!("kind = \"{}\"", kind_name(index))),
            None => keys.push(format!("size_mm = {}", numbers(tile.size()))),
        }
        keys.push(format!("position_mm = {}", numbers(tile.position())));
        match self.angles {
            Some((strength_t, [direction_deg, tilt_deg])) => {
                if known.is_none() {
                    keys.push(format!("strength_t = {strength_t:?}"));
                }
                keys.push(format!("direction_deg = {direction_deg:?}"));
                if tilt_deg != 0.0 {
                    keys.push(format!("tilt_deg = {tilt_deg:?}"));
                }
            }
            None => keys.push(format!("polarization_t = {}", numbers(tile.polarization_t()))),
        }
        if let Some(permeability) = permeability {
            keys.push(format!("recoil_permeability = {}", inline(&RecoilPermeability::from(*permeability))));
        }
        if let Some(rotation) = rotation {
            keys.push(format!("rotation = {}", inline(&RotationTable::from(*rotation))));
        }
        if !self.axes.is_empty() {
            let axes: Vec<String> = self.axes.iter().map(|axis| format!("\"{axis}\"")).collect();
            keys.push(format!("mirror = {{ axes = [{}] }}", axes.join(", ")));
        }
        keys.join(", ")
    }

    /// Size and strength.
    fn kind(&self) -> Option<(DVec3, f64)> {
        self.angles.map(|(strength_t, _)| (self.named.tile.size(), strength_t))
    }
}

/// A value in one line of TOML.
fn inline(value: &impl Serialize) -> String {
    toml::Value::try_from(value).expect("numbers and strings can be written").to_string()
}

/// The tiles that are not mirror images of others, and the names of all tiles in the text.
fn lines(tiles: &[NamedTile]) -> (Vec<Line<'_>>, Vec<String>) {
    let mut written = vec![false; tiles.len()];
    // By position, so that images are found without a search among all tiles.
    let mut by_x: Vec<usize> = (0..tiles.len()).collect();
    let x = |index: usize| tiles[index].tile.position().x;
    by_x.sort_by(|&a, &b| x(a).total_cmp(&x(b)));
    let found = |image: &NamedTile| {
        let at = image.tile.position().x;
        let first = by_x.partition_point(|&index| x(index) < at);
        let beside = by_x[first..].iter().copied().take_while(|&index| x(index) == at);
        beside.into_iter().find(|&index| tiles[index].tile == image.tile)
    };
    let mut names: Vec<String> = tiles.iter().map(|named| named.name.clone()).collect();
    let holders: HashMap<&str, usize> = tiles.iter().enumerate().map(|(i, named)| (named.name.as_str(), i)).collect();
    // Tiles at positive coordinates stand for their images.
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    order.sort_by_key(|&index| tiles[index].tile.position().truncate().min_element() < 0.0);
    let mut lines = Vec::new();
    for index in order {
        if written[index] {
            continue;
        }
        written[index] = true;
        let named = &tiles[index];
        let mut axes: &'static [Axis] = &[];
        for candidate in [&[Axis::X, Axis::Y][..], &[Axis::X], &[Axis::Y]] {
            let images = images(named, candidate);
            let Some(places) = images.iter().map(found).collect::<Option<Vec<usize>>>() else { continue };
            // An image takes its name from no other tile.
            let fits = |(image, place): (&NamedTile, &usize)| {
                let holder = holders.get(image.name.as_str());
                !written[*place]
                    && tiles[*place].permeability == named.permeability
                    && image.name.len() <= MAX_NAME_BYTES
                    && holder.is_none_or(|holder| places.contains(holder))
            };
            let differ = places.iter().collect::<HashSet<_>>().len() == places.len();
            if named.rotation.is_none() && differ && !places.is_empty() && images.iter().zip(&places).all(fits) {
                axes = candidate;
                for (image, place) in images.into_iter().zip(places) {
                    (written[place], names[place]) = (true, image.name);
                }
                break;
            }
        }
        lines.push(Line { named, axes, angles: angles(named.tile.polarization_t()) });
    }
    (lines, names)
}

/// The mirror images of a tile at x = 0 and y = 0 as they are read from a file. Empty if there are
/// none.
fn images(named: &NamedTile, axes: &[Axis]) -> Vec<NamedTile> {
    let mirror = MirrorTable { axes: axes.to_vec(), ..MirrorTable::default() };
    let mut faults = Faults::new("");
    let tiles = repeat::resolve(named.clone(), 1, None, Some(&mirror), &mut Room::default(), &mut faults.at(0, ""));
    tiles.into_iter().flatten().skip(1).collect()
}

/// Strength and angles in degrees with at most ten decimals that give the polarization exactly.
fn angles(polarization_t: DVec3) -> Option<(f64, [f64; 2])> {
    // Adding 0 turns -0 into 0, so that the angle is 180 and not -180 degrees.
    let polarization_t = polarization_t + DVec3::ZERO;
    let strength_t = ten_decimals(polarization_t.length());
    let plane = polarization_t.truncate().length();
    let direction_deg = ten_decimals(polarization_t.y.atan2(polarization_t.x).to_degrees());
    let tilt_deg = ten_decimals(polarization_t.z.atan2(plane).to_degrees());
    let found = [direction_deg, tilt_deg];
    (strength_t > 0.0 && direction_from_degrees(found) * strength_t == polarization_t).then_some((strength_t, found))
}

/// Sizes and strengths that more than one line has, in the order of the lines.
fn kinds(lines: &[Line]) -> Vec<(DVec3, f64)> {
    let mut counted: Vec<((DVec3, f64), usize)> = Vec::new();
    for kind in lines.iter().filter_map(Line::kind) {
        match counted.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, count)) => *count += 1,
            None => counted.push((kind, 1)),
        }
    }
    counted.into_iter().filter(|(_, count)| *count > 1).map(|(kind, _)| kind).collect()
}

fn kind_name(index: usize) -> String {
    format!("kind-{}", index + 1)
}

/// A vector with the shortest digits that read back to the same numbers.
fn numbers(v: DVec3) -> String {
    // Adding 0 turns -0 into 0.
    format!("{:?}", (v + DVec3::ZERO).to_array())
}
