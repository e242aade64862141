//! Writing a layout compactly: kinds, mirror images, angles in degrees, one line for each tile.

use std::collections::HashMap;
use std::fmt::Write;

use glam::DVec3;
use magsplice_magnet::Tile;
use serde::Serialize;

use crate::file::LayoutFile;
use crate::layout::{Layout, NamedTile};
use crate::limits::MAX_NAME_BYTES;
use crate::material::RecoilPermeability;
use crate::rotation::RotationTable;
use crate::units::{direction_from_degrees, ten_decimals};

/// Largest number of letters that the suffixes of mirror images add to a name.
const SUFFIXES: usize = "-mx-my".len();

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
        let lines = lines(&self.tiles);
        let names = written_names(&lines, self.tiles.len());
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
    index: usize,
    axes: &'static [usize],
    /// Indices of its images, in the order of [`suffixes`].
    images: Vec<usize>,
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
        match self.axes {
            [] => {}
            [0] => keys.push("mirror = { axes = [\"x\"] }".to_owned()),
            [1] => keys.push("mirror = { axes = [\"y\"] }".to_owned()),
            _ => keys.push("mirror = { axes = [\"x\", \"y\"] }".to_owned()),
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
    let mut text = String::new();
    value.serialize(toml::ser::ValueSerializer::new(&mut text)).expect("numbers and strings can be written");
    text
}

/// The tiles without those that are mirror images of others.
fn lines(tiles: &[NamedTile]) -> Vec<Line<'_>> {
    let mut written = vec![false; tiles.len()];
    // By position, so that images are found without a search among all tiles.
    let mut by_x: Vec<usize> = (0..tiles.len()).collect();
    let x = |index: usize| tiles[index].tile.position().x;
    by_x.sort_by(|&a, &b| x(a).total_cmp(&x(b)));
    let found = |image: &Tile| {
        let at = image.position().x;
        let first = by_x.partition_point(|&index| x(index) < at);
        by_x[first..].iter().copied().take_while(|&index| x(index) == at).find(|&index| tiles[index].tile == *image)
    };
    let names: HashMap<&str, usize> =
        tiles.iter().enumerate().map(|(index, named)| (named.name.as_str(), index)).collect();
    // Tiles at positive coordinates stand for their images.
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    let negative = |index: usize| {
        let p = tiles[index].tile.position();
        p.x < 0.0 || p.y < 0.0
    };
    order.sort_by_key(|&index| negative(index));
    let mut lines = Vec::new();
    for index in order {
        if written[index] {
            continue;
        }
        written[index] = true;
        let named = &tiles[index];
        let mut axes: &'static [usize] = &[];
        let mut its_images = Vec::new();
        for candidate in [&[0, 1][..], &[0], &[1]] {
            let images =
                images(&named.tile, candidate).into_iter().map(|image| found(&image?)).collect::<Option<Vec<_>>>();
            let Some(images) = images else { continue };
            let mut all = images.clone();
            all.push(index);
            all.sort_unstable();
            all.dedup();
            // An image takes its name from no other tile.
            let is_free = |suffix: &&str| {
                names.get(format!("{}{suffix}", named.name).as_str()).is_none_or(|holder| images.contains(holder))
            };
            let is_alike = |&image: &usize| tiles[image].permeability == named.permeability;
            let fits = images.iter().all(is_alike)
                && named.name.len() + SUFFIXES <= MAX_NAME_BYTES
                && suffixes(candidate).iter().all(is_free);
            // Each image is a tile of its own that has not been written.
            if named.rotation.is_none() && fits && all.len() == images.len() + 1 && images.iter().all(|&i| !written[i])
            {
                images.iter().for_each(|&image| written[image] = true);
                (axes, its_images) = (candidate, images);
                break;
            }
        }
        lines.push(Line { named, index, axes, images: its_images, angles: angles(named.tile.polarization_t()) });
    }
    lines
}

/// The names that tiles have in the text, by their indices.
fn written_names(lines: &[Line], count: usize) -> Vec<String> {
    let mut names = vec![String::new(); count];
    for line in lines {
        names[line.index].clone_from(&line.named.name);
        for (&image, suffix) in line.images.iter().zip(suffixes(line.axes)) {
            names[image] = format!("{}{suffix}", line.named.name);
        }
    }
    names
}

/// Endings of the names of the images.
fn suffixes(axes: &[usize]) -> &'static [&'static str] {
    match axes {
        [0] => &["-mx"],
        [1] => &["-my"],
        _ => &["-mx", "-my", "-mx-my"],
    }
}

/// The mirror images of a tile that is not rotated, with the polarization mirrored like an arrow.
fn images(tile: &Tile, axes: &[usize]) -> Vec<Option<Tile>> {
    let image = |signs: DVec3| Tile::new(tile.position() * signs, tile.size(), tile.polarization_t() * signs).ok();
    let (x, y) = (DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0));
    match axes {
        [0] => vec![image(x)],
        [1] => vec![image(y)],
        _ => vec![image(x), image(y), image(x * y)],
    }
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
