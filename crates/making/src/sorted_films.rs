//! Samples of films whose tiles are cut with spares, measured and sorted before placement.

use std::ops::Range;

use magsplice_decouple::Figures;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::Tile;
use magsplice_tolerance::{EvaluationGrid, SampleError, Sampler, TileChanges};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::assignment::{AssignmentError, AssignmentSettings, CutTile, PlaceGroup};
use crate::measurement::MeasurementErrors;
use crate::orientation::Orientation;
use crate::problem::AssignmentProblem;

/// Mask from the seed of a run to the seed of its measurements, which are then independent of its
/// tiles.
const SEED_OF_MEASUREMENTS: u64 = 0x6d65_6173_7572_6564;

/// Settings of cutting, measuring and sorting.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Sorting {
    /// Number of spare tiles, cut in addition to the tiles of the film. Parts have spares in
    /// proportion to their places.
    pub spares: usize,
    /// Errors of the measurements.
    pub measurement: MeasurementErrors,
    /// Settings of the search for the places of the tiles.
    pub settings: AssignmentSettings,
}

/// Draws samples of a film with sorted tiles. Sample number i has the tiles, the placement errors
/// and the surroundings of sample number i of the same film without sorting.
#[derive(Clone, Debug)]
pub struct SortedSampler<'a> {
    sampler: &'a Sampler<'a>,
    model: TileChanges,
    sorting: Sorting,
    /// Groups of places without tiles.
    parts: Vec<PlaceGroup>,
    /// The orientation in which the cut tile fits, for each part and place.
    in_order: Vec<Vec<Orientation>>,
    /// Number of spare tiles of each part.
    spares: Vec<usize>,
}

impl<'a> SortedSampler<'a> {
    /// Prepares the data shared by all samples. `parts` are groups of places without tiles: tiles
    /// of one group may be exchanged. Tiles in no group go to the places for which they are cut.
    ///
    /// # Errors
    /// If the displacement errors of the film cannot be computed, or a part does not fit its
    /// places.
    pub fn new(
        sampler: &'a Sampler<'a>,
        parts: Vec<PlaceGroup>,
        volume: &EvaluationGrid,
        ideal: &IdealFilm,
        sorting: Sorting,
    ) -> Result<SortedSampler<'a>, AssignmentError> {
        let tiles = sampler.film().tiles();
        let model = TileChanges::new(sampler.film(), volume, ideal).map_err(AssignmentError::Film)?;
        let first = |part: &PlaceGroup| -> Result<Vec<Orientation>, AssignmentError> {
            let all = part.orientations_in(tiles, sorting.settings.may_turn_over)?;
            Ok(all.iter().map(|of_place| of_place[0]).collect())
        };
        let in_order = parts.iter().map(first).collect::<Result<_, _>>()?;
        let places: Vec<usize> = parts.iter().map(|part| part.places.len()).collect();
        Ok(SortedSampler { sampler, model, sorting, in_order, spares: shared_out(sorting.spares, &places), parts })
    }

    /// The errors of sample number `sample`. They depend only on the seed of the sampler and on
    /// this number.
    ///
    /// # Errors
    /// If a tile of the sample is invalid, or the parameters are undefined in the volume.
    pub fn errors_of(&self, sample: u64) -> Result<Figures, AssignmentError> {
        let (film, seed) = (self.sampler.film(), self.sampler.seed());
        let faulty = |faults| AssignmentError::Film(SampleError::Tile(faults));
        let mut placed_tiles = film.cut_tiles(seed, sample).map_err(faulty)?;
        let cut = self.cut(&placed_tiles, sample).map_err(faulty)?;
        let mut random = ChaCha8Rng::seed_from_u64(seed ^ SEED_OF_MEASUREMENTS);
        random.set_stream(sample);
        let measured: Vec<PlaceGroup> = cut
            .iter()
            .map(|part| {
                let measured = |tile: &CutTile| self.sorting.measurement.measured(tile, part.size_mm, &mut random);
                PlaceGroup { tiles: part.tiles.iter().map(measured).collect(), ..part.clone() }
            })
            .collect();
        let settings = &self.sorting.settings;
        let problem = AssignmentProblem::new(&self.model, film.tiles(), &measured, &[], settings)?;
        let found = problem.solve(settings, || ())?;
        for placed in &found.placed {
            let tile = &cut[placed.group].tiles[placed.tile];
            placed_tiles[placed.place] = tile.at(&film.tiles()[placed.place], placed.orientation)?;
        }
        let placed_tiles = film.placed_tiles(&placed_tiles, seed, sample).map_err(faulty)?;
        self.sampler.errors_of_tiles(sample, &placed_tiles).map_err(AssignmentError::Film)
    }

    /// The errors of samples with these numbers, computed in parallel. They do not depend on the
    /// number of threads or on the division into ranges.
    ///
    /// # Errors
    /// The first sample whose errors cannot be computed, by its number, and the reason.
    pub fn errors_of_range(&self, samples: Range<u64>) -> Result<Vec<Figures>, (u64, AssignmentError)> {
        let of_sample = |sample| self.errors_of(sample).map_err(|error| (sample, error));
        let results: Vec<Result<Figures, _>> = samples.into_par_iter().map(of_sample).collect();
        results.into_iter().collect()
    }

    /// The tiles of each part in the frame of the part: tiles cut for the places, then spares.
    fn cut(&self, at_places: &[Tile], sample: u64) -> Result<Vec<PlaceGroup>, magsplice_magnet::TileFaults> {
        let (film, seed) = (self.sampler.film(), self.sampler.seed());
        let mut spare = 0;
        let mut groups = self.parts.clone();
        for ((group, orientations), spares) in groups.iter_mut().zip(&self.in_order).zip(&self.spares) {
            let own = |tile: &Tile, orientation: &Orientation| CutTile {
                name: String::new(),
                polarization_t: orientation.undo(tile.polarization_t()),
                size_mm: orientation.undo(tile.size()).abs(),
            };
            let of_places = group.places.iter().zip(orientations);
            group.tiles = of_places.clone().map(|(&place, orientation)| own(&at_places[place], orientation)).collect();
            for (&place, orientation) in of_places.cycle().take(*spares) {
                group.tiles.push(own(&film.spare_tile(place, spare, seed, sample)?, orientation));
                spare += 1;
            }
        }
        Ok(groups)
    }
}

/// Distributes spare tiles in proportion to numbers of places, by largest remainders.
fn shared_out(spares: usize, places: &[usize]) -> Vec<usize> {
    let all: usize = places.iter().sum();
    if all == 0 {
        return vec![0; places.len()];
    }
    let parts = |count: &usize| spares as u128 * *count as u128;
    let mut shares: Vec<usize> = places.iter().map(|count| (parts(count) / all as u128) as usize).collect();
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by_key(|part| std::cmp::Reverse(parts(&places[*part]) % all as u128));
    let left = spares - shares.iter().sum::<usize>();
    order.into_iter().take(left).for_each(|part| shares[part] += 1);
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spares_are_shared_out_in_proportion() {
        assert_eq!(shared_out(14, &[16, 24, 16]), [4, 6, 4]);
        assert_eq!(shared_out(1, &[16, 24, 16]), [0, 1, 0]);
        assert_eq!(shared_out(5, &[1, 1, 1]), [2, 2, 1]);
        // 2 2/9 and 1 7/9: the larger remainder is of the part with fewer places.
        assert_eq!(shared_out(4, &[5, 4]), [2, 2]);
        assert_eq!(shared_out(0, &[3]), [0]);
        assert_eq!(shared_out(3, &[]), Vec::<usize>::new());
    }
}
