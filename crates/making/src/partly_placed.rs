//! Films with some tiles already placed.

use std::collections::{HashMap, HashSet};

use glam::{DQuat, DVec3};
use magsplice_layout::{Layout, NamedTile};
use magsplice_magnet::Tile;

use crate::assignment::PlaceGroup;
use crate::measured_box::beginning;
use crate::orientation::Orientation;
use crate::plan_row::PlanRow;

/// Largest angle between a mark and its nominal direction. Beyond it the tile has another
/// orientation.
const MOST_TURN_DEG: f64 = 45.0;

/// A film with some tiles placed, and the remaining assignment.
#[derive(Clone, Debug, PartialEq)]
pub struct PartlyPlaced {
    /// The film, with placed tiles at their actual positions.
    pub film: Vec<Tile>,
    /// The remaining places and tiles.
    pub groups: Vec<PlaceGroup>,
    /// The placed tiles, each with the index of its place.
    pub plan: Vec<(usize, PlanRow)>,
}

/// A tile already placed in a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedTile<'a> {
    /// Name of its place.
    pub place: &'a str,
    /// Name of the tile.
    pub tile: &'a str,
    /// Measured centre. `None` for the centre of the place.
    pub position_mm: Option<DVec3>,
    /// The upward side of the tile, such as `+z`.
    pub up: &'a str,
    /// Direction of the mark, in degrees from the x axis of the film towards its y axis.
    pub mark_deg: f64,
}

/// A film during the placement of its tiles.
#[derive(Clone, Debug)]
pub struct Placement<'a> {
    layout: &'a Layout,
    groups: &'a [PlaceGroup],
    film: Vec<Tile>,
    plan: Vec<(usize, PlanRow)>,
    /// Group and index of each tile, by its name.
    tiles: HashMap<&'a str, (usize, usize)>,
    /// Index and group of each place, by its name. Shims and places without a part have no group.
    places: HashMap<&'a str, (usize, Option<usize>)>,
    used: HashSet<(usize, usize)>,
    filled: HashSet<usize>,
}

impl<'a> Placement<'a> {
    /// The film of a layout without placed tiles. The groups have its places and the measured
    /// tiles.
    pub fn new(layout: &'a Layout, groups: &'a [PlaceGroup]) -> Placement<'a> {
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
        let place =
            |(index, named): (usize, &'a NamedTile)| (named.name.as_str(), (index, group_of.get(&index).copied()));
        Placement {
            layout,
            groups,
            film: layout.bare_tiles(),
            plan: Vec::new(),
            tiles,
            places: layout.tiles.iter().enumerate().map(place).collect(),
            used: HashSet::new(),
            filled: HashSet::new(),
        }
    }

    /// Places a tile.
    ///
    /// # Errors
    /// Every broken rule, in words. The film is then unchanged.
    pub fn place(&mut self, placed: &FixedTile) -> Result<(), Vec<String>> {
        let mut faults = Vec::new();
        let place = self.places.get(placed.place).copied();
        let tile = self.tiles.get(placed.tile).copied();
        let (place_shown, tile_shown) = (beginning(placed.place), beginning(placed.tile));
        match place {
            None => faults.push(format!("place = \"{place_shown}\", must be the name of a tile of the layout")),
            Some((place, _)) if self.filled.contains(&place) => {
                faults.push(format!("place \"{place_shown}\" already has a tile"));
            }
            Some(_) => {}
        }
        match tile {
            None => faults.push(format!("tile = \"{tile_shown}\", must be one of the measured tiles")),
            Some(tile) if self.used.contains(&tile) => {
                faults.push(format!("tile \"{tile_shown}\" is already placed elsewhere"));
            }
            Some(_) => {}
        }
        let (Some((place, of_place)), Some((group, index))) = (place, tile) else {
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
        let ordered = &self.film[place];
        let position = placed.position_mm.unwrap_or(ordered.position());
        let away = (ordered.rotation().inverse() * (position - ordered.position())).abs();
        if position.is_finite() && !away.cmple(0.5 * ordered.size()).all() {
            let shown = |at: DVec3| {
                let [x, y, z] = at.to_array().map(|mm| (1e6 * mm).round() / 1e6);
                format!("({x}, {y}, {z}) mm")
            };
            return Err(vec![format!(
                "the tile at {} is not at place \"{place_shown}\", whose centre is at {}: it must be within half a side of \
                 it along each side",
                shown(position),
                shown(ordered.position())
            )]);
        }
        let (orientation, turn_deg) =
            self.orientation(group, place, placed.up, placed.mark_deg).map_err(|fault| vec![fault])?;
        let cut = &self.groups[group].tiles[index];
        let as_ordered = self.film[place].rotation();
        let turned = DQuat::from_rotation_z(turn_deg.to_radians()) * as_ordered;
        let rotation = if turn_deg == 0.0 { as_ordered } else { turned };
        let lies = cut.turned(position, rotation, orientation).map_err(|faults| vec![faults.to_string()])?;
        self.filled.insert(place);
        self.used.insert((group, index));
        self.film[place] = lies;
        self.plan.push((place, PlanRow::new(&self.layout.tiles[place].name, placed.tile, orientation, &lies, true)));
        Ok(())
    }

    /// The orientation of a tile, and its additional rotation about z.
    fn orientation(&self, group: usize, place: usize, up: &str, deg: f64) -> Result<(Orientation, f64), String> {
        let at = &self.film[place];
        let fitting = self.groups[group].orientations_at(at, true);
        let turn = |orientation: &Orientation| {
            let difference = (deg - orientation.mark_deg(at)).rem_euclid(360.0);
            if difference > 180.0 { difference - 360.0 } else { difference }
        };
        let nearest = fitting
            .iter()
            .filter(|orientation| orientation.upper_side_name() == up)
            .min_by(|a, b| turn(a).abs().total_cmp(&turn(b).abs()));
        match nearest {
            Some(orientation) if turn(orientation).abs() <= MOST_TURN_DEG => Ok((*orientation, turn(orientation))),
            _ => {
                let possible: Vec<String> = fitting
                    .iter()
                    .map(|orientation| format!("{} at {:.0}", orientation.upper_side_name(), orientation.mark_deg(at)))
                    .collect();
                Err(format!(
                    "with {} up and its mark at {deg} deg, its polarization does not fit the place; its orientation must be near: {} deg",
                    beginning(up),
                    possible.join(", ")
                ))
            }
        }
    }

    /// The remaining assignment.
    pub fn finish(self) -> PartlyPlaced {
        let mut groups = self.groups.to_vec();
        for (number, group) in groups.iter_mut().enumerate() {
            group.places.retain(|place| !self.filled.contains(place));
            let mut index = 0;
            group.tiles.retain(|_| {
                index += 1;
                !self.used.contains(&(number, index - 1))
            });
        }
        PartlyPlaced { film: self.film, groups, plan: self.plan }
    }
}
