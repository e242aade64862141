//! Reading a layout: text becomes tables, tables become a checked [`Layout`].
//!
//! Every rule is checked before a value is converted, so that messages use the names and units of
//! the file. All broken rules are reported at once, the first few by name. Overlaps are searched only
//! if no other rule is broken. The limits on a whole layout are checked before its tiles are made.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::Path;

use sha2::{Digest, Sha256};
use toml::Spanned;

use self::entries::Entry;
use self::faults::Faults;
use self::room::Room;
use self::tables_present::TablesPresent;
use crate::error::{LayoutError, LayoutFault};
use crate::finding::FindingSubject;
use crate::layout::{Layout, NamedTile};
use crate::limits::{FORMAT, MAX_FILE_BYTES, MAX_MESSAGE_LINE};
use crate::tables::LayoutFile;

/// Rules and defaults of `[design]`.
mod design;
/// The tiles that one entry of the file makes.
mod entries;
/// Rules of `[expect]`.
mod expect;
/// The list of broken rules, with lines.
mod faults;
/// Properties that are allowed but usually a mistake.
mod findings;
/// Rules of `[ideal]`.
mod ideal;
/// Cells of a `[[lattice]]` become tiles.
mod lattice;
/// Rules for names.
mod names;
/// Rules for single numbers and vectors.
mod number_rules;
/// The rule that tiles do not overlap.
mod overlap;
/// Findings about lengths: tiles, ideal film and volume beside each other.
mod plausibility;
/// Copies on a grid and mirror images.
mod repeat;
/// The limits on all tiles together.
mod room;
/// Rules of the table `rotation` of a tile.
mod rotation;
/// One `[[tile]]` with its kind resolved.
mod single_tile;
/// Magnitudes of polarizations that a material has.
mod strength_rules;
/// Hints beside syntax errors.
mod syntax_hints;
/// The rule that tables come with the tables they need.
mod tables_present;
/// Position, size and polarization of one tile.
mod tile_rules;
/// Values of a wrong type, in the words of the format.
mod value_types;
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
        Layout::parse(&text, &origin)
    }

    /// The layout in `text`. `origin` names the source of the text in errors.
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
        let refused = |message: String| LayoutError::Syntax { origin: origin.to_owned(), message };
        if text.len() > MAX_FILE_BYTES {
            return Err(refused(format!("has {} bytes, must have at most {MAX_FILE_BYTES}", text.len())));
        }
        let file: LayoutFile = toml::from_str(text).map_err(|error| {
            let message = syntax_hints::message(text, error.message(), error.span());
            // The parser's own text ends with its message, after the place in the file.
            let shown = error.to_string();
            let place = shown.trim_end().strip_suffix(error.message().trim_end()).unwrap_or(&shown);
            refused(printable(&format!("{place}{message}")))
        })?;
        let sha256 = Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect();
        resolve(file, text, sha256).map_err(|faults| LayoutError::Invalid { origin: origin.to_owned(), faults })
    }
}

/// Keys that a layout has at its top and few other files have.
const KEYS_OF_LAYOUTS: [&str; 4] = ["format", "tile", "lattice", "volume"];

/// Whether a TOML text is meant as a layout: it has one of the keys `format`, `tile`, `lattice` and
/// `volume`. `None` if the text is not TOML.
///
/// # Example
/// ```
/// use magsplice_layout::{COMMENTED_LAYOUT, is_layout};
///
/// assert_eq!(is_layout(COMMENTED_LAYOUT), Some(true));
/// assert_eq!(is_layout("[package]\nname = \"film\""), Some(false));
/// ```
pub fn is_layout(text: &str) -> Option<bool> {
    let table: toml::Table = toml::from_str(text).ok()?;
    Some(KEYS_OF_LAYOUTS.iter().any(|key| table.contains_key(*key)))
}

/// The contents of a file. One byte more than the limit is enough to see that it is too large, and
/// ends the reading of a device that has no end.
fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MAX_FILE_BYTES as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > MAX_FILE_BYTES {
        return Err(io::Error::other(format!("it has more than {MAX_FILE_BYTES} bytes, too many for a layout")));
    }
    Ok(bytes)
}

/// The message of the TOML parser, which cites lines of the file as they are: with escapes for
/// control characters, and without the ends of very long lines.
fn printable(message: &str) -> String {
    let line = |line: &str| {
        let mut shown: String = line.chars().take(MAX_MESSAGE_LINE).flat_map(names::escaped).collect();
        if line.chars().nth(MAX_MESSAGE_LINE).is_some() {
            shown += "...";
        }
        shown
    };
    message.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// The checked layout of a file, or its broken rules.
fn resolve(file: LayoutFile, text: &str, sha256: String) -> Result<Layout, Vec<LayoutFault>> {
    let mut faults = Faults::new(text);
    let mut findings = Vec::new();
    check_format(&file.format, &mut faults);
    names::check_name("name", &file.name, &mut faults.at(&(0..0), "layout"));
    let present = TablesPresent { ideal: file.ideal.is_some(), volume: file.volume.is_some() };
    let ideal = file.ideal.and_then(|table| ideal::resolve(table.get_ref(), &mut faults.at(&table.span(), "ideal")));
    let volume = file
        .volume
        .and_then(|table| volume::resolve(table.get_ref(), &mut faults.at(&table.span(), "volume"), &mut findings));
    let expectations = file.expect.map_or_else(Default::default, |table| {
        let mut faults = faults.at(&table.span(), "expect");
        expect::resolve(table.into_inner(), present, &mut faults)
    });
    let brief = file.design.and_then(|table| {
        let mut faults = faults.at(&table.span(), "design");
        design::resolve(table.into_inner(), present, volume.as_ref(), &mut faults)
    });
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
    if faults.is_empty() {
        overlap::check(&tiles, &entries, &mut faults);
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
    findings.extend(findings::about_expectations(&expectations));
    Ok(Layout {
        name: file.name,
        description: file.description,
        ideal,
        volume,
        expectations,
        brief,
        tolerance: None,
        history: file.history,
        tiles,
        sha256,
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
