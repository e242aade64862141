//! The effect of each tile at each place, and the search for the tile of each place.

use glam::{DQuat, DVec3};
use magsplice_magnet::{Tile, TileFaults};
use magsplice_tolerance::TileChanges;
use rayon::prelude::*;

use crate::assignment::{Assignment, AssignmentError, AssignmentSettings, CutTile, PlaceGroup, PlacedTile, ShortGroup};
use crate::local_search::{Contribution, LocalSearch};
use crate::orientation::Orientation;
use crate::shims::Shims;

/// Largest relative difference of sides and of polarizations of a tile that fits a place: the
/// digits of the parts of a layout.
const SAME: f64 = 1e-8;

/// Number of rounds that measure and add the error of the linear model. A hundredth of it remains
/// after the first, less than the round-off of measurements after the second.
const CORRECTIONS: usize = 2;

/// Starts that are added while too few agree.
const STARTS_OF_A_ROUND: usize = 16;

/// Largest number of starts that are added by themselves.
const MOST_STARTS: usize = 128;

/// Number of starts that end at the best assignment, or one as good, when no more are added. If one
/// start in a hundred found a better one, 8 rounds would find it with a probability of 72 %.
const AGREEING: usize = 4;

/// RMS displacement error of an assignment as good as the best, over the error of the best.
const AS_GOOD: f64 = 1.01;

/// Largest number of contributions of tiles at places in memory: 4 GB at 64 coordinates each.
const MOST_CONTRIBUTIONS: usize = 8_000_000;

/// Tiles and places, and their effects on the displacement errors.
#[derive(Clone, Debug)]
pub struct AssignmentProblem<'a> {
    model: &'a TileChanges,
    film: &'a [Tile],
    groups: &'a [PlaceGroup],
    shims: Shims,
    /// The orientations for each place of a group, in order.
    orientations: Vec<Vec<Vec<Orientation>>>,
    /// Contributions without the part that shim tiles can compensate.
    contributions: Vec<Vec<Vec<Contribution>>>,
}

impl<'a> AssignmentProblem<'a> {
    /// The assignment of tiles to a film with a model of its errors. `shims` are tiles of the film
    /// with adjustable strength. Other tiles in no group stay unchanged.
    ///
    /// # Errors
    /// See [`AssignmentError`].
    pub fn new(
        model: &'a TileChanges,
        film: &'a [Tile],
        groups: &'a [PlaceGroup],
        shims: &[usize],
        settings: &AssignmentSettings,
    ) -> Result<AssignmentProblem<'a>, AssignmentError> {
        let short = |(group, of): (usize, &PlaceGroup)| {
            let (places, tiles) = (of.places.len(), of.tiles.len());
            (tiles < places).then_some(ShortGroup { group, places, tiles })
        };
        let short: Vec<ShortGroup> = groups.iter().enumerate().filter_map(short).collect();
        if !short.is_empty() {
            return Err(AssignmentError::TooFew(short));
        }
        let mut orientations = Vec::new();
        let mut count = 0_usize;
        for group in groups {
            let of_places = group.orientations_in(film, settings.may_turn_over)?;
            count = of_places.iter().map(|of| of.len() * group.tiles.len()).sum::<usize>().saturating_add(count);
            orientations.push(of_places);
        }
        if count > MOST_CONTRIBUTIONS {
            return Err(AssignmentError::TooLarge { most: MOST_CONTRIBUTIONS });
        }
        let shims = Shims::new(model, film, shims)?;
        let contribution = |place: usize, tile: &CutTile, orientations: &[Orientation]| {
            let at = &film[place];
            let change = |orientation: &Orientation| {
                let j_t = orientation.apply(tile.polarization_t) - at.polarization_t();
                let mut change = model.change(place, j_t, orientation.sides(tile.size_mm) - at.size());
                shims.take_out(&mut change);
                change
            };
            Contribution { of_orientations: orientations.iter().map(change).collect() }
        };
        let contributions = groups
            .iter()
            .zip(&orientations)
            .map(|(group, of_places)| {
                let of_place = |(&place, orientations): (&usize, &Vec<Orientation>)| -> Vec<Contribution> {
                    group.tiles.iter().map(|tile| contribution(place, tile, orientations)).collect()
                };
                group.places.par_iter().zip(of_places).map(of_place).collect()
            })
            .collect();
        Ok(AssignmentProblem { model, film, groups, shims, orientations, contributions })
    }

    /// The best assignment found. Results do not depend on the number of threads. `progress` is
    /// called, from any thread, when a start begins. A panic of `progress` ends the work and
    /// reaches the caller.
    ///
    /// # Errors
    /// If a tile is invalid, or the parameters of a film are undefined.
    pub fn solve(
        &self,
        settings: &AssignmentSettings,
        progress: impl Fn() + Sync,
    ) -> Result<Assignment, AssignmentError> {
        let in_order = self.placed(&LocalSearch::in_order(&self.contributions));
        let in_order_rms_mm = self.rms_mm(&in_order, &self.shims.unchanged())?;
        let mut nominal = self.model.nominal().to_vec();
        self.shims.take_out(&mut nominal);
        let mut ends: Vec<LocalSearch> = Vec::new();
        loop {
            let first = ends.len();
            let last = settings.starts.map_or(first + STARTS_OF_A_ROUND, |starts| starts.max(1));
            ends.par_extend((first as u64..last as u64).into_par_iter().map(|start| {
                progress();
                LocalSearch::run(&nominal, &self.contributions, settings.seed, start, settings.kicks)
            }));
            if settings.starts.is_some() || ends.len() >= MOST_STARTS || self.do_agree(&ends, &nominal) {
                break;
            }
        }
        self.sort(&mut ends, &nominal);
        for _ in 0..CORRECTIONS {
            // The error of the linear model at the best assignment.
            let best = &ends[0];
            let mut exact = self.exact(&self.placed(best), &self.shims.unchanged())?;
            self.shims.take_out(&mut exact);
            let linear = best.sum(&nominal, &self.contributions);
            nominal
                .iter_mut()
                .zip(exact.iter().zip(&linear))
                .for_each(|(nominal, (exact, linear))| *nominal += exact - linear);
            ends.par_iter_mut().for_each(|end| end.improve(&nominal, &self.contributions));
            self.sort(&mut ends, &nominal);
        }
        let placed = self.placed(&ends[0]);
        let shim_factors = self.shims.factors(|factors| self.exact(&placed, factors))?;
        let rms_mm = self.rms_mm(&placed, &shim_factors)?;
        let starts_rms_mm = ends.iter().map(|end| self.linear_rms_mm(end, &nominal)).collect();
        Ok(Assignment { placed, shim_factors, rms_mm, in_order_rms_mm, starts_rms_mm })
    }

    /// The film with the placed tiles, and with the polarization of its shim tiles times these
    /// factors.
    ///
    /// # Errors
    /// If a tile is invalid.
    ///
    /// # Panics
    /// If the number of factors differs from the number of shim tiles.
    pub fn film(&self, placed: &[PlacedTile], shim_factors: &[f64]) -> Result<Vec<Tile>, AssignmentError> {
        let mut film = self.film.to_vec();
        for placed in placed {
            film[placed.place] = self.cut_tile(placed).at(&self.film[placed.place], placed.orientation)?;
        }
        self.shims.apply(&mut film, shim_factors)?;
        Ok(film)
    }

    /// Root mean square of the displacement errors over all points and axes, by the exact field, in
    /// mm.
    ///
    /// # Errors
    /// If a tile is invalid, or the parameters of a film are undefined.
    ///
    /// # Panics
    /// If the number of factors differs from the number of shim tiles.
    pub fn rms_mm(&self, placed: &[PlacedTile], shim_factors: &[f64]) -> Result<f64, AssignmentError> {
        self.model.exact_rms_mm(&self.film(placed, shim_factors)?).map_err(AssignmentError::Film)
    }

    pub(crate) fn model(&self) -> &TileChanges {
        self.model
    }

    pub(crate) fn cut_tile(&self, placed: &PlacedTile) -> &CutTile {
        &self.groups[placed.group].tiles[placed.tile]
    }

    pub(crate) fn exact(&self, placed: &[PlacedTile], shim_factors: &[f64]) -> Result<Vec<f64>, AssignmentError> {
        self.model.exact(&self.film(placed, shim_factors)?).map_err(AssignmentError::Film)
    }

    /// The rms of the displacement errors by the linear model.
    fn linear_rms_mm(&self, search: &LocalSearch, nominal: &[f64]) -> f64 {
        self.model.rms_mm(&search.sum(nominal, &self.contributions))
    }

    /// Whether enough searches ended at the best assignment or one as good.
    fn do_agree(&self, ends: &[LocalSearch], nominal: &[f64]) -> bool {
        let rms_mm: Vec<f64> = ends.iter().map(|end| self.linear_rms_mm(end, nominal)).collect();
        let best = rms_mm.iter().copied().fold(f64::INFINITY, f64::min);
        rms_mm.iter().filter(|rms| **rms <= AS_GOOD * best).count() >= AGREEING
    }

    fn sort(&self, ends: &mut [LocalSearch], nominal: &[f64]) {
        ends.sort_by(|a, b| self.linear_rms_mm(a, nominal).total_cmp(&self.linear_rms_mm(b, nominal)));
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

impl PlaceGroup {
    /// The orientations in which the part of the group equals the tile of a place, as measured
    /// first.
    pub fn orientations_at(&self, place: &Tile, may_turn_over: bool) -> Vec<Orientation> {
        let is_same = |a: DVec3, b: DVec3, scale: f64| (a - b).length() <= SAME * scale;
        let fits = |orientation: &Orientation| {
            let j_t = orientation.apply(self.polarization_t);
            is_same(orientation.sides(self.size_mm), place.size(), place.size().length())
                && is_same(j_t, place.polarization_t(), self.polarization_t.length())
                && (may_turn_over || orientation.keeps_upper_side())
        };
        Orientation::all().into_iter().filter(fits).collect()
    }

    /// [`PlaceGroup::orientations_at`] for each place of the group in a film.
    ///
    /// # Errors
    /// The first place that fits the part in no orientation.
    pub(crate) fn orientations_in(
        &self,
        film: &[Tile],
        may_turn_over: bool,
    ) -> Result<Vec<Vec<Orientation>>, AssignmentError> {
        let at_place =
            |&place: &usize| Some(self.orientations_at(&film[place], may_turn_over)).filter(|of| !of.is_empty());
        self.places
            .iter()
            .map(|place| at_place(place).ok_or(AssignmentError::NoOrientation { place: *place }))
            .collect()
    }
}

impl CutTile {
    /// The tile in the film, turned by `rotation` from upright.
    pub(crate) fn turned(
        &self,
        position: DVec3,
        rotation: DQuat,
        orientation: Orientation,
    ) -> Result<Tile, TileFaults> {
        Tile::new(position, orientation.sides(self.size_mm), orientation.apply(self.polarization_t))?.rotated(rotation)
    }

    /// The tile at a place of the film.
    ///
    /// # Errors
    /// If the tile is invalid.
    pub fn at(&self, place: &Tile, orientation: Orientation) -> Result<Tile, AssignmentError> {
        self.turned(place.position(), place.rotation(), orientation)
            .map_err(|faults| AssignmentError::Tile { name: self.name.clone(), faults })
    }
}
