//! The polarization of tiles that recoil weakens and turns.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{Tile, TileFaults};

/// How the tiles of a film with a recoil permeability weaken and turn, each at its place.
///
/// A placed tile is weakened and turned by the factor and the rotation of the ordered one. The
/// effect of its change on other tiles is neglected; relative to the change it is of the order of
/// the susceptibility.
#[derive(Clone, Debug)]
pub struct Weakening {
    /// For each place: J of the tile as ordered, and its mean in the film, in the frame of the
    /// tile.
    places: Vec<[DVec3; 2]>,
    /// The part of the field that the means leave out.
    remainder: Scene,
}

impl Weakening {
    /// The weakening of tiles with these mean polarizations in the film. `remainder` is the part of
    /// the field that the means leave out.
    ///
    /// # Panics
    /// If there are not as many means as tiles.
    pub fn new(ordered: &[Tile], means: &[Tile], remainder: Scene) -> Weakening {
        assert_eq!(ordered.len(), means.len(), "a mean for each tile");
        let places = ordered.iter().zip(means).map(|(tile, mean)| [tile.polarization_t(), mean.polarization_t()]);
        Weakening { places: places.collect(), remainder }
    }

    pub(crate) fn remainder(&self) -> &Scene {
        &self.remainder
    }

    pub(crate) fn place_count(&self) -> usize {
        self.places.len()
    }

    /// J in the film of a tile with the remanence `own_t`, both in its frame.
    fn in_film_t(&self, place: usize, own_t: DVec3) -> DVec3 {
        let [ordered_t, mean_t] = self.places[place];
        mean_t + self.change_t(place, own_t - ordered_t)
    }

    /// Change of J in the film of a tile whose remanence changes by `own_t`, both in its frame.
    pub(crate) fn change_t(&self, place: usize, own_t: DVec3) -> DVec3 {
        let [ordered_t, mean_t] = self.places[place];
        match (ordered_t.try_normalize(), mean_t.try_normalize()) {
            (Some(from), Some(to)) => {
                DQuat::from_rotation_arc(from, to) * own_t * (mean_t.length() / ordered_t.length())
            }
            // The others polarize a tile without remanence.
            _ => own_t,
        }
    }

    /// The tiles, one for each place, with the polarization that they have in the film.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist.
    pub(crate) fn in_film(&self, tiles: &[Tile]) -> Result<Vec<Tile>, TileFaults> {
        let of_place = |(place, tile): (usize, &Tile)| {
            let in_film_t = self.in_film_t(place, tile.polarization_t());
            Tile::new(tile.position(), tile.size(), in_film_t)?.rotated(tile.rotation())
        };
        tiles.iter().enumerate().map(of_place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(polarization_t: [f64; 3]) -> Tile {
        Tile::new(DVec3::ZERO, DVec3::ONE, polarization_t.into()).unwrap()
    }

    /// A tile as ordered has its mean polarization, a tile with errors the same factor and
    /// rotation, and a tile without remanence the polarization that the others cause.
    #[test]
    fn tiles_are_weakened_like_those_ordered() {
        let ordered = [cube([0.1, 0.0, 0.0]), cube([0.0; 3])];
        let means = [cube([0.06, 0.0, 0.06]), cube([0.0, 0.01, 0.0])];
        let weakening = Weakening::new(&ordered, &means, Scene::new(&[]));
        let in_film = weakening.in_film(&ordered).unwrap();
        for (found, mean) in in_film.iter().zip(&means) {
            assert!((found.polarization_t() - mean.polarization_t()).length() < 1e-16, "{found:?}");
        }
        let found_t = weakening.in_film_t(0, DVec3::new(0.0, 0.2, 0.1));
        let factor = 0.06 * 2.0_f64.sqrt() / 0.1;
        let known_t = factor * DVec3::new(-0.1 / 2.0_f64.sqrt(), 0.2, 0.1 / 2.0_f64.sqrt());
        assert!((found_t - known_t).length() < 1e-15, "{found_t} {known_t}");
        assert_eq!(weakening.in_film_t(1, DVec3::X), DVec3::new(1.0, 0.01, 0.0));
    }
}
