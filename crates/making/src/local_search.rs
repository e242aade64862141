//! Local search: exchanges of two tiles, turns of one tile and spare tiles, while they improve the
//! film; then random exchanges, and a new search.

use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of exchanges of one disturbance: enough to leave a local minimum, and few enough to keep
/// most of it.
const EXCHANGES_OF_A_KICK: usize = 3;

/// Smallest relative fall of the square for which an exchange counts. It is far above round-off, so
/// a search ends.
const LEAST_GAIN: f64 = 1e-9;

/// Effect of a tile at a place in each orientation, in coordinates of the displacement errors.
#[derive(Clone, Debug)]
pub(crate) struct Contribution {
    pub(crate) of_orientations: Vec<Vec<f64>>,
}

/// Contributions by group, place and tile.
type Contributions = [Vec<Vec<Contribution>>];

/// A choice of tiles and orientations.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LocalSearch {
    /// The tile and the number of its orientation, for each group and place.
    chosen: Vec<Vec<(usize, usize)>>,
    /// Tiles without a place, for each group.
    spare: Vec<Vec<usize>>,
}

impl LocalSearch {
    /// Tiles in their given order.
    pub(crate) fn in_order(contributions: &Contributions) -> LocalSearch {
        let chosen = contributions.iter().map(|group| (0..group.len()).map(|tile| (tile, 0)).collect()).collect();
        let spare =
            contributions.iter().map(|group| (group.len()..group.first().map_or(0, Vec::len)).collect()).collect();
        LocalSearch { chosen, spare }
    }

    /// The end of the search from a random start.
    pub(crate) fn run(
        nominal: &[f64],
        contributions: &Contributions,
        seed: u64,
        start: u64,
        kicks: usize,
    ) -> LocalSearch {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(start);
        let mut best = LocalSearch::random(contributions, &mut random);
        best.improve(nominal, contributions);
        let mut least = square(&best.sum(nominal, contributions));
        for _ in 0..kicks {
            let mut next = best.clone();
            next.kick(contributions, &mut random);
            next.improve(nominal, contributions);
            let found = square(&next.sum(nominal, contributions));
            if found < least {
                (best, least) = (next, found);
            }
        }
        best
    }

    fn random(contributions: &Contributions, random: &mut ChaCha8Rng) -> LocalSearch {
        let (mut chosen, mut spare) = (Vec::new(), Vec::new());
        for group in contributions {
            let mut tiles: Vec<usize> = (0..group.first().map_or(0, Vec::len)).collect();
            tiles.shuffle(random);
            spare.push(tiles.split_off(group.len().min(tiles.len())));
            let turned = tiles
                .into_iter()
                .zip(group)
                .map(|(tile, place)| (tile, random.random_range(0..place[tile].of_orientations.len())));
            chosen.push(turned.collect());
        }
        LocalSearch { chosen, spare }
    }

    /// Exchanges random tiles.
    fn kick(&mut self, contributions: &Contributions, random: &mut ChaCha8Rng) {
        let of_group = |(group, chosen): (usize, &Vec<_>)| (0..chosen.len()).map(move |place| (group, place));
        let places: Vec<(usize, usize)> = self.chosen.iter().enumerate().flat_map(of_group).collect();
        if places.is_empty() {
            return; // All tiles are placed already.
        }
        for _ in 0..EXCHANGES_OF_A_KICK {
            let (group, number) = places[random.random_range(0..places.len())];
            let count = self.chosen[group].len();
            let other = random.random_range(0..count + self.spare[group].len());
            let orientation = |place: usize, tile: usize, random: &mut ChaCha8Rng| {
                random.random_range(0..contributions[group][place][tile].of_orientations.len())
            };
            let (own, _) = self.chosen[group][number];
            let taken = match other.checked_sub(count) {
                Some(spare) => std::mem::replace(&mut self.spare[group][spare], own),
                None => {
                    let (tile, _) = self.chosen[group][other];
                    self.chosen[group][other] = (own, orientation(other, own, random));
                    if other == number { own } else { tile }
                }
            };
            self.chosen[group][number] = (taken, orientation(number, taken, random));
        }
    }

    /// Exchanges tiles until no exchange improves the film.
    pub(crate) fn improve(&mut self, nominal: &[f64], contributions: &Contributions) {
        let mut sum = self.sum(nominal, contributions);
        let mut least = square(&sum);
        loop {
            let before = least;
            for (group, of_group) in contributions.iter().enumerate() {
                for place in 0..of_group.len() {
                    self.improve_place(group, place, of_group, &mut sum, &mut least);
                }
            }
            if least >= before * (1.0 - LEAST_GAIN) {
                return;
            }
            // Summed anew, without the round-off of many exchanges.
            sum = self.sum(nominal, contributions);
            least = square(&sum);
        }
    }

    /// The best change of the tile at a place: another orientation, or an exchange with a spare
    /// tile or a later place.
    fn improve_place(
        &mut self,
        group: usize,
        place: usize,
        of_group: &[Vec<Contribution>],
        sum: &mut Vec<f64>,
        least: &mut f64,
    ) {
        let (own, own_orientation) = self.chosen[group][place];
        let mut without = sum.clone();
        add(&mut without, -1.0, &of_group[place][own].of_orientations[own_orientation]);
        // The new place of the previous tile with its orientation there, the new tile, and its
        // orientation here.
        let mut best: Option<(Other, usize, usize)> = None;
        let mut lowest = *least * (1.0 - LEAST_GAIN);
        let here = |tile: usize| of_group[place][tile].of_orientations.iter().enumerate();
        let alone = std::iter::once((Other::None, own));
        let spares = self.spare[group].iter().enumerate().map(|(index, tile)| (Other::Spare(index), *tile));
        for (other, tile) in alone.chain(spares) {
            for (orientation, contribution) in here(tile) {
                let found = square_of_sum(&without, contribution);
                if found < lowest {
                    (lowest, best) = (found, Some((other, tile, orientation)));
                }
            }
        }
        let mut both = without.clone();
        for (there, of_there) in of_group.iter().enumerate().skip(place + 1) {
            let (tile, orientation_there) = self.chosen[group][there];
            both.copy_from_slice(&without);
            add(&mut both, -1.0, &of_there[tile].of_orientations[orientation_there]);
            let mut exchanged = vec![0.0; both.len()];
            for (new_there, contribution_there) in of_there[own].of_orientations.iter().enumerate() {
                exchanged.copy_from_slice(&both);
                add(&mut exchanged, 1.0, contribution_there);
                for (orientation, contribution) in here(tile) {
                    let found = square_of_sum(&exchanged, contribution);
                    if found < lowest {
                        (lowest, best) = (found, Some((Other::Place(there, new_there), tile, orientation)));
                    }
                }
            }
        }
        let Some((other, tile, orientation)) = best else { return };
        *sum = without;
        add(sum, 1.0, &of_group[place][tile].of_orientations[orientation]);
        self.chosen[group][place] = (tile, orientation);
        match other {
            Other::None => {}
            Other::Spare(index) => self.spare[group][index] = own,
            Other::Place(there, new_there) => {
                let (_, before) = self.chosen[group][there];
                add(sum, -1.0, &of_group[there][tile].of_orientations[before]);
                add(sum, 1.0, &of_group[there][own].of_orientations[new_there]);
                self.chosen[group][there] = (own, new_there);
            }
        }
        *least = lowest;
    }

    /// The displacement errors of the choice. `nominal` are the errors of the film as ordered.
    pub(crate) fn sum(&self, nominal: &[f64], contributions: &Contributions) -> Vec<f64> {
        let mut sum = nominal.to_vec();
        for (chosen, of_group) in self.chosen.iter().zip(contributions) {
            for ((tile, orientation), of_place) in chosen.iter().zip(of_group) {
                add(&mut sum, 1.0, &of_place[*tile].of_orientations[*orientation]);
            }
        }
        sum
    }

    /// The tile at a place and the number of its orientation.
    pub(crate) fn at(&self, group: usize, place: usize) -> (usize, usize) {
        self.chosen[group][place]
    }
}

/// The new place of a replaced tile.
#[derive(Clone, Copy)]
enum Other {
    /// The tile stays.
    None,
    /// Among the spare tiles, with this index.
    Spare(usize),
    /// This place, in this orientation.
    Place(usize, usize),
}

fn add(sum: &mut [f64], factor: f64, other: &[f64]) {
    sum.iter_mut().zip(other).for_each(|(sum, other)| *sum += factor * other);
}

fn square(of: &[f64]) -> f64 {
    of.iter().map(|value| value * value).sum()
}

fn square_of_sum(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a + b) * (a + b)).sum()
}
