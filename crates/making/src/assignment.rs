//! Tiles that were cut and measured, the places of a film, and what each tile does at each place.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Tile, TileFaults};
use magsplice_tolerance::{EvaluationGrid, SampleError, TileChanges};
use rayon::prelude::*;

use crate::local_search::{Contribution, LocalSearch};
use crate::orientation::Orientation;

/// Relative difference of sides and of polarizations up to which a tile fits a place: the digits of the
/// parts of a layout.
const SAME: f64 = 1e-8;

/// Rounds in which what the linear model leaves out is measured and added. The first leaves a hundredth of
/// it, the second less than the round-off of measurements.
const CORRECTIONS: usize = 2;

/// Most contributions of tiles at places that are held in memory: 4 GB at 64 coordinates each.
const MOST_CONTRIBUTIONS: usize = 8_000_000;

/// A tile that was cut and measured, in a frame of its own in which it is meant to be as its part.
#[derive(Clone, Debug, PartialEq)]
pub struct CutTile {
    /// Its name.
    pub name: String,
    /// Measured polarization.
    pub polarization_t: DVec3,
    /// Measured sides; those of the part if they were not measured.
    pub size_mm: DVec3,
}

/// Places that take the same part, and the tiles that were cut as this part.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceGroup {
    /// Sides of the part.
    pub size_mm: DVec3,
    /// Polarization of the part.
    pub polarization_t: DVec3,
    /// Indices of the places: tiles of the film.
    pub places: Vec<usize>,
    /// The tiles.
    pub tiles: Vec<CutTile>,
}

/// Where a tile goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PlacedTile {
    /// Index of the place.
    pub place: usize,
    /// Index of the group.
    pub group: usize,
    /// Index of the tile in its group.
    pub tile: usize,
    /// Which way round.
    pub orientation: Orientation,
}

/// The tile of each place.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Assignment {
    /// In the order of the places.
    pub placed: Vec<PlacedTile>,
    /// Root mean square of the displacement errors over all points and axes, by the exact field, in mm.
    pub rms_mm: f64,
    /// The same of the tiles in the order in which they were given, each as measured where it fits so.
    pub in_order_rms_mm: f64,
    /// The same, by the linear model, at which each start ended, least first. The least that many of them
    /// have in common is probably the best there is.
    pub starts_rms_mm: Vec<f64>,
}

/// How an assignment is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AssignmentSettings {
    /// Number of starts.
    pub starts: usize,
    /// Times that each start is disturbed and searched anew.
    pub kicks: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether tiles may be turned over.
    pub may_turn_over: bool,
}

impl Default for AssignmentSettings {
    fn default() -> AssignmentSettings {
        AssignmentSettings { starts: 16, kicks: 200, seed: 1, may_turn_over: true }
    }
}

/// Why tiles cannot be assigned.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum AssignmentError {
    /// A group has fewer tiles than places.
    TooFew {
        /// Index of the group.
        group: usize,
        /// Number of its places.
        places: usize,
        /// Number of its tiles.
        tiles: usize,
    },
    /// The part of a group fits one of its places in no orientation that is allowed.
    NoOrientation {
        /// Index of the place.
        place: usize,
    },
    /// A tile cannot exist.
    Tile {
        /// Its name.
        name: String,
        /// The rules that it breaks.
        faults: TileFaults,
    },
    /// The film has no displacement errors.
    Film(SampleError),
    /// There are too many tiles for too many places.
    TooLarge,
}

/// Tiles and places, and what each does to the displacement errors.
#[derive(Clone, Debug)]
pub struct AssignmentProblem<'a> {
    film: &'a [Tile],
    groups: &'a [PlaceGroup],
    model: TileChanges,
    /// For each place of a group, in order: its orientations.
    orientations: Vec<Vec<Vec<Orientation>>>,
    contributions: Vec<Vec<Vec<Contribution>>>,
}

impl<'a> AssignmentProblem<'a> {
    /// The problem of laying a film. Tiles of the film that are in no group stay as they are.
    ///
    /// # Errors
    /// See [`AssignmentError`].
    pub fn new(
        film: &'a [Tile],
        groups: &'a [PlaceGroup],
        volume: &EvaluationGrid,
        ideal: &IdealFilm,
        settings: &AssignmentSettings,
    ) -> Result<AssignmentProblem<'a>, AssignmentError> {
        let mut orientations = Vec::new();
        let mut count = 0_usize;
        for (index, group) in groups.iter().enumerate() {
            let (places, tiles) = (group.places.len(), group.tiles.len());
            if tiles < places {
                return Err(AssignmentError::TooFew { group: index, places, tiles });
            }
            let of_places = group
                .places
                .iter()
                .map(|&place| {
                    let found = fitting(group, &film[place], settings.may_turn_over);
                    if found.is_empty() { Err(AssignmentError::NoOrientation { place }) } else { Ok(found) }
                })
                .collect::<Result<Vec<_>, _>>()?;
            count = of_places.iter().map(|of| of.len() * tiles).sum::<usize>().saturating_add(count);
            orientations.push(of_places);
        }
        if count > MOST_CONTRIBUTIONS {
            return Err(AssignmentError::TooLarge);
        }
        let model = TileChanges::new(film, volume, ideal).map_err(AssignmentError::Film)?;
        let contributions = groups
            .iter()
            .zip(&orientations)
            .map(|(group, of_places)| {
                let of_place = |(&place, orientations): (&usize, &Vec<Orientation>)| -> Vec<Contribution> {
                    group
                        .tiles
                        .iter()
                        .map(|tile| contribution(&model, &film[place], place, tile, orientations))
                        .collect()
                };
                group.places.par_iter().zip(of_places).map(of_place).collect()
            })
            .collect();
        Ok(AssignmentProblem { film, groups, model, orientations, contributions })
    }

    /// The best assignment that was found. Results do not depend on the number of threads.
    ///
    /// # Errors
    /// Tiles that cannot exist, and films whose parameters do not exist.
    pub fn solve(&self, settings: &AssignmentSettings) -> Result<Assignment, AssignmentError> {
        let in_order = self.rms_mm(&self.placed(&LocalSearch::in_order(&self.contributions)))?;
        let mut nominal = self.model.nominal().to_vec();
        let mut ends = self.searched(&nominal, settings);
        for _ in 0..CORRECTIONS {
            // What the linear model leaves out at the best assignment.
            let best = &ends[0];
            let exact = self.exact(&self.placed(best))?;
            let linear = best.sum(&nominal, &self.contributions);
            nominal
                .iter_mut()
                .zip(exact.iter().zip(&linear))
                .for_each(|(nominal, (exact, linear))| *nominal += exact - linear);
            ends.par_iter_mut().for_each(|end| end.improve(&nominal, &self.contributions));
            self.sort(&mut ends, &nominal);
        }
        let placed = self.placed(&ends[0]);
        let rms_mm = self.rms_mm(&placed)?;
        let starts_rms_mm = ends.iter().map(|end| self.model.rms_mm(&end.sum(&nominal, &self.contributions))).collect();
        Ok(Assignment { placed, rms_mm, in_order_rms_mm: in_order, starts_rms_mm })
    }

    /// The film with its tiles placed.
    ///
    /// # Errors
    /// Tiles that cannot exist.
    pub fn film(&self, placed: &[PlacedTile]) -> Result<Vec<Tile>, AssignmentError> {
        let mut film = self.film.to_vec();
        for PlacedTile { place, group, tile, orientation } in placed {
            let tile = &self.groups[*group].tiles[*tile];
            let at = &self.film[*place];
            film[*place] =
                Tile::new(at.position(), orientation.sides(tile.size_mm), orientation.apply(tile.polarization_t))
                    .and_then(|new| new.rotated(at.rotation()))
                    .map_err(|faults| AssignmentError::Tile { name: tile.name.clone(), faults })?;
        }
        Ok(film)
    }

    /// Root mean square of the displacement errors over all points and axes, by the exact field, in mm.
    ///
    /// # Errors
    /// Tiles that cannot exist, and films whose parameters do not exist.
    pub fn rms_mm(&self, placed: &[PlacedTile]) -> Result<f64, AssignmentError> {
        Ok(self.model.rms_mm(&self.exact(placed)?))
    }

    fn exact(&self, placed: &[PlacedTile]) -> Result<Vec<f64>, AssignmentError> {
        self.model.exact(&self.film(placed)?).map_err(AssignmentError::Film)
    }

    /// Where the searches from all starts end, the best first.
    fn searched(&self, nominal: &[f64], settings: &AssignmentSettings) -> Vec<LocalSearch> {
        let mut ends: Vec<LocalSearch> = (0..settings.starts.max(1) as u64)
            .into_par_iter()
            .map(|start| LocalSearch::run(nominal, &self.contributions, settings.seed, start, settings.kicks))
            .collect();
        self.sort(&mut ends, nominal);
        ends
    }

    fn sort(&self, ends: &mut [LocalSearch], nominal: &[f64]) {
        ends.sort_by_cached_key(|end| OrderedRms(self.model.rms_mm(&end.sum(nominal, &self.contributions))));
    }

    fn placed(&self, search: &LocalSearch) -> Vec<PlacedTile> {
        let mut placed = Vec::new();
        for (group, of_group) in self.groups.iter().enumerate() {
            for (number, place) in of_group.places.iter().enumerate() {
                let (tile, orientation) = search.at(group, number);
                let orientation = self.orientations[group][number][orientation];
                placed.push(PlacedTile { place: *place, group, tile, orientation });
            }
        }
        placed.sort_by_key(|placed| placed.place);
        placed
    }
}

/// A number with a total order.
#[derive(PartialEq)]
struct OrderedRms(f64);

impl Eq for OrderedRms {}

impl PartialOrd for OrderedRms {
    fn partial_cmp(&self, other: &OrderedRms) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for OrderedRms {
    fn cmp(&self, other: &OrderedRms) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// The orientations in which the part of a group is the tile of a place.
fn fitting(group: &PlaceGroup, place: &Tile, may_turn_over: bool) -> Vec<Orientation> {
    let is_same = |a: DVec3, b: DVec3, scale: f64| (a - b).length() <= SAME * scale;
    let fits = |orientation: &Orientation| {
        is_same(orientation.sides(group.size_mm), place.size(), place.size().length())
            && is_same(orientation.apply(group.polarization_t), place.polarization_t(), group.polarization_t.length())
            && (may_turn_over || orientation.keeps_upper_side())
    };
    Orientation::all().into_iter().filter(fits).collect()
}

fn contribution(
    model: &TileChanges,
    at: &Tile,
    place: usize,
    tile: &CutTile,
    orientations: &[Orientation],
) -> Contribution {
    let change = |orientation: &Orientation| {
        let j_t = orientation.apply(tile.polarization_t) - at.polarization_t();
        model.change(place, j_t, orientation.sides(tile.size_mm) - at.size())
    };
    Contribution { of_orientations: orientations.iter().map(change).collect() }
}

impl fmt::Display for AssignmentError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            AssignmentError::TooFew { places, tiles, .. } => write!(f, "has {tiles} tiles for {places} places"),
            AssignmentError::NoOrientation { place } => {
                write!(f, "its part fits place number {} in no orientation that is allowed", place + 1)
            }
            AssignmentError::Tile { name, faults } => write!(f, "tile {name}: {faults}"),
            AssignmentError::Film(error) => error.fmt(f),
            AssignmentError::TooLarge => {
                write!(f, "there are more than {MOST_CONTRIBUTIONS} combinations of tiles and places")
            }
        }
    }
}

impl Error for AssignmentError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            AssignmentError::Film(error) => Some(error),
            _ => None,
        }
    }
}
