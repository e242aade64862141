//! From a layout as written to a layout as meant: every rule is checked here, before anything is converted.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DQuat, DVec3};
use magsplice_field::{IdealFilm, IdealFilmFault, Tile, TileFault, overlaps};

use crate::brief;
use crate::error::Problem;
use crate::expectations::{self, Present};
use crate::findings;
use crate::lattice;
use crate::layout::{Layout, NamedTile};
use crate::repeat;
use crate::volume;
use crate::written::{Ideal, Kind, LayoutFile, Rotation, TileEntry};

/// The version of the format this crate reads and writes.
pub(crate) const FORMAT: i64 = 1;

/// More tiles than this are a mistake in a repetition, not a film: they would take gigabytes.
pub(crate) const MAX_TILES: usize = 4_000_000;

/// At most this many overlapping pairs, or names given twice, are named; a wrong pitch makes thousands.
const NAMED_PROBLEMS: usize = 20;

/// Collects problems with their place in the file.
pub(crate) struct Problems<'a> {
    text: &'a str,
    found: Vec<Problem>,
}

impl Problems<'_> {
    pub(crate) fn count(&self) -> usize {
        self.found.len()
    }

    pub(crate) fn add(&mut self, at: Option<&Range<usize>>, place: &str, message: impl Into<String>) {
        let line = at.map(|span| self.text[..span.start].matches('\n').count() + 1);
        self.found.push(Problem { line, place: place.to_owned(), message: message.into() });
    }
}

pub(crate) fn layout(file: LayoutFile, text: &str, sha256: String) -> Result<Layout, Vec<Problem>> {
    let mut problems = Problems { text, found: Vec::new() };
    if *file.format.get_ref() != FORMAT {
        let message = format!("format = {}, must be {FORMAT}, the only one this version reads", file.format.get_ref());
        problems.add(Some(&file.format.span()), "layout", message);
    }
    let present = Present { ideal: file.ideal.is_some(), volume: file.volume.is_some() };
    let ideal = file.ideal.and_then(|ideal| ideal_film(ideal.get_ref(), &ideal.span(), &mut problems));
    let mut findings = Vec::new();
    let volume =
        file.volume.and_then(|volume| volume::resolve(volume.get_ref(), &volume.span(), &mut problems, &mut findings));
    let expectations = file.expect.map_or_else(Default::default, |expect| {
        let span = expect.span();
        expectations::resolve(expect.into_inner(), &span, &present, &mut problems)
    });
    let design = file.design.and_then(|design| {
        let span = design.span();
        brief::resolve(design.into_inner(), &span, [present.ideal, present.volume], &mut problems)
    });
    for (name, kind) in &file.kind {
        check_kind(kind.get_ref(), &kind.span(), &format!("kind \"{name}\""), &mut problems);
        if !file.tile.iter().any(|tile| tile.get_ref().kind.as_ref() == Some(name)) {
            findings.push(format!("kind \"{name}\" is declared but no tile uses it"));
        }
    }
    if file.tile.is_empty() && file.lattice.is_empty() {
        problems.add(None, "layout", "has no tiles: add at least one [[tile]] or [[lattice]]");
    }

    let mut tiles = Vec::new();
    // Where each tile comes from.
    let mut spans: Vec<Range<usize>> = Vec::new();
    for (index, entry) in file.tile.into_iter().enumerate() {
        let span = entry.span();
        let entry = entry.into_inner();
        let name = entry.name.clone().unwrap_or_else(|| format!("tile-{}", index + 1));
        let place = format!("tile \"{name}\"");
        let before = problems.count();
        let single = single_tile(&entry, name, &file.kind, &mut |message| problems.add(Some(&span), &place, message));
        if let Some(single) = single.filter(|_| problems.count() == before) {
            let mut report = |message: String| problems.add(Some(&span), &place, message);
            repeat::repeated(single, entry.grid.as_ref(), entry.mirror.as_ref(), &mut tiles, &mut report);
            spans.resize(tiles.len(), span);
        }
    }
    for (index, entry) in file.lattice.into_iter().enumerate() {
        let span = entry.span();
        let name = entry.get_ref().name.clone().unwrap_or_else(|| format!("lattice-{}", index + 1));
        let place = format!("lattice \"{name}\"");
        lattice::tiles(entry.get_ref(), &name, &mut tiles, &mut |message| problems.add(Some(&span), &place, message));
        spans.resize(tiles.len(), span);
    }
    check_names(&tiles, &spans, &mut problems);
    if problems.found.is_empty() {
        check_overlaps(&tiles, &spans, &mut problems);
    }
    if !problems.found.is_empty() {
        problems.found.sort_by_key(|problem| problem.line);
        return Err(problems.found);
    }
    findings.extend(findings::of_tiles(&tiles, volume.as_ref()));
    Ok(Layout {
        name: file.name,
        description: file.description,
        ideal,
        volume,
        expectations,
        brief: design,
        history: file.history,
        tiles,
        sha256,
        findings,
    })
}

fn ideal_film(ideal: &Ideal, span: &Range<usize>, problems: &mut Problems) -> Option<IdealFilm> {
    IdealFilm::new(ideal.wavelength_mm, ideal.thickness_mm, ideal.amplitude_t)
        .map_err(|faults| {
            for fault in faults.0 {
                let key = match fault {
                    IdealFilmFault::Wavelength(value) => format!("wavelength_mm = {value}"),
                    IdealFilmFault::Thickness(value) => format!("thickness_mm = {value}"),
                    IdealFilmFault::Amplitude(value) => format!("amplitude_t = {value}"),
                    other => other.to_string(),
                };
                problems.add(Some(span), "ideal", format!("{key}, {}", fault.rule()));
            }
        })
        .ok()
}

/// Reports every fault of a tile under the keys of the file.
fn report_tile_faults(faults: &[TileFault], report: &mut dyn FnMut(String)) {
    for fault in faults {
        let rule = fault.rule();
        report(match fault {
            TileFault::Position { axis, value } => format!("position_mm[{axis}] = {value}, {rule}"),
            TileFault::Size { axis, value } => format!("size_mm[{axis}] = {value}, {rule}"),
            TileFault::Aspect { shortest, .. } => format!("shortest side of size_mm = {shortest}, {rule}"),
            TileFault::Polarization { axis, value } => format!("polarization_t[{axis}] = {value}, {rule}"),
            TileFault::Rotation { norm } => format!("rotation has norm {norm}, {rule}"),
            other => other.to_string(),
        });
    }
}

/// Builds a tile, or reports everything that is wrong with it.
pub(crate) fn checked_tile(
    position_mm: DVec3,
    size_mm: DVec3,
    polarization_t: DVec3,
    report: &mut dyn FnMut(String),
) -> Option<Tile> {
    Tile::new(position_mm, size_mm, polarization_t).map_err(|faults| report_tile_faults(&faults.0, report)).ok()
}

fn check_kind(kind: &Kind, span: &Range<usize>, place: &str, problems: &mut Problems) {
    let mut report = |message: String| problems.add(Some(span), place, message);
    if kind.strength_t.is_some() && kind.polarization_t.is_some() {
        report("gives both strength_t and polarization_t, must give one".to_owned());
    }
    check_strength(kind.strength_t, &mut report);
    checked_tile(DVec3::ZERO, kind.size_mm.into(), kind.polarization_t.unwrap_or_default().into(), &mut report);
}

fn check_strength(strength_t: Option<f64>, report: &mut dyn FnMut(String)) {
    if let Some(strength) = strength_t.filter(|s| !(s.is_finite() && *s >= 0.0)) {
        report(format!(
            "strength_t = {strength}, must be a finite number of at least 0 (reverse the direction instead)"
        ));
    }
}

fn single_tile(
    entry: &TileEntry,
    name: String,
    kinds: &BTreeMap<String, toml::Spanned<Kind>>,
    report: &mut dyn FnMut(String),
) -> Option<NamedTile> {
    let kind = match &entry.kind {
        None => None,
        Some(wanted) => match kinds.get(wanted) {
            Some(kind) => Some(kind.get_ref()),
            None => {
                let known: Vec<&str> = kinds.keys().map(String::as_str).collect();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                report(format!("kind = \"{wanted}\", must be declared as [kind.{wanted}] (declared: {known})"));
                return None;
            }
        },
    };
    let size = match (entry.size_mm, kind.map(|k| k.size_mm)) {
        (Some(size), None) | (None, Some(size)) => Some(size),
        (Some(_), Some(_)) => {
            report("gives size_mm, which its kind already gives".to_owned());
            None
        }
        (None, None) => {
            report("has no size_mm and no kind that gives it".to_owned());
            None
        }
    };
    // A valid kind has been checked on its own; its faults are not repeated for every tile.
    let own_size = DVec3::from(if entry.size_mm.is_some() { size? } else { [1.0; 3] });
    let polarization = polarization(entry, kind, report).unwrap_or(DVec3::ZERO);
    let rotation = entry.rotation.map(|rotation| quaternion(rotation, report));
    checked_tile(entry.position_mm.into(), own_size, polarization, report)?;
    let mut tile = Tile::new(entry.position_mm.into(), size?.into(), polarization).ok()?;
    if let Some(rotation) = rotation {
        tile = tile.rotated(rotation?).ok()?;
    }
    Some(NamedTile { name, kind: entry.kind.clone(), rotation: entry.rotation, tile })
}

fn polarization(entry: &TileEntry, kind: Option<&Kind>, report: &mut dyn FnMut(String)) -> Option<DVec3> {
    let kind_strength = kind.and_then(|k| k.strength_t);
    let kind_polarization = kind.and_then(|k| k.polarization_t);
    let own = [entry.polarization_t.is_some(), entry.strength_t.is_some()];
    let from_kind = [kind_polarization.is_some(), kind_strength.is_some()];
    if own.iter().chain(&from_kind).filter(|given| **given).count() > 1 {
        report(
            "gives its polarization twice: one of polarization_t and strength_t, in the tile or in its kind".to_owned(),
        );
        return None;
    }
    check_strength(entry.strength_t, report);
    match (entry.polarization_t.or(kind_polarization), entry.strength_t.or(kind_strength), entry.direction) {
        (Some(polarization), _, None) => Some(polarization.into()),
        (Some(_), _, Some(_)) => {
            report("gives a direction, which goes with strength_t and not with polarization_t".to_owned());
            None
        }
        (None, Some(strength), Some(direction)) => {
            let unit = unit_vector(direction);
            if unit.is_none() {
                report(format!("direction = {direction:?}, must be finite and not zero"));
            }
            Some(unit? * strength)
        }
        (None, Some(_), None) => {
            report("has a strength_t and no direction".to_owned());
            None
        }
        (None, None, _) => {
            report("has no polarization: give polarization_t, or strength_t and direction".to_owned());
            None
        }
    }
}

/// The unit vector along `vector`, whatever its length.
pub(crate) fn unit_vector(vector: [f64; 3]) -> Option<DVec3> {
    let vector = DVec3::from(vector);
    let largest = vector.abs().max_element();
    // NaN fails the first test; max_element may pass it by.
    (vector.is_finite() && largest > 0.0).then(|| (vector / largest).normalize())
}

fn quaternion(rotation: Rotation, report: &mut dyn FnMut(String)) -> Option<DQuat> {
    let axis = unit_vector(rotation.axis);
    if axis.is_none() {
        report(format!("rotation.axis = {:?}, must be finite and not zero", rotation.axis));
    }
    if !rotation.angle_deg.is_finite() {
        report(format!("rotation.angle_deg = {}, must be a finite number", rotation.angle_deg));
        return None;
    }
    // Reduced first, exactly, so that 720 degrees are 0.
    Some(DQuat::from_axis_angle(axis?, (rotation.angle_deg % 360.0).to_radians()))
}

fn check_names(tiles: &[NamedTile], spans: &[Range<usize>], problems: &mut Problems) {
    let mut seen: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for (index, tile) in tiles.iter().enumerate() {
        let (count, last) = seen.entry(tile.name.as_str()).or_default();
        (*count, *last) = (*count + 1, index);
    }
    let repeated: Vec<_> = seen.into_iter().filter(|(_, (count, _))| *count > 1).collect();
    for (name, (count, last)) in repeated.iter().take(NAMED_PROBLEMS) {
        let place = format!("tile \"{name}\"");
        problems.add(Some(&spans[*last]), &place, format!("{count} tiles have this name, names must be unique"));
    }
    if repeated.len() > NAMED_PROBLEMS {
        problems.add(None, "layout", format!("{} more names are not unique", repeated.len() - NAMED_PROBLEMS));
    }
}

fn check_overlaps(tiles: &[NamedTile], spans: &[Range<usize>], problems: &mut Problems) {
    let bare: Vec<Tile> = tiles.iter().map(|t| t.tile).collect();
    let mut found = overlaps(&bare);
    for overlap in found.by_ref().take(NAMED_PROBLEMS) {
        let (first, second) = (&tiles[overlap.first].name, &tiles[overlap.second].name);
        let d = overlap.direction;
        problems.add(
            Some(&spans[overlap.second]),
            &format!("tiles \"{first}\" and \"{second}\""),
            format!(
                "overlap by {} mm, must not overlap: move \"{second}\" that far along ({:.3}, {:.3}, {:.3})",
                overlap.depth, d.x, d.y, d.z
            ),
        );
    }
    if found.next().is_some() {
        problems.add(None, "layout", "more pairs of tiles overlap");
    }
}
