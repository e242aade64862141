//! Reading a layout: text becomes tables, tables become a checked [`Layout`].
//!
//! Every rule is checked before a value is converted, so that messages use the names and units of
//! the file. All broken rules are reported at once, the first few by name. Overlaps are searched
//! only if no other rule is broken. The limits on a whole layout are checked before its tiles are
//! made.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use toml::Spanned;

use self::entries::Entry;
use self::faults::Faults;
use self::files::{Source, bytes, regular_bytes};
use self::room::Room;
use self::tables_present::TablesPresent;
use self::tolerance::WholeLayout;
use crate::document;
use crate::error::{LayoutError, LayoutFault};
use crate::expectations::Expectations;
use crate::finding::FindingSubject;
use crate::fingerprint::sha256;
use crate::layout::{Layout, NamedTile, SourceFile};
use crate::limits::{FORMAT, MAX_FILE_BYTES};
use crate::tables::LayoutFile;

/// Rules and defaults of `[design]`.
mod design;
/// The tiles that one entry of the file makes.
mod entries;
/// Rules of `[expect]`.
mod expect;
/// The list of broken rules, with lines.
mod faults;
/// Files beside a layout.
mod files;
/// Properties that are allowed but usually a mistake.
mod findings;
/// Rules of `[ideal]`.
mod ideal;
/// Cells of a `[[lattice]]` become tiles.
mod lattice;
/// Rules of `[expect.made]`.
mod made;
/// Rules of `[material]` and of `recoil_permeability`.
mod material;
/// Rules for names.
pub(crate) mod names;
/// Rules for single numbers and vectors.
mod number_rules;
/// The rule that tiles do not overlap.
mod overlap;
/// Findings about lengths: tiles, ideal film and volume beside each other.
mod plausibility;
/// Findings about angles in radians.
mod radians;
/// Copies on a grid and mirror images.
mod repeat;
/// The limits on all tiles together.
mod room;
/// Rules of the table `rotation` of a tile.
mod rotation;
/// Rules of `[sensor]` and `[elastomer]`.
mod sensor;
/// One `[[tile]]` with its kind resolved.
mod single_tile;
/// Magnitudes of polarizations that a material has.
mod strength_rules;
/// The rule that tables come with the tables they need.
mod tables_present;
/// Position, size and polarization of one tile.
mod tile_rules;
/// Rules of `[tolerance]`.
mod tolerance;
/// Ranges and a step become a grid.
mod volume;

impl Layout {
    /// The layout in the file at `path`.
    ///
    /// # Errors
    /// - [`LayoutError::Read`] if the file cannot be read, or has more than 64 MiB.
    /// - [`LayoutError::Syntax`] if it is not UTF-8 text or not TOML, or has an unknown or missing
    ///   key or a value of the wrong type. The first such place is reported with line and column.
    /// - [`LayoutError::Invalid`] if values break rules. All broken rules are reported at once.
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{COMMENTED_LAYOUT, Layout};
    ///
    /// # let path = std::env::temp_dir().join(format!("film-{}.toml", std::process::id()));
    /// std::fs::write(&path, COMMENTED_LAYOUT)?;
    /// let layout = Layout::read(&path)?;
    /// assert_eq!(layout.tiles.len(), 56);
    /// # std::fs::remove_file(&path)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(path: impl AsRef<Path>) -> Result<Layout, LayoutError> {
        let path = path.as_ref();
        let bytes = bytes(path).map_err(|error| LayoutError::Read { path: path.to_owned(), error })?;
        let origin = path.display().to_string();
        let text = String::from_utf8(bytes).map_err(|error| LayoutError::Syntax {
            origin: origin.clone(),
            message: format!("not UTF-8 text: {error}"),
        })?;
        parse_from(&text, &origin, &Source::of_file(path))
    }

    /// The layout in `text`. `origin` names the source of the text in errors. If it is the path of
    /// a file, then paths in the text are relative to the folder of this file, else to the working
    /// folder.
    ///
    /// # Errors
    /// [`LayoutError::Syntax`] and [`LayoutError::Invalid`], as for [`Layout::read`].
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{Layout, LayoutError};
    ///
    /// let text = r#"
    ///     format = 1
    ///     name = "one tile"
    ///     [[tile]]
    ///     position_mm = [0.0, 0.0, 0.5]
    ///     size_mm = [3.3, -1.7, 1.0]
    ///     polarization_t = [0.12, 0.0, 0.0]
    /// "#;
    /// let error = Layout::parse(text, "one.toml").unwrap_err();
    /// assert_eq!(
    ///     error.to_string(),
    ///     "one.toml: line 4: tile \"tile-1\": size_mm[1] = -1.7, must be greater than 0"
    /// );
    /// let layout = Layout::parse(&text.replace("-1.7", "1.7"), "one.toml")?;
    /// assert_eq!(layout.tiles[0].tile.size().y, 1.7);
    /// # Ok::<(), LayoutError>(())
    /// ```
    pub fn parse(text: &str, origin: &str) -> Result<Layout, LayoutError> {
        parse_from(text, origin, &Source::of_origin(origin))
    }

    /// The layout in `text`, as [`Layout::parse`]. Paths in it are relative to `folder`.
    ///
    /// # Errors
    /// [`LayoutError::Syntax`] and [`LayoutError::Invalid`], as for [`Layout::read`].
    pub fn parse_beside(text: &str, origin: &str, folder: impl Into<PathBuf>) -> Result<Layout, LayoutError> {
        parse_from(text, origin, &Source { folder: folder.into(), is_neighbour: false })
    }

    /// A layout that was made in memory, checked like a layout file. `origin` identifies it in
    /// errors.
    ///
    /// # Errors
    /// [`LayoutError::Invalid`] with every broken rule. The lines of faults are those of
    /// [`Layout::to_toml`].
    ///
    /// # Example
    /// ```
    /// use glam::DVec3;
    /// use magsplice_layout::{Layout, NamedTile};
    /// use magsplice_magnet::Tile;
    ///
    /// let tile = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::new(0.0, 0.0, 0.12))?;
    /// let layout = Layout { name: "one cube".to_owned(), tiles: vec![NamedTile::new("cube", tile)], ..Layout::default() };
    /// assert_eq!(layout.checked("cubes")?.tiles[0].tile, tile);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn checked(&self, origin: &str) -> Result<Layout, LayoutError> {
        Layout::parse(&self.to_toml(), origin).map(|layout| Layout { file: None, ..layout })
    }
}

/// The checked layout of a text, or why there is none.
fn parse_from(text: &str, origin: &str, source: &Source) -> Result<Layout, LayoutError> {
    let file = document::read(text, origin)?;
    resolve(file, text, sha256(text.as_bytes()), source)
        .map_err(|faults| LayoutError::Invalid { origin: origin.to_owned(), faults })
}

/// The tiles of the layout file at a path relative to `folder`, without its tolerances, or why
/// there are none in one line.
fn tiles_of_neighbour(folder: &Path, layout: &str) -> Result<Vec<NamedTile>, String> {
    let path = folder.join(layout);
    let bytes = regular_bytes(&path, MAX_FILE_BYTES).map_err(|error| format!("cannot be read: {error}"))?;
    let text = String::from_utf8(bytes).map_err(|_| "must be UTF-8 text")?;
    let source = Source { is_neighbour: true, ..Source::of_file(&path) };
    parse_from(&text, &names::shown(layout), &source).map(|layout| layout.tiles).map_err(|error| match error {
        LayoutError::Invalid { faults, .. } => match &faults[..] {
            [only] => format!("is refused: {only}"),
            all => format!("is refused for {} faults, such as: {}", all.len(), all[0]),
        },
        other => {
            let message = other.to_string();
            let lines: Vec<&str> = message.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
            match &lines[..] {
                [first, .., last] => format!("is refused: {first}: {last}"),
                _ => format!("is refused: {message}"),
            }
        }
    })
}

/// The checked layout of a file, or its broken rules.
fn resolve(file: LayoutFile, text: &str, sha256: String, source: &Source) -> Result<Layout, Vec<LayoutFault>> {
    let mut faults = Faults::new(text);
    let mut findings = radians::about_angles(&file);
    check_format(&file.format, &mut faults);
    names::check_name("name", &file.name, &mut faults.at(&(0..0), "layout"));
    let overlap_mm = file.overlap_mm.unwrap_or(0.0);
    number_rules::check_not_negative("overlap_mm", overlap_mm, &mut faults.at(&(0..0), "layout"));
    let present = TablesPresent {
        ideal: file.ideal.is_some(),
        volume: file.volume.is_some(),
        tolerance: file.tolerance.is_some(),
    };
    let ideal = file.ideal.and_then(|table| ideal::resolve(table.get_ref(), &mut faults.at(&table.span(), "ideal")));
    let volume = file
        .volume
        .and_then(|table| volume::resolve(table.get_ref(), &mut faults.at(&table.span(), "volume"), &mut findings));
    let expectations = file.expect.map_or_else(Default::default, |table| {
        let made = table.get_ref().made.as_ref();
        let made =
            made.map(|table| made::resolve(table.get_ref(), present, &mut faults.at(&table.span(), "expect.made")));
        let mut faults = faults.at(&table.span(), "expect");
        Expectations { made, ..expect::resolve(table.into_inner(), present, &mut faults) }
    });
    let brief = file.design.and_then(|table| {
        let mut faults = faults.at(&table.span(), "design");
        design::resolve(table.into_inner(), present, volume.as_ref(), &mut faults)
    });
    let sensor =
        file.sensor.and_then(|table| sensor::resolve(table.get_ref(), &mut faults.at(&table.span(), "sensor")));
    let elastomer = file
        .elastomer
        .and_then(|table| sensor::resolve_elastomer(table.get_ref(), &mut faults.at(&table.span(), "elastomer")));
    let material = file.material.map_or_else(Default::default, |table| {
        material::resolve(table.get_ref(), &mut faults.at(&table.span(), "material"), &mut findings)
    });
    let before_tiles = faults.count();
    for (name, kind) in &file.kind {
        let mut faults = faults.at(&kind.span(), format!("kind \"{}\"", names::shown(name)));
        names::check_name("name", name, &mut faults);
        single_tile::check_kind(kind.get_ref(), &mut faults);
    }
    let used: BTreeSet<&String> = file.tile.iter().filter_map(|tile| tile.get_ref().kind.as_ref()).collect();
    let idle = file.kind.keys().filter(|name| !used.contains(name));
    let is_idle = |name: &String| format!("kind \"{name}\" is declared but no tile uses it");
    findings.extend(findings::listed(idle, FindingSubject::Tiles, is_idle, "kinds"));
    if file.tile.is_empty() && file.lattice.is_empty() {
        faults.add_to_layout("has no tiles: add at least one [[tile]] or [[lattice]]");
    }

    let mut tiles: Vec<NamedTile> = Vec::new();
    // The place of each tile's table in the text.
    let mut spans: Vec<Range<usize>> = Vec::new();
    let mut entries: Vec<Entry> = Vec::new();
    let mut room = Room::default();
    for (index, table) in file.tile.iter().enumerate() {
        let (span, table) = (table.span(), table.get_ref());
        let name = table.name.clone().unwrap_or_else(|| format!("tile-{}", index + 1));
        let mut faults = faults.at(&span, format!("tile \"{}\"", names::shown(&name)));
        names::check_name("name", &name, &mut faults);
        let single = single_tile::resolve(table, name, &file.kind, &mut faults);
        let repeated = single
            .and_then(|tile| repeat::resolve(tile, table.grid.as_ref(), table.mirror.as_ref(), &mut room, &mut faults));
        entries.push(Entry { span: span.clone(), first: tiles.len(), mirror: table.mirror.as_ref() });
        tiles.extend(repeated.unwrap_or_default());
        spans.resize(tiles.len(), span);
    }
    for (index, table) in file.lattice.iter().enumerate() {
        let (span, table) = (table.span(), table.get_ref());
        let name = table.name.clone().unwrap_or_else(|| format!("lattice-{}", index + 1));
        let mut faults = faults.at(&span, format!("lattice \"{}\"", names::shown(&name)));
        names::check_name("name", &name, &mut faults);
        entries.push(Entry { span: span.clone(), first: tiles.len(), mirror: None });
        tiles.extend(lattice::resolve(table, &name, &mut room, &mut faults).unwrap_or_default());
        spans.resize(tiles.len(), span);
    }
    names::check(&tiles, &spans, &mut faults);
    let tolerance = file.tolerance.filter(|_| !source.is_neighbour).and_then(|table| {
        let is_complete = faults.count() == before_tiles;
        let strength_per_k = material.strength_per_k;
        let kinds = file.kind.keys().collect();
        let whole = WholeLayout { tiles: &tiles, kinds, strength_per_k, is_complete, present };
        let read_neighbour = |layout: &str| tiles_of_neighbour(&source.folder, layout);
        tolerance::resolve(&table, whole, &source.folder, &read_neighbour, &mut faults, &mut findings)
    });
    if faults.is_empty() {
        overlap::check(&tiles, &entries, overlap_mm, &mut faults);
    }
    if !faults.is_empty() {
        return Err(faults.into_sorted());
    }
    findings.extend(findings::about_tiles(&tiles, volume.as_ref()));
    let about_volume = volume.as_ref().and_then(|volume| {
        let near = || plausibility::about_distance(&tiles, ideal.as_ref()?, volume);
        plausibility::about_volume(&tiles, volume).or_else(near)
    });
    findings.extend(about_volume);
    findings.extend(ideal.iter().flat_map(|ideal| plausibility::about_ideal_film(&tiles, ideal, volume.as_ref())));
    findings.extend(findings::about_expectations(&expectations, ideal.as_ref()));
    findings.extend(
        brief.iter().filter_map(|brief| findings::about_amplitude(FindingSubject::Design, brief.least_amplitude?)),
    );
    Ok(Layout {
        name: file.name,
        description: file.description,
        ideal,
        volume,
        expectations,
        brief,
        tolerance,
        sensor,
        elastomer,
        material,
        history: file.history,
        overlap_mm,
        tiles,
        sha256,
        file: Some(Arc::new(SourceFile { text: text.to_owned(), folder: source.folder.clone() })),
        findings,
    })
}

fn check_format(format: &Spanned<i64>, faults: &mut Faults) {
    if *format.get_ref() != FORMAT {
        faults
            .at(&format.span(), "layout")
            .add(format!("format = {}, must be {FORMAT}, the only version supported", format.get_ref()));
    }
}
