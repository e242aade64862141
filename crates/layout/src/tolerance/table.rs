//! `[tolerance]` as it is written, its rules, and the way back.

use std::collections::BTreeMap;
use std::path::Path;

use magsplice_magnet::BoundingBox;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::Faults;
use crate::finding::{Finding, FindingSubject, listed};
use crate::layout::NamedTile;
use crate::limits::MAX_TOLERANCE_TILES;
use crate::names::shown;
use crate::places::Place;
use crate::tables_present::TablesPresent;
use crate::tolerance::common::{FilmTable, SensorTable, StrayFieldTable, TemperatureTable};
use crate::tolerance::distribution::Distribution;
use crate::tolerance::groups::{self, GroupTable};
use crate::tolerance::neighbour::NeighbourTable;
use crate::tolerance::presets::Preset;
use crate::tolerance::selection::Selection;
use crate::tolerance::tabulated::{ErrorTable, Tabulated};
use crate::tolerance::tile_errors::{ErrorKeys, replace};
use crate::tolerance::{CommonErrors, ErrorGroup, FilmTolerance, TileErrors};

/// The errors of the films that are made from the layout. A plain number is the standard deviation
/// of normal errors of mean 0; a table gives another distribution. Errors of different tiles, axes
/// and keys are independent.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct ToleranceTable {
    /// Usual errors of a way to make films. The keys beside it replace its numbers.
    preset: Option<Preset>,
    /// Errors of each tile.
    #[serde(flatten)]
    errors: ErrorKeys,
    /// Number of films that `check` and `tolerance` evaluate. Default: 1000.
    samples: Option<u64>,
    /// Seed of the random numbers. Default: 1.
    seed: Option<u64>,
    /// Pose of the film against the sensor.
    film: Option<FilmTable>,
    /// A uniform field from elsewhere, such as that of the earth.
    stray_field: Option<StrayFieldTable>,
    /// Another film nearby.
    neighbour: Option<NeighbourTable>,
    /// A change of temperature after the reading at the reference point.
    temperature: Option<TemperatureTable>,
    /// Errors of the sensor.
    sensor: Option<SensorTable>,
    /// Errors of the tiles of a kind, by its name. They replace those above, key by key.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    kind: BTreeMap<String, ErrorKeys>,
    /// Errors of tiles by name. They replace those of kinds, and later entries replace earlier
    /// ones, key by key.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    tile: Vec<TileErrorsTable>,
    /// Groups of tiles that move or change together, in addition to the errors of each tile.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    group: Vec<GroupTable>,
}

/// Errors of tiles by name.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct TileErrorsTable {
    /// Names of tiles. An asterisk stands for any letters, unless the text is the name of a tile.
    #[schemars(extend("example" = "[\"corner*\"]"))]
    tiles: Vec<String>,
    #[serde(flatten)]
    errors: ErrorKeys,
}

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

impl ToleranceTable {
    /// The errors of films, or `None` after adding faults. Paths are relative to `folder`.
    pub(crate) fn resolve(
        &self,
        layout: WholeLayout,
        folder: &Path,
        read_neighbour: ReadTiles,
        place: &Place,
        faults: &mut Faults,
        findings: &mut Vec<Finding>,
    ) -> Option<FilmTolerance> {
        let WholeLayout { tiles, kinds, strength_per_k, is_complete, present } = layout;
        let before = faults.count();
        if tiles.len() > MAX_TOLERANCE_TILES {
            let count = tiles.len();
            faults
                .at(place.start, "tolerance")
                .add(format!("the layout has {count} tiles, must have at most {MAX_TOLERANCE_TILES} with [tolerance]"));
            return None;
        }
        let defaults = FilmTolerance::default();
        let samples = self.samples.unwrap_or(defaults.samples);
        faults.at(place.start, "tolerance").sample_count(samples);
        let mut tabulated = Tabulated::new(folder.to_owned());
        let mut selection = Selection::new(tiles, kinds.into_iter(), is_complete);
        let of_tiles = self.tile_errors(place, &mut selection, &mut tabulated, faults);
        let groups = groups::resolve(&self.group, place.key("group"), &mut selection, &mut tabulated, faults);
        let common = self.common_errors(tiles, strength_per_k, read_neighbour, place, &mut tabulated, faults, findings);
        if faults.count() > before {
            return None;
        }
        let seed = self.seed.unwrap_or(defaults.seed);
        let found = FilmTolerance { tiles: of_tiles, groups, common, samples, seed };
        remark(&found, present, findings);
        Some(found)
    }

    /// The errors of each tile, or nothing if no tile has errors. Faults are added.
    fn tile_errors(
        &self,
        place: &Place,
        selection: &mut Selection,
        tabulated: &mut Tabulated,
        faults: &mut Faults,
    ) -> Vec<TileErrors> {
        let count = selection.tiles.len();
        let mut base = self.preset.map_or_else(TileErrors::default, Preset::errors);
        let shortest = selection.shortest_side(0..count);
        let mut at = ErrorTable { tabulated, faults: faults.at(place.start, "tolerance") };
        let given = self.errors.resolve(shortest, &mut at);
        replace(&given, &mut base);
        let mut tiles = vec![base; count];
        for (kind, errors) in &self.kind {
            let start = place.key("kind").key(kind).start;
            let faults = faults.at(start, format!("tolerance.kind \"{}\"", shown(kind)));
            let mut at = ErrorTable { tabulated, faults };
            selection.check_kind("[tolerance.kind]", kind, &mut at.faults);
            let chosen = selection.by_kind().get(kind.as_str()).map_or(&[][..], Vec::as_slice);
            let shortest = selection.shortest_side(chosen.iter().copied());
            let given = errors.resolve_some(shortest, &mut at);
            chosen.iter().for_each(|&index| replace(&given, &mut tiles[index]));
        }
        for (index, entry) in self.tile.iter().enumerate() {
            let faults = faults.at(place.key("tile").item(index).start, "tolerance.tile");
            let mut at = ErrorTable { tabulated, faults };
            let chosen = selection.of_names("tiles", &entry.tiles, &mut at.faults);
            if entry.tiles.is_empty() {
                at.faults.add("tiles is empty, must name at least one tile");
            }
            let shortest = selection.shortest_side(chosen.iter().copied());
            let given = entry.errors.resolve_some(shortest, &mut at);
            chosen.into_iter().for_each(|index| replace(&given, &mut tiles[index]));
        }
        let has_errors = |errors: &TileErrors| errors.values().any(|error| !error.is_none());
        if tiles.iter().any(has_errors) { tiles } else { Vec::new() }
    }

    /// The errors of all tables but those of tiles. Faults are added.
    #[expect(clippy::too_many_arguments, reason = "what the tables refer to")]
    fn common_errors(
        &self,
        tiles: &[NamedTile],
        strength_per_k: Option<f64>,
        read_neighbour: ReadTiles,
        place: &Place,
        tabulated: &mut Tabulated,
        faults: &mut Faults,
        findings: &mut Vec<Finding>,
    ) -> CommonErrors {
        let mut common = CommonErrors::default();
        if let Some(film) = &self.film {
            common.film =
                film.resolve(longest_side(tiles), &mut ErrorTable::at("film", place, tabulated, faults), findings);
        }
        if let Some(field) = &self.stray_field {
            common.stray_field =
                Some(field.resolve(&mut ErrorTable::at("stray_field", place, tabulated, faults), findings));
        }
        if let Some(change) = &self.temperature {
            common.temperature = Some(change.resolve(
                strength_per_k,
                &mut ErrorTable::at("temperature", place, tabulated, faults),
                findings,
            ));
        }
        if let Some(sensor) = &self.sensor {
            common.sensor = sensor.resolve(&mut ErrorTable::at("sensor", place, tabulated, faults), findings);
        }
        if let Some(neighbour) = &self.neighbour {
            common.neighbour =
                neighbour.resolve(read_neighbour, &mut ErrorTable::at("neighbour", place, tabulated, faults).faults);
        }
        common
    }

    /// The table of tolerances. `names` are those of the tiles, in the order of the errors.
    pub(crate) fn of(tolerance: &FilmTolerance, names: &[&str]) -> ToleranceTable {
        let FilmTolerance { tiles, groups, common, samples, seed } = tolerance;
        let (errors, others) = ErrorKeys::of_tiles(tiles);
        let named = |tiles: &[usize]| tiles.iter().map(|&tile| names[tile].to_owned()).collect::<Vec<String>>();
        ToleranceTable {
            preset: None,
            errors,
            samples: Some(*samples),
            seed: Some(*seed),
            film: FilmTable::some(&common.film),
            stray_field: common.stray_field.as_ref().map(Into::into),
            neighbour: common.neighbour.as_ref().map(Into::into),
            temperature: common.temperature.as_ref().map(Into::into),
            sensor: SensorTable::some(&common.sensor),
            kind: BTreeMap::new(),
            tile: others.into_iter().map(|(tiles, errors)| TileErrorsTable { tiles: named(&tiles), errors }).collect(),
            group: groups.iter().map(|group| GroupTable::of(group, named(&group.tiles))).collect(),
        }
    }

    /// Without the numbers of samples, which determine no sample.
    pub(crate) fn without_samples(self) -> ToleranceTable {
        ToleranceTable { samples: None, seed: None, ..self }
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
