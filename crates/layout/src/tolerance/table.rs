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
use crate::tolerance::iron::IronTable;
use crate::tolerance::neighbour::NeighbourTable;
use crate::tolerance::presets::Preset;
use crate::tolerance::selection::Selection;
use crate::tolerance::tabulated::{ErrorTables, Tabulated};
use crate::tolerance::tile_errors::{ErrorKeys, GivenErrors, replace};
use crate::tolerance::{CommonErrors, ErrorGroup, FilmPose, FilmTolerance, SensorErrors, TileErrors};

/// The errors of films as made. A plain number is the standard deviation of normal errors of mean
/// 0; a table gives another distribution. Errors of different tiles, axes and keys are independent.
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
    /// Flat iron near the film.
    #[serde(skip_serializing_if = "Option::is_none")]
    iron: Option<IronTable>,
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

/// Reads the tiles of a neighbour's layout at a path, or reports why there are none.
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
        mut self,
        layout: WholeLayout,
        folder: &Path,
        read_neighbour: ReadTiles,
        place: &Place,
        faults: &mut Faults,
    ) -> Option<FilmTolerance> {
        let WholeLayout { tiles, kinds, strength_per_k, is_complete, present } = layout;
        let (before, count) = (faults.count(), tiles.len());
        let mut own = faults.at(place.start, "tolerance");
        if count > MAX_TOLERANCE_TILES {
            let rule = format_args!("must have at most {MAX_TOLERANCE_TILES} with [tolerance]");
            return own.refuse(format!("the layout has {count} tiles, {rule}"));
        }
        let defaults = FilmTolerance::default();
        own.sample_count(self.samples);
        let mut tables = ErrorTables { place, tabulated: Tabulated::new(folder.to_owned()), faults };
        let mut selection = Selection::new(tiles, kinds.into_iter(), is_complete);
        let of_tiles = self.tile_errors(&mut selection, &mut tables);
        let groups = groups::resolve(self.group, &mut selection, &mut tables);
        let film = self.film.map(|film| film.resolve(longest_side(tiles), &mut tables.key("film")));
        let stray_field = self.stray_field.map(|field| field.resolve(&mut tables.key("stray_field")));
        let temperature = self.temperature.map(|change| change.resolve(strength_per_k, &mut tables.key("temperature")));
        let iron = self.iron.and_then(|iron| iron.resolve(&mut tables.key("iron")));
        let sensor = self.sensor.map(|sensor| sensor.resolve(&mut tables.key("sensor")));
        let mut neighbour_faults = tables.key("neighbour").faults;
        let neighbour = self.neighbour.and_then(|film| film.resolve(read_neighbour, &mut neighbour_faults));
        if iron.is_some() && neighbour.is_some() {
            // The neighbour has images in the iron, too.
            tables.key("iron").faults.add("stands beside [tolerance.neighbour], must be alone: leave one of them out");
        }
        if iron.is_some() && present.plane {
            tables.key("iron").faults.add("stands beside [[plane]], must be alone: leave one of them out");
        }
        if faults.count() > before {
            return None;
        }
        let (film, sensor) = (film.unwrap_or_default(), sensor.unwrap_or_default());
        let common = CommonErrors { film, stray_field, neighbour, iron, temperature, sensor };
        let (samples, seed) = (self.samples.unwrap_or(defaults.samples), self.seed.unwrap_or(defaults.seed));
        let found = FilmTolerance { tiles: of_tiles, groups, common, samples, seed };
        let found = match found.of_whole_discs(tiles) {
            Ok(found) => found,
            Err(fault) => return faults.at(place.start, "tolerance").refuse(fault.to_string()),
        };
        remark(&found, present, faults);
        Some(found)
    }

    /// The errors of each tile, or nothing if no tile has errors. Faults are added.
    fn tile_errors(&mut self, selection: &mut Selection, tables: &mut ErrorTables) -> Vec<TileErrors> {
        let all: Vec<usize> = (0..selection.tiles.len()).collect();
        let mut tiles = vec![self.preset.map_or_else(TileErrors::default, Preset::errors); all.len()];
        let mut set = |chosen: &[usize], given: GivenErrors| {
            chosen.iter().for_each(|&index| replace(&given, &mut tiles[index]));
        };
        let (place, mut at) = (tables.place, tables.at(tables.place, "tolerance"));
        set(&all, self.errors.read(selection.shortest_side(&all), &mut at));
        for (kind, errors) in &mut self.kind {
            let mut at = tables.at(place.key("kind").key(kind), format!("tolerance.kind \"{}\"", shown(kind)));
            selection.check_kind("[tolerance.kind]", kind, &mut at.faults);
            let chosen = selection.by_kind.get(kind.as_str()).map_or(&[][..], Vec::as_slice);
            set(chosen, errors.read_some(selection.shortest_side(chosen), &mut at));
        }
        for (index, entry) in self.tile.iter_mut().enumerate() {
            let mut at = tables.at(place.key("tile").item(index), "tolerance.tile");
            let chosen = selection.of_names("tiles", &entry.tiles, &mut at.faults);
            if entry.tiles.is_empty() {
                at.faults.add("tiles is empty, must have at least one tile");
            }
            set(&chosen, entry.errors.read_some(selection.shortest_side(&chosen), &mut at));
        }
        let has_errors = |errors: &TileErrors| errors.values().any(|error| !error.is_none());
        if tiles.iter().any(has_errors) { tiles } else { Vec::new() }
    }

    /// The table of tolerances. `names` are the names of the tiles, in the order of the errors.
    pub(crate) fn of(tolerance: &FilmTolerance, names: &[&str]) -> ToleranceTable {
        let FilmTolerance { tiles, groups, common, samples, seed } = tolerance;
        let (errors, others) = ErrorKeys::of_tiles(tiles);
        let named = |tiles: &[usize]| tiles.iter().map(|&tile| names[tile].to_owned()).collect::<Vec<String>>();
        ToleranceTable {
            preset: None,
            errors,
            samples: Some(*samples),
            seed: Some(*seed),
            film: (common.film != FilmPose::default()).then(|| (&common.film).into()),
            stray_field: common.stray_field.as_ref().map(Into::into),
            neighbour: common.neighbour.as_ref().map(Into::into),
            iron: common.iron.as_ref().map(Into::into),
            temperature: common.temperature.as_ref().map(Into::into),
            sensor: (common.sensor != SensorErrors::default()).then(|| (&common.sensor).into()),
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
    let around = BoundingBox::from_tiles(tiles.iter().map(|named| &named.tile));
    (!tiles.is_empty()).then(|| 2.0 * around.half_size().max_element())
}

/// Findings about tolerances without effect, and about tolerances that nothing evaluates.
fn remark(found: &FilmTolerance, present: TablesPresent, faults: &mut Faults) {
    let mut add = |message: String| faults.findings.push(Finding::new(FindingSubject::Tolerance, message));
    if found.tiles.is_empty() && found.groups.is_empty() && found.common == CommonErrors::default() {
        add("tolerance: has no errors, so that every film equals the layout: give a preset, such as \"workshop\", \
             or errors"
            .to_owned());
    }
    let needed = [("[ideal]", present.ideal), ("[volume]", present.volume)];
    let missing: Vec<&str> = needed.into_iter().filter(|(_, is_there)| !is_there).map(|(table, _)| table).collect();
    if !missing.is_empty() {
        add(format!(
            "tolerance: its effect is evaluated only together with {}, which the layout does not have",
            missing.join(" and ")
        ));
    }
    let idle = found.groups.iter().filter(|group| group.errors.values().all(Distribution::is_none));
    let is_idle =
        |group: &ErrorGroup| format!("tolerance.group \"{}\": all errors are 0, so that it has no effect", group.name);
    faults.findings.extend(listed(idle, FindingSubject::Tolerance, is_idle, "groups"));
}
