//! `[tolerance]`: the errors of the films that are made from a layout.

use std::path::Path;

use magsplice_magnet::BoundingBox;
use toml::Spanned;

use self::selection::Selection;
use self::tabulated::Tabulated;
use crate::distribution::Distribution;
use crate::finding::{Finding, FindingSubject};
use crate::layout::NamedTile;
use crate::limits::{MAX_TOLERANCE_TILES, SAMPLE_COUNTS};
use crate::read::faults::{Faults, TableFaults};
use crate::read::findings::listed;
use crate::read::tables_present::TablesPresent;
use crate::tables::tolerance::ToleranceTable;
use crate::tolerance::{CommonErrors, ErrorGroup, FilmTolerance};

/// Errors that all tiles share.
mod common_errors;
/// Rules of single distributions.
mod distribution;
/// Groups of tiles.
mod groups;
/// Another film nearby.
mod neighbour;
/// Tiles by names and kinds.
mod selection;
/// Measured errors in files and in the layout.
mod tabulated;
/// Errors of tiles: preset, kinds, single tiles.
mod tile_errors;

/// Reads the tiles of a neighbour's layout at a path, or says why there are none.
pub(crate) type ReadTiles<'r> = &'r dyn Fn(&str) -> Result<Vec<NamedTile>, String>;

/// What `[tolerance]` refers to in its layout.
pub(crate) struct WholeLayout<'t> {
    pub(crate) tiles: &'t [NamedTile],
    /// Names of the kinds that the layout declares.
    pub(crate) kinds: Vec<&'t String>,
    /// That of the material.
    pub(crate) strength_per_k: Option<f64>,
    /// Whether all tiles of the file are there, because none of them has a fault.
    pub(crate) is_complete: bool,
    pub(crate) present: TablesPresent,
}

/// The errors of films, or `None` after adding faults. Paths are relative to `folder`.
pub(crate) fn resolve(
    table: &Spanned<ToleranceTable>,
    layout: WholeLayout,
    folder: &Path,
    read_neighbour: ReadTiles,
    faults: &mut Faults,
    findings: &mut Vec<Finding>,
) -> Option<FilmTolerance> {
    let (span, table) = (table.span(), table.get_ref());
    let WholeLayout { tiles, kinds, strength_per_k, is_complete, present } = layout;
    let before = faults.count();
    if tiles.len() > MAX_TOLERANCE_TILES {
        let count = tiles.len();
        faults
            .at(&span, "tolerance")
            .add(format!("the layout has {count} tiles, must have at most {MAX_TOLERANCE_TILES} with [tolerance]"));
        return None;
    }
    let defaults = FilmTolerance::default();
    let samples = table.samples.unwrap_or(defaults.samples);
    check_samples(samples, &mut faults.at(&span, "tolerance"));
    let mut tabulated = Tabulated::new(folder.to_owned());
    let mut selection = Selection::new(tiles, kinds.into_iter(), is_complete);
    let of_tiles = tile_errors::resolve(table, &span, &mut selection, &mut tabulated, faults);
    let groups = groups::resolve(&table.group, &mut selection, &mut tabulated, faults);
    let film_mm = longest_side(tiles);
    let mut common = common_errors::resolve(table, film_mm, strength_per_k, &mut tabulated, faults, findings);
    common.neighbour = table.neighbour.as_ref().and_then(|table| {
        neighbour::resolve(table.get_ref(), read_neighbour, &mut faults.at(&table.span(), "tolerance.neighbour"))
    });
    if faults.count() > before {
        return None;
    }
    let found = FilmTolerance { tiles: of_tiles, groups, common, samples, seed: table.seed.unwrap_or(defaults.seed) };
    remark(&found, present, findings);
    Some(found)
}

/// Requires a number of samples that can be evaluated.
pub(crate) fn check_samples(samples: u64, faults: &mut TableFaults) {
    if !SAMPLE_COUNTS.contains(&samples) {
        let (least, most) = (SAMPLE_COUNTS.start(), SAMPLE_COUNTS.end());
        faults.add(format!("samples = {samples}, must be from {least} to {most}"));
    }
}

fn longest_side(tiles: &[NamedTile]) -> Option<f64> {
    let boxes = tiles.iter().map(|named| BoundingBox::from_tile(&named.tile));
    let ends: Vec<_> = boxes.flat_map(|around| [around.lower, around.upper]).collect();
    (!ends.is_empty()).then(|| 2.0 * BoundingBox::from_points(&ends).half_size().max_element())
}

/// Findings about tolerances without effect, and about those that nothing evaluates.
fn remark(found: &FilmTolerance, present: TablesPresent, findings: &mut Vec<Finding>) {
    let mut add = |message: String| findings.push(Finding::new(FindingSubject::Tolerance, message));
    if found.tiles.is_empty() && found.groups.is_empty() && found.common == CommonErrors::default() {
        add("tolerance: states no errors, so that every film is as in the layout: give a preset, such as \"workshop\", \
             or errors"
            .to_owned());
    }
    let missing: Vec<&str> = [("[ideal]", present.ideal), ("[volume]", present.volume)]
        .into_iter()
        .filter(|(_, is_there)| !is_there)
        .map(|(table, _)| table)
        .collect();
    if !missing.is_empty() {
        add(format!(
            "tolerance: its effect is evaluated only beside {}, which the layout does not have",
            missing.join(" and ")
        ));
    }
    let idle = found.groups.iter().filter(|group| group.errors.values().all(Distribution::is_none));
    let is_idle =
        |group: &ErrorGroup| format!("tolerance.group \"{}\": all errors are 0, so that it has no effect", group.name);
    findings.extend(listed(idle, FindingSubject::Tolerance, is_idle, "groups"));
}
