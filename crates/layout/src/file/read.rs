//! Reading a layout: text becomes tables, tables become a checked [`Layout`].
//!
//! Every rule is checked before a value is converted, so that messages use the names and units of
//! the file. All broken rules are reported at once, the first few by name. Overlaps are searched
//! only if no other rule is broken. The limits on a whole layout are checked before its tiles are
//! made.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use magsplice_ideal::IdealFilm;
use magsplice_magnet::Tile;

use crate::error::{LayoutError, LayoutFault};
use crate::expectations::about_amplitude;
use crate::faults::{Faults, NOT_NEGATIVE};
use crate::file::LayoutFile;
use crate::file::text;
use crate::files::{Source, bytes, regular_bytes};
use crate::finding::FindingSubject;
use crate::findings;
use crate::fingerprint::sha256;
use crate::layout::{Layout, NamedTile, SourceFile};
use crate::limits::{FORMAT, MAX_FILE_BYTES};
use crate::names::{check_name, shown};
use crate::places::Place;
use crate::plane::{PlaneTable, check_volume};
use crate::tables_present::TablesPresent;
use crate::tile::{FileTiles, angles, overlap};
use crate::tolerance::WholeLayout;

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

    /// The layout in `text`. `origin` is the source of the text in errors. If it is the path of
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
    /// [`LayoutError::Invalid`] with every broken rule. Faults have the lines of
    /// [`Layout::to_toml`]. A seed above `i64::MAX` is reported alone.
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
        self.check_seeds(origin)?;
        Layout::parse(&self.to_toml(), origin).map(|layout| Layout { file: None, ..layout })
    }

    /// Refuses seeds that no layout file can express: the integers of TOML have a sign.
    pub(super) fn check_seeds(&self, origin: &str) -> Result<(), LayoutError> {
        let seeds = [
            ("[design]", self.brief.as_ref().map(|brief| brief.seed)),
            ("[tolerance]", self.tolerance.as_ref().map(|tolerance| tolerance.seed)),
        ];
        let fault = |(table, seed): (&str, Option<u64>)| {
            let seed = seed.filter(|seed| i64::try_from(*seed).is_err())?;
            let message = format!("seed = {seed}, must be at most {}", i64::MAX);
            Some(LayoutFault { line: None, place: table.to_owned(), message })
        };
        let faults: Vec<LayoutFault> = seeds.into_iter().filter_map(fault).collect();
        if faults.is_empty() { Ok(()) } else { Err(LayoutError::Invalid { origin: origin.to_owned(), faults }) }
    }
}

/// The checked layout of a text, or why there is none.
fn parse_from(text: &str, origin: &str, source: &Source) -> Result<Layout, LayoutError> {
    let (file, place) = text::read(text, origin)?;
    let layout = resolve(file, &place, text, source)
        .map_err(|faults| LayoutError::Invalid { origin: origin.to_owned(), faults })?;
    let file = SourceFile { text: text.to_owned(), folder: source.folder.clone() };
    Ok(Layout { sha256: sha256(text.as_bytes()), file: Some(Arc::new(file)), ..layout })
}

/// The tiles of the layout file at a path relative to `folder`, without its tolerances, or why
/// there are none in one line.
fn tiles_of_neighbour(folder: &Path, layout: &str) -> Result<Vec<NamedTile>, String> {
    let path = folder.join(layout);
    let bytes = regular_bytes(&path, MAX_FILE_BYTES).map_err(|error| format!("cannot be read: {error}"))?;
    let text = String::from_utf8(bytes).map_err(|_| "must be UTF-8 text")?;
    let source = Source { is_neighbour: true, ..Source::of_file(&path) };
    parse_from(&text, &shown(layout), &source).map(|layout| layout.tiles).map_err(|error| match error {
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

/// The checked layout of a file, or its broken rules. It lacks the hash and the text.
fn resolve(file: LayoutFile, place: &Place, text: &str, source: &Source) -> Result<Layout, Vec<LayoutFault>> {
    let mut faults = Faults::new(text);
    let stock = file.design.as_ref().map_or(&[][..], |design| &design.stock);
    faults.findings = angles::findings(&file.tile, stock);
    let at = |key: &str| place.key(key).start;
    let rule = format_args!("must be {FORMAT}, the only version supported");
    faults.at(at("format"), "layout").require(file.format == FORMAT, "format", file.format, rule);
    check_name("name", &file.name, &mut faults.at(0, "layout"));
    let overlap_mm = file.overlap_mm.unwrap_or(0.0);
    faults.at(0, "layout").number("overlap_mm", overlap_mm, NOT_NEGATIVE);
    let present = TablesPresent {
        ideal: file.ideal.is_some(),
        volume: file.volume.is_some(),
        tolerance: file.tolerance.is_some(),
        plane: !file.plane.is_empty(),
    };
    let ideal = file.ideal.and_then(|table| table.resolve(&mut faults.at(at("ideal"), "ideal")));
    let volume = file.volume.and_then(|table| table.resolve(&mut faults.at(at("volume"), "volume")));
    let expectations = file.expect.unwrap_or_default();
    if let Some(made) = &expectations.made {
        made.check(present, &mut faults.at(place.key("expect").key("made").start, "expect.made"));
    }
    expectations.check(present, &mut faults.at(at("expect"), "expect"));
    let brief =
        file.design.inspect(|brief| brief.check(present, volume.as_ref(), &mut faults.at(at("design"), "design")));
    let wavelength_mm = ideal.as_ref().map(IdealFilm::wavelength);
    let sensor = file.sensor.and_then(|table| table.resolve(wavelength_mm, place.key("sensor"), &mut faults));
    let elastomer = file.elastomer.inspect(|layer| layer.check(&mut faults.at(at("elastomer"), "elastomer")));
    let material = file.material.map(|table| table.resolve(&mut faults.at(at("material"), "material")));
    let material = material.unwrap_or_default();
    let before_tiles = faults.count();
    let FileTiles { tiles, entries, shape_error } =
        FileTiles::resolve(&file.kind, &file.tile, &file.lattice, place, &mut faults);
    let slice_errors = volume.iter().flat_map(|volume| file.lattice.iter().filter_map(|of| of.slice_error(volume)));
    let slice_error = slice_errors.reduce(f64::max);
    let iron = PlaneTable::resolve(&file.plane, (&tiles, overlap_mm), place.key("plane"), &mut faults);
    let tolerance = file.tolerance.filter(|_| !source.is_neighbour).and_then(|table| {
        let is_complete = faults.count() == before_tiles;
        let kinds = file.kind.keys().collect();
        let whole = WholeLayout { tiles: &tiles, kinds, strength_per_k: material.strength_per_k, is_complete, present };
        let read_neighbour = |layout: &str| tiles_of_neighbour(&source.folder, layout);
        table.resolve(whole, &source.folder, &read_neighbour, place.key("tolerance"), &mut faults)
    });
    if let Some(volume) = &volume {
        let bare: Vec<Tile> = tiles.iter().map(|named| named.tile).collect();
        let near = tolerance.as_ref().and_then(|tolerance| tolerance.common.iron.as_ref());
        if let Some(plane) = near.and_then(|iron| iron.plane(&bare, 0.0).ok()) {
            check_volume(&plane, volume, &mut faults.at(at("tolerance"), "tolerance.iron"));
        }
        for (index, plane) in iron.planes().iter().enumerate() {
            let start = place.key("plane").item(index).start;
            check_volume(plane, volume, &mut faults.at(start, format!("plane {}", index + 1)));
        }
    }
    if faults.is_empty() {
        overlap::check(&tiles, &entries, overlap_mm, &mut faults);
    }
    if !faults.is_empty() {
        return Err(faults.into_sorted());
    }
    let mut findings = faults.findings;
    findings.extend(findings::about_tiles(&tiles, volume.as_ref()));
    findings.extend(findings::lengths::findings(&tiles, ideal.as_ref(), volume.as_ref()));
    findings.extend(expectations.findings(ideal.as_ref()));
    findings.extend(brief.iter().filter_map(|brief| about_amplitude(FindingSubject::Design, brief.least_amplitude?)));
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
        iron,
        material,
        shape_error,
        slice_error,
        history: file.history,
        overlap_mm,
        tiles,
        sha256: String::new(),
        file: None,
        findings,
    })
}
