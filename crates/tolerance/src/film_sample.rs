//! One film as made, with its surroundings and its sensor.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::Distribution;
use magsplice_magnet::{HallSensor, Tile, TileFaults};

use crate::draws::Draws;
use crate::readings::Surroundings;
use crate::real_film::RealFilm;

/// A sample of a film as made, with the pose of the film, other fields and the errors of the
/// sensor. Lengths in millimetres.
///
/// Its errors are those of the sample of this number in [`Sampler`](crate::Sampler), after the
/// reading at the reference point: fields and changes of temperature that come later are present.
#[derive(Clone, Debug)]
pub struct FilmSample {
    tiles: Vec<Tile>,
    film: Vec<Scene>,
    neighbour: Option<Scene>,
    surroundings: Surroundings,
    noise_t: [Distribution; 3],
    draws: (u64, u64),
}

impl RealFilm {
    /// Sample number `sample`, with its surroundings.
    ///
    /// # Errors
    /// The faults of the first tile that cannot exist, such as one without thickness.
    pub fn sample(&self, seed: u64, sample: u64) -> Result<FilmSample, TileFaults> {
        let mut draws = Draws::new(seed, sample);
        let tiles = self.draw_tiles(&mut draws)?;
        let mut film = vec![Scene::new(&self.in_film(&tiles)?)];
        film.extend(self.weakening().map(|weakening| weakening.remainder().clone()));
        let common = &self.tolerance().common;
        Ok(FilmSample {
            tiles,
            film,
            neighbour: common.neighbour.as_ref().map(|neighbour| Scene::new(&neighbour.tiles)),
            surroundings: self.draw_surroundings(&mut draws),
            noise_t: common.sensor.noise_t.clone(),
            draws: (seed, sample),
        })
    }
}

impl FilmSample {
    /// The tiles as made, in the frame of the film, with their remanence.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// Parts of the film whose fields add up, in its frame. Indices of the first are those of the
    /// tiles.
    pub fn film(&self) -> &[Scene] {
        &self.film
    }

    /// The film beside it, in the frame of the film as ordered.
    pub fn neighbour(&self) -> Option<&Scene> {
        self.neighbour.as_ref()
    }

    /// The point of the film that is at a place.
    pub fn point_of_film(&self, place: DVec3) -> DVec3 {
        self.surroundings.pose.undo(place)
    }

    /// The rotation of the film.
    pub fn rotation(&self) -> DQuat {
        self.surroundings.pose.rotation()
    }

    /// The strength of all tiles over the strength at the reading at the reference point.
    pub fn strength(&self) -> f64 {
        self.surroundings.strength()
    }

    /// The uniform field from elsewhere.
    pub fn stray_field_t(&self) -> DVec3 {
        self.surroundings.stray_field_t()
    }

    /// A sensor with the errors of the sample: its offset and gain change, and it turns about its
    /// own axes.
    pub fn sensor(&self, ordered: &HallSensor) -> HallSensor {
        self.surroundings.sensor(ordered)
    }

    /// The noise of the first `readings` readings of a sensor. The noise of the film's tolerance
    /// replaces the noise of the sensor.
    pub fn noise_t(&self, readings: usize, sensor: &HallSensor) -> Vec<DVec3> {
        let is_stated = self.noise_t.iter().any(|noise| !noise.is_none());
        let noise_t = match is_stated {
            true => self.noise_t.clone(),
            false => sensor.noise_t.to_array().map(Distribution::normal),
        };
        let (seed, sample) = self.draws;
        let mut draws = Draws::new(seed, sample);
        (0..readings).map(|reading| draws.noise_t(reading, &noise_t)).collect()
    }
}
