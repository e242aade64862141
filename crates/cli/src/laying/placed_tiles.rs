//! Tiles that lie already, from a CSV file with the columns of a plan.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use magsplice::layout::Layout;
use magsplice::making::{CutTile, Orientation, PlaceGroup};
use magsplice::prelude::{DQuat, DVec3, Tile};

use super::laying_plan::{PlanRow, mark_deg, upper_side};
use crate::csv_input::cells::{number, vector};
use crate::csv_input::finder::{ANGLES, Column, Finder, NO_UNIT};
use crate::csv_input::limited_lines::shown;
use crate::csv_input::table::{CsvTable, Row};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::units::LENGTHS;

/// The line of names that messages show.
const EXAMPLE: &str = "place,tile,x_mm,y_mm,z_mm,up,mark_deg";

/// Angle between a mark and the direction that it has at its place, beyond which the tile lies in another
/// orientation.
const MOST_TURN_DEG: f64 = 45.0;

/// What a film that is partly laid has left to do.
pub(crate) struct PartlyLaid {
    /// The film, with the tiles that lie as they lie.
    pub(crate) film: Vec<Tile>,
    /// Places and tiles that are left.
    pub(crate) groups: Vec<PlaceGroup>,
    /// The tiles that lie.
    pub(crate) rows: Vec<(usize, PlanRow)>,
}

struct Columns {
    place: Column,
    tile: Column,
    position: Option<[Column; 3]>,
    up: Option<Column>,
    mark: Column,
    laid: Option<Column>,
}

/// Reads which of the tiles of `groups` lie in the film of a layout. The failure lists all rows that break
/// rules.
pub(crate) fn read(path: &Path, layout: &Layout, groups: &[PlaceGroup]) -> Result<PartlyLaid, Failure> {
    let failed = |message: String| Failure::Points { path: path.to_owned(), message };
    let has_names = |names: &[String]| {
        ["place", "tile"].iter().all(|wanted| names.iter().any(|name| name.trim().eq_ignore_ascii_case(wanted)))
    };
    let mut table = CsvTable::open(path, has_names, EXAMPLE).map_err(failed)?;
    let place = path.display().to_string();
    let mut faults = FaultList::default();
    let columns = match columns(&table.names) {
        Ok(columns) => columns,
        Err(found) => {
            let line = table.names_line;
            found.into_iter().for_each(|fault| faults.add(line, format!("line {line}: {fault}")));
            return Err(faults.failure(place));
        }
    };
    let mut laying = Laying::new(layout, groups);
    while let Some(row) = table.next_row().map_err(failed)? {
        match row {
            Row::Fault(line, fault) => faults.add(line, fault),
            Row::Cells(line) => {
                let laid = columns.laid.map_or("yes", |column| table.cell(column.index)).to_lowercase();
                match laid.as_str() {
                    "yes" => {
                        if let Err(found) = laying.add(&columns, &mut table, line) {
                            faults.add(line, format!("line {line}: {}", found.join("; ")));
                        }
                    }
                    "no" => {}
                    other => {
                        faults.add(line, format!("line {line}: laid = \"{}\", must be yes or no", shown(other)));
                    }
                }
            }
        }
    }
    if faults.is_empty() { Ok(laying.finish()) } else { Err(faults.failure(place)) }
}

fn columns(names: &[String]) -> Result<Columns, Vec<String>> {
    let mut finder = Finder::new(names);
    let mut text = |name: &str| finder.group(name, [[name]], &NO_UNIT, None).map(|[column]| column);
    let (place, tile, up, laid) = (text("place"), text("tile"), text("up"), text("laid"));
    let position = finder.group("position", [["x"], ["y"], ["z"]], &LENGTHS, None);
    // The axis of the mark is in a column of its own, which follows from the side that is up.
    let angles: Vec<String> =
        names.iter().map(|name| if name.trim() == "mark" { String::new() } else { name.clone() }).collect();
    let mut of_angles = Finder::new(&angles);
    let mark = of_angles.group("direction of the mark", [["mark"]], &ANGLES, None).map(|[column]| column);
    finder.faults.append(&mut of_angles.faults);
    if mark.is_none() {
        finder.missing("direction of the mark: mark_deg");
    }
    match (place, tile, mark) {
        (Some(place), Some(tile), Some(mark)) if finder.faults.is_empty() => {
            Ok(Columns { place, tile, position, up, mark, laid })
        }
        _ => Err(finder.faults),
    }
}

/// A film while its tiles are added.
struct Laying<'a> {
    layout: &'a Layout,
    groups: &'a [PlaceGroup],
    film: Vec<Tile>,
    rows: Vec<(usize, PlanRow)>,
    /// Group and index of each tile, by its name.
    tiles: HashMap<&'a str, (usize, usize)>,
    /// Index and group of each place, by its name. Shims and places without a part have no group.
    places: HashMap<&'a str, (usize, Option<usize>)>,
    used: HashSet<(usize, usize)>,
    filled: HashSet<usize>,
}

impl<'a> Laying<'a> {
    fn new(layout: &'a Layout, groups: &'a [PlaceGroup]) -> Laying<'a> {
        let mut tiles = HashMap::new();
        let mut group_of = HashMap::new();
        for (number, group) in groups.iter().enumerate() {
            for (index, tile) in group.tiles.iter().enumerate() {
                tiles.insert(tile.name.as_str(), (number, index));
            }
            group.places.iter().for_each(|place| {
                group_of.insert(*place, number);
            });
        }
        let place = |(index, named): (usize, &'a magsplice::layout::NamedTile)| {
            (named.name.as_str(), (index, group_of.get(&index).copied()))
        };
        Laying {
            layout,
            groups,
            film: layout.bare_tiles(),
            rows: Vec::new(),
            tiles,
            places: layout.tiles.iter().enumerate().map(place).collect(),
            used: HashSet::new(),
            filled: HashSet::new(),
        }
    }

    /// Adds the tile of a row, or tells everything that is wrong with it.
    fn add(&mut self, columns: &Columns, table: &mut CsvTable, line: u64) -> Result<(), Vec<String>> {
        let mut faults = Vec::new();
        let (place_name, tile_name) =
            (table.cell(columns.place.index).to_owned(), table.cell(columns.tile.index).to_owned());
        let place = self.places.get(place_name.as_str()).copied();
        let tile = self.tiles.get(tile_name.as_str()).copied();
        let (place_shown, tile_shown) = (shown(&place_name), shown(&tile_name));
        match place {
            None => faults.push(format!("place = \"{place_shown}\", must be the name of a tile of the layout")),
            Some((place, _)) if !self.filled.insert(place) => {
                faults.push(format!("place \"{place_shown}\" has a tile already"));
            }
            Some(_) => {}
        }
        match tile {
            None => faults.push(format!("tile = \"{tile_shown}\", must be one of the measured tiles")),
            Some(tile) if !self.used.insert(tile) => {
                faults.push(format!("tile \"{tile_shown}\" lies elsewhere already"));
            }
            Some(_) => {}
        }
        let position = match &columns.position {
            Some(columns) => vector(columns, table, line, &mut faults),
            None => place.map(|(place, _)| self.film[place].position()),
        };
        let measured_deg = number(columns.mark, table, line, &mut faults);
        let up = columns.up.map_or("+z", |column| table.cell(column.index)).to_owned();
        let (Some((place, of_place)), Some((group, index)), Some(position)) = (place, tile, position) else {
            return Err(faults);
        };
        if of_place != Some(group) {
            let number = |group: usize| group + 1;
            faults.push(match of_place {
                Some(wanted) => format!(
                    "tile \"{tile_shown}\" is of part {}, place \"{place_shown}\" of part {}",
                    number(group),
                    number(wanted)
                ),
                None => format!("place \"{place_shown}\" is a shim"),
            });
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let (orientation, turn_deg) = self.orientation(group, place, &up, measured_deg).map_err(|fault| vec![fault])?;
        let cut = &self.groups[group].tiles[index];
        let lies = lying(cut, &self.film[place], orientation, position, turn_deg).map_err(|fault| vec![fault])?;
        self.film[place] = lies;
        self.rows.push((place, PlanRow::new(&self.layout.tiles[place].name, &tile_name, orientation, &lies, true)));
        Ok(())
    }

    /// The orientation in which a tile lies, and the angle by which it is turned about z beyond it.
    fn orientation(&self, group: usize, place: usize, up: &str, deg: f64) -> Result<(Orientation, f64), String> {
        let at = &self.film[place];
        let fitting = self.groups[group].orientations_at(at, true);
        let turn = |orientation: &Orientation| {
            let difference = (deg - mark_deg(*orientation, at)).rem_euclid(360.0);
            if difference > 180.0 { difference - 360.0 } else { difference }
        };
        let nearest = fitting
            .iter()
            .filter(|orientation| upper_side(**orientation) == up)
            .min_by(|a, b| turn(a).abs().total_cmp(&turn(b).abs()));
        match nearest {
            Some(orientation) if turn(orientation).abs() <= MOST_TURN_DEG => Ok((*orientation, turn(orientation))),
            _ => {
                let possible: Vec<String> = fitting
                    .iter()
                    .map(|orientation| format!("{} at {:.0}", upper_side(*orientation), mark_deg(*orientation, at)))
                    .collect();
                Err(format!(
                    "with {} up and its mark at {deg} deg, its polarization is not that of the place, must be near: {} deg",
                    shown(up),
                    possible.join(", ")
                ))
            }
        }
    }

    fn finish(self) -> PartlyLaid {
        let mut groups = self.groups.to_vec();
        for (number, group) in groups.iter_mut().enumerate() {
            group.places.retain(|place| !self.filled.contains(place));
            let mut index = 0;
            group.tiles.retain(|_| {
                index += 1;
                !self.used.contains(&(number, index - 1))
            });
        }
        PartlyLaid { film: self.film, groups, rows: self.rows }
    }
}

/// A tile at a measured position, turned about z beyond its orientation.
fn lying(
    cut: &CutTile,
    place: &Tile,
    orientation: Orientation,
    position: DVec3,
    turn_deg: f64,
) -> Result<Tile, String> {
    let rotation = DQuat::from_rotation_z(turn_deg.to_radians()) * place.rotation();
    Tile::new(position, orientation.sides(cut.size_mm), orientation.apply(cut.polarization_t))
        .and_then(|tile| if turn_deg == 0.0 { tile.rotated(place.rotation()) } else { tile.rotated(rotation) })
        .map_err(|faults| faults.to_string())
}
