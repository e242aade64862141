//! The errors of samples of a film.

use std::ops::Range;

use glam::{DMat3, DVec3};
use magsplice_decouple::Figures;
use magsplice_field::Scene;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Quantity, Tile};
use rayon::prelude::*;

use crate::draws::Draws;
use crate::evaluation_grid::{EvaluationGrid, SampleError};
use crate::images::FilmImages;
use crate::quantile::mean;
use crate::readings::Pose;
use crate::real_film::RealFilm;
use crate::statistics::Statistics;

/// Draws samples of a film and evaluates their errors over a working volume.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    film: &'a RealFilm,
    volume: EvaluationGrid,
    ideal: &'a IdealFilm,
    seed: u64,
    /// The points of the grid, then the reference point.
    points: Vec<DVec3>,
    /// One sensor, or those of a head.
    chips: Vec<Chip>,
    /// What they read of the ideal film at the points of the grid.
    ideal_t: Vec<DVec3>,
    /// The images of the film in iron at its mean distance.
    images: FilmImages,
}

/// A sensor of a head, and what does not differ between samples.
#[derive(Clone, Debug)]
struct Chip {
    place: DVec3,
    weight: DVec3,
    /// The field of the neighbour for each point.
    neighbour_t: Vec<DVec3>,
    /// The part of the film's field that the mean polarizations of its tiles do not represent, and
    /// its gradient, for each point; empty without recoil.
    remainder_t: Vec<(DVec3, DMat3)>,
}

impl<'a> Sampler<'a> {
    /// Prepares the parts that all samples share.
    ///
    /// # Errors
    /// If the neighbour or the ideal film has no field at a place of a sensor.
    pub fn new(
        film: &'a RealFilm,
        volume: &EvaluationGrid,
        ideal: &'a IdealFilm,
        seed: u64,
    ) -> Result<Sampler<'a>, SampleError> {
        let points: Vec<DVec3> = volume.grid.points().chain([volume.reference]).collect();
        let chip = |(place, weight): (DVec3, DVec3)| -> Result<Chip, SampleError> {
            let places: Vec<DVec3> = points.iter().map(|point| *point + place).collect();
            let neighbour_t = match &film.tolerance().common.neighbour {
                Some(neighbour) => exact_field_t(&Scene::new(&neighbour.tiles), &places)?,
                None => vec![DVec3::ZERO; places.len()],
            };
            let remainder_t = match film.weakening() {
                Some(weakening) => {
                    let scene = weakening.remainder();
                    let gradients = scene.gradient_at(Quantity::FluxDensity, &places).map_err(SampleError::Field)?;
                    exact_field_t(scene, &places)?.into_iter().zip(gradients).collect()
                }
                None => Vec::new(),
            };
            Ok(Chip { place, weight, neighbour_t, remainder_t })
        };
        let chips = film.chips().into_iter().map(chip).collect::<Result<_, _>>()?;
        let ideal_t = volume.ideal_field_t(ideal, &film.chips())?;
        let distance_error = film.tolerance().common.iron.as_ref().map(|iron| mean(&iron.distance_error_mm));
        let images = film.images(distance_error.unwrap_or(0.0));
        Ok(Sampler { film, volume: *volume, ideal, seed, points, chips, ideal_t, images })
    }

    /// The errors of sample number `sample`, which depend on the seed and on this number alone.
    ///
    /// # Errors
    /// If a tile of the sample cannot exist, or the parameters do not exist in the volume.
    pub fn errors_of(&self, sample: u64) -> Result<Figures, SampleError> {
        self.errors_of_readings(&self.readings_of_t(sample)?)
    }

    /// The errors of these tiles with the pose, the surroundings and the sensor of sample number
    /// `sample`.
    ///
    /// # Errors
    /// If the parameters do not exist in the volume.
    pub fn errors_of_tiles(&self, sample: u64, tiles: &[Tile]) -> Result<Figures, SampleError> {
        self.errors_of_readings(&self.readings_of_tiles_t(&mut Draws::new(self.seed, sample), tiles)?)
    }

    fn errors_of_readings(&self, read_t: &[DVec3]) -> Result<Figures, SampleError> {
        let last = read_t.len() - 1;
        self.volume.figures_against(&read_t[..last], read_t[last], self.ideal, &self.ideal_t)
    }

    /// The readings of sample number `sample` at the points of the grid, then at the reference
    /// point.
    pub(crate) fn readings_of_t(&self, sample: u64) -> Result<Vec<DVec3>, SampleError> {
        let mut draws = Draws::new(self.seed, sample);
        let tiles = self.film.draw_tiles(&mut draws).map_err(SampleError::Tile)?;
        self.readings_of_tiles_t(&mut draws, &tiles)
    }

    /// The readings at the points of the grid, then at the reference point: of a head, the weighted
    /// sum of those of its sensors, which count as read without their errors.
    fn readings_of_tiles_t(&self, draws: &mut Draws, tiles: &[Tile]) -> Result<Vec<DVec3>, SampleError> {
        let surroundings = self.film.draw_surroundings(draws);
        let in_place = self.film.in_film(tiles).map_err(SampleError::Tile)?;
        let scene = Scene::new(&in_place);
        let near_iron = self.film.tolerance().common.iron.is_some();
        let of_sample = near_iron.then(|| self.film.images(surroundings.iron_error_mm));
        let iron = self.film.iron_around(&surroundings);
        if let Some(depth_mm) = iron.depth_of(tiles) {
            return Err(SampleError::InIron { depth_mm });
        }
        let images = of_sample.as_ref().unwrap_or(&self.images);
        let noise = &self.film.tolerance().common.sensor.noise_t;
        let noisy = noise.iter().any(|noise| !noise.is_none());
        let last = self.points.len() - 1;
        let mut sums_t = vec![DVec3::ZERO; self.points.len()];
        for (number, (chip, errors)) in self.chips.iter().zip(&surroundings.chips).enumerate() {
            let place = |point: &DVec3| *point + chip.place;
            let places: Vec<DVec3> = self.points.iter().map(|point| place(point) + errors.shift_mm).collect();
            iron.check(&places).map_err(SampleError::Field)?;
            let mut read_t = vec![DVec3::ZERO; places.len()];
            // One after another, because two planes have hundreds.
            for (image, reflection) in images.reflections.iter().enumerate() {
                let in_film = images.in_film(reflection, &surroundings.pose, &places);
                let mut in_film_t = exact_field_t(&scene, &in_film)?;
                // The remainder has its images, is small, and moves by less than it varies.
                for (reading, (b_t, gradient)) in chip.remainder_t.iter().enumerate().filter(|_| image == 0) {
                    in_film_t[reading] += *b_t + *gradient * (in_film[reading] - place(&self.points[reading]));
                }
                images.add(image, &surroundings.pose, &in_film_t, self.points.len(), &mut read_t);
            }
            for (reading, (b_t, neighbour_t)) in read_t.iter_mut().zip(&chip.neighbour_t).enumerate() {
                *b_t = surroundings.reading_t(errors, *b_t, *neighbour_t, reading == last);
                if noisy {
                    *b_t += draws.noise_t(reading * self.chips.len() + number, noise);
                }
            }
            sums_t.iter_mut().zip(read_t).for_each(|(sum, b_t)| *sum += chip.weight * b_t);
        }
        Ok(sums_t)
    }

    /// The points of the grid, then the reference point.
    pub(crate) fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The place of the first sensor at each point, then that of each other one.
    pub(crate) fn places(&self) -> Vec<DVec3> {
        self.chips.iter().flat_map(|chip| self.points.iter().map(|point| *point + chip.place)).collect()
    }

    /// The images of the film in iron at its mean distance.
    pub(crate) fn images(&self) -> &FilmImages {
        &self.images
    }

    /// The places, then those at which the film has the field that its images have there.
    pub(crate) fn places_and_images(&self) -> Vec<DVec3> {
        let places = self.places();
        let of_image = |reflection| self.images.in_film(reflection, &Pose::NONE, &places);
        self.images.reflections.iter().flat_map(of_image).collect()
    }

    /// The field of the film without errors at [`Sampler::places_and_images`].
    pub(crate) fn film_t(&self) -> Result<Vec<DVec3>, SampleError> {
        let remainder_t = self.chips.iter().flat_map(|chip| &chip.remainder_t).map(|(b_t, _)| b_t);
        let in_film = self.film.in_film(self.film.tiles()).map_err(SampleError::Tile)?;
        with_remainder_t(&Scene::new(&in_film), &self.places_and_images(), remainder_t)
    }

    /// The field of the film and of its images at each place, from that of the film at
    /// [`Sampler::places_and_images`], or at the places alone without the images.
    pub(crate) fn with_images_t(&self, of_film_t: &[DVec3]) -> Vec<DVec3> {
        let mut sums_t = vec![DVec3::ZERO; self.chips.len() * self.points.len()];
        for (image, of_film_t) in of_film_t.chunks_exact(sums_t.len()).enumerate() {
            self.images.add(image, &Pose::NONE, of_film_t, self.points.len(), &mut sums_t);
        }
        sums_t
    }

    /// The field of the neighbour at each place.
    pub(crate) fn neighbour_t(&self) -> impl Iterator<Item = &DVec3> {
        self.chips.iter().flat_map(|chip| &chip.neighbour_t)
    }

    /// The weighted sum at each point of values at each place.
    pub(crate) fn sum_t(&self, at_places_t: &[DVec3]) -> Vec<DVec3> {
        let mut sums_t = vec![DVec3::ZERO; self.points.len()];
        for (chip, read_t) in self.chips.iter().zip(at_places_t.chunks_exact(self.points.len())) {
            sums_t.iter_mut().zip(read_t).for_each(|(sum, b_t)| *sum += chip.weight * *b_t);
        }
        sums_t
    }

    /// The film whose samples it draws.
    pub fn film(&self) -> &RealFilm {
        self.film
    }

    /// The seed of its samples.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The errors of samples with these numbers, computed in parallel. They do not depend on the
    /// number of threads or on how the samples are divided into ranges. `progress` is called, from
    /// any thread, when a sample begins.
    ///
    /// # Errors
    /// The first sample whose errors cannot be computed, by its number, and the reason.
    pub fn errors_of_range(
        &self,
        samples: Range<u64>,
        progress: impl Fn() + Sync,
    ) -> Result<Vec<Figures>, (u64, SampleError)> {
        let of_sample = |sample| {
            progress();
            self.errors_of(sample).map_err(|error| (sample, error))
        };
        let results: Vec<Result<Figures, _>> = samples.into_par_iter().map(of_sample).collect();
        results.into_iter().collect()
    }
}

/// Statistics of the figures of samples. `None` without samples.
pub fn statistics(samples: &[Figures]) -> Option<Figures<Statistics>> {
    Figures::from_fn(|figure| Statistics::new(samples.iter().filter_map(|sample| sample.get(figure).copied())))
}

/// The exact field of tiles in a film, with the remainder of its weakening at the first points.
pub(crate) fn with_remainder_t<'r>(
    scene: &Scene,
    points: &[DVec3],
    remainder_t: impl IntoIterator<Item = &'r DVec3>,
) -> Result<Vec<DVec3>, SampleError> {
    let mut film_t = exact_field_t(scene, points)?;
    film_t.iter_mut().zip(remainder_t).for_each(|(b_t, remainder_t)| *b_t += *remainder_t);
    Ok(film_t)
}

/// The exact field of tiles at points.
pub(crate) fn exact_field_t(scene: &Scene, points: &[DVec3]) -> Result<Vec<DVec3>, SampleError> {
    scene.field_at(Quantity::FluxDensity, points).map_err(SampleError::Field)
}
