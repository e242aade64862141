//! One film as made, with its surroundings and its sensor.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::Distribution;
use magsplice_magnet::{HallSensor, IronPlane, PointErrors, Tile, TileFaults};

use crate::draws::Draws;
use crate::images::IronAround;
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
    beside: Option<Scene>,
    iron: IronAround,
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
        let in_film = self.in_film(&tiles)?;
        let mut film = vec![Scene::new(&in_film)];
        film.extend(self.weakening().map(|weakening| weakening.remainder().clone()));
        let surroundings = self.draw_surroundings(&mut draws);
        let iron = self.iron_around(&surroundings);
        if !iron.own.is_empty() {
            film.push(Scene::new(&iron.own.reflected(&in_film)?));
        }
        let pose = surroundings.pose;
        let image = |(plane, tile): (&IronPlane, &Tile)| {
            let strength_t = surroundings.strength() * tile.polarization_t();
            let posed = Tile::new(pose.apply(tile.position()), tile.size(), strength_t)?;
            plane.image(&posed.rotated((pose.rotation() * tile.rotation()).normalize())?)
        };
        let of_near: Vec<Tile> = iron
            .near
            .iter()
            .flat_map(|plane| tiles.iter().map(move |tile| (plane, tile)))
            .map(image)
            .collect::<Result<_, _>>()?;
        let common = &self.tolerance().common;
        let beside = common.neighbour.as_ref().map(|neighbour| &neighbour.tiles).or(iron.near.map(|_| &of_near));
        Ok(FilmSample {
            film,
            beside: beside.map(|tiles| Scene::new(tiles)),
            iron,
            surroundings,
            noise_t: common.sensor.noise_t.clone(),
            draws: (seed, sample),
            tiles,
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

    /// The neighbour, or the images of the film in iron near it, in the frame of the film as
    /// ordered.
    pub fn beside(&self) -> Option<&Scene> {
        self.beside.as_ref()
    }

    /// The point at which the sensor reads [`FilmSample::beside`] at a place. Errors of its place
    /// do not change what it reads of a neighbour.
    pub fn point_beside(&self, place: DVec3) -> DVec3 {
        place + if self.iron.near.is_some() { self.surroundings.chips[0].shift_mm } else { DVec3::ZERO }
    }

    /// Checks places of the sensor.
    ///
    /// # Errors
    /// Those that are in iron.
    pub fn check_before_iron(&self, places: &[DVec3]) -> Result<(), PointErrors> {
        let shifted: Vec<DVec3> = places.iter().map(|place| *place + self.surroundings.chips[0].shift_mm).collect();
        self.iron.check(&shifted)
    }

    /// The point of the film that the sensor reads at a place.
    pub fn point_of_film(&self, place: DVec3) -> DVec3 {
        self.surroundings.pose.undo(place + self.surroundings.chips[0].shift_mm)
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

#[cfg(test)]
mod tests {
    use magsplice_field::Scene;
    use magsplice_head::{HeadElement, SensorHead};
    use magsplice_ideal::IdealFilm;
    use magsplice_layout::{
        CommonErrors, FilmPose, FilmTolerance, NearIron, Neighbour, SensorErrors, StrayField, Temperature, TileErrors,
    };
    use magsplice_magnet::{Grid, IronPlane, IronPlanes, Quantity};

    use super::*;
    use crate::evaluation_grid::EvaluationGrid;
    use crate::sampler::Sampler;
    use crate::weakening::Weakening;

    fn tile(position: [f64; 3], j_t: [f64; 3]) -> Tile {
        Tile::new(position.into(), DVec3::new(3.0, 2.0, 1.0), j_t.into()).expect("a tile")
    }

    fn field_t(scenes: &[Scene], place: DVec3) -> DVec3 {
        scenes.iter().map(|scene| scene.field(Quantity::FluxDensity, place).expect("outside")).sum()
    }

    fn tolerance(position_mm: f64) -> FilmTolerance {
        let normal = Distribution::normal;
        let three = |deviation: f64| [normal(deviation), normal(deviation), normal(2.0 * deviation)];
        let errors = TileErrors { position: three(0.05), strength: normal(0.05), ..TileErrors::default() };
        let neighbour = Neighbour {
            tiles: vec![tile([15.0, 0.0, 0.5], [0.0, 0.0, 0.3])],
            layout: "beside.toml".to_owned(),
            position_mm: [15.0, 0.0, 0.0],
            rotation: None,
            later: true,
        };
        FilmTolerance {
            common: CommonErrors {
                film: FilmPose { position_mm: three(position_mm), rotation_rad: three(0.1 * position_mm) },
                stray_field: Some(StrayField { field_t: three(1e-4), later: true, ..StrayField::default() }),
                neighbour: Some(neighbour),
                iron: None,
                temperature: Some(Temperature { change_k: normal(20.0), strength_per_k: -0.001 }),
                sensor: SensorErrors {
                    position_mm: three(0.3 * position_mm),
                    offset_t: three(1e-4),
                    rotation_rad: three(0.05),
                    gain: three(0.05),
                    noise_t: three(1e-4),
                },
            },
            ..FilmTolerance::of_tiles(&errors, 2)
        }
    }

    /// A head reads the weighted sum of what its sensors read alone, each with errors of its own.
    #[test]
    fn heads_read_sums_of_sensors_with_their_own_errors() {
        let tiles = [tile([-2.0, 0.3, 0.5], [-0.3, 0.1, 0.0]), tile([2.0, 0.0, 0.5], [0.3, 0.0, 0.1])];
        let ideal = IdealFilm::new(10.0, 1.0, 0.12).expect("a film");
        let (places, weights) = ([DVec3::ZERO, DVec3::new(0.3, 0.0, -1.0)], [DVec3::splat(2.0), DVec3::splat(-1.5)]);
        let element = |(place, weight): (&DVec3, &DVec3)| HeadElement {
            sensor: HallSensor::default(),
            place: *place,
            weight: *weight,
        };
        let head = SensorHead { elements: places.iter().zip(&weights).map(element).collect() };
        let volume = |place: DVec3| {
            let (lower, upper) = (DVec3::new(-1.0, -1.0, -5.0), DVec3::new(1.0, 1.0, -3.0));
            let grid = Grid::new(lower + place, upper + place, [2, 2, 2]).expect("a grid");
            EvaluationGrid { grid, reference: DVec3::new(0.0, 0.1, -4.0) + place }
        };
        let mut quiet = tolerance(0.1);
        quiet.common.sensor = SensorErrors::default();
        for (tolerance, is_quiet) in [(quiet, true), (tolerance(0.1), false)] {
            let film = RealFilm::new(&tiles, &tolerance);
            let of_head = film.clone().with_head(Some(head.clone()));
            let read = |film: &RealFilm, place: DVec3| -> Vec<DVec3> {
                let sampler = Sampler::new(film, &volume(place), &ideal, 7).expect("a sampler");
                sampler.readings_of_t(3).expect("readings")
            };
            let [first, second] = places.map(|place| read(&film, place));
            let sums_t = read(&of_head, DVec3::ZERO);
            for ((sum_t, first), second) in sums_t.iter().zip(first).zip(second) {
                let alike_t = weights[0] * first + weights[1] * second;
                assert_eq!(sum_t.distance(alike_t) < 1e-15, is_quiet, "{sum_t} {alike_t}");
                // Offsets of 1e-4 T, and gains and turns of 0.05 of a field of 0.01 T.
                assert!(sum_t.distance(alike_t) < 0.02, "{sum_t} {alike_t}");
            }
        }
    }

    /// The parts of a sample give the readings of the sampler, with recoil too: there, the field
    /// that the means leave out is taken to first order, so that it is exact for a film in its
    /// place, and within the square of 0.1 mm over 10 mm for a film that has moved.
    #[test]
    fn parts_of_a_sample_give_its_readings() {
        let tiles = [tile([-2.0, 0.3, 0.5], [-0.3, 0.1, 0.0]), tile([2.0, 0.0, 0.5], [0.3, 0.0, 0.1])];
        let means = [tile([-2.0, 0.3, 0.5], [-0.27, 0.1, 0.01]), tile([2.0, 0.0, 0.5], [0.28, 0.01, 0.1])];
        let remainder = || Scene::new(&[tile([0.0, 0.0, 7.0], [0.3, 0.4, 0.5])]);
        let lower = DVec3::new(-1.0, -1.0, -5.0);
        let grid = Grid::new(lower, DVec3::new(1.0, 1.0, -3.0), [2, 2, 2]).expect("a grid");
        let volume = EvaluationGrid { grid, reference: DVec3::new(0.0, 0.1, -4.0) };
        let ideal = IdealFilm::new(10.0, 1.0, 0.12).expect("a film");
        let largest_remainder_t = field_t(&[remainder()], DVec3::new(0.0, 0.0, -3.0)).length();
        let near = NearIron {
            normal: DVec3::new(0.1, 0.2, -1.0).normalize(),
            distance_mm: 1.0,
            distance_error_mm: Distribution::Uniform { half_width: 0.5 },
            relative_permeability: 9.0,
            later: true,
        };
        let plate = |z: f64, up: f64| IronPlane::new(z * DVec3::Z, up * DVec3::Z, 4.0).expect("a plane");
        let plates = IronPlanes::new(vec![plate(1.0, -1.0), plate(-8.0, 1.0)]).expect("planes");
        let far = IronPlanes::new(vec![plate(8.0, -1.0), plate(-8.0, 1.0)]).expect("planes");
        let with_recoil_t = 10.0 * 0.03_f64.powi(2) * largest_remainder_t;
        for (position_mm, kind, allowed_t) in [
            (0.1, "rigid", 1e-15),
            (0.0, "recoil", 1e-15),
            (0.1, "recoil", with_recoil_t),
            (0.1, "near", 1e-14),
            (0.1, "plates", 1e-14),
            (0.0, "recoil with plates", 1e-14),
        ] {
            let mut tolerance = tolerance(position_mm);
            if kind == "near" {
                tolerance.common.neighbour = None;
                tolerance.common.iron = Some(near.clone());
            }
            let film = RealFilm::new(&tiles, &tolerance);
            let film = match kind {
                "recoil" => film.with_weakening(Weakening::new(&tiles, &means, remainder())),
                "plates" => film.with_iron(plates.clone()),
                "recoil with plates" => {
                    let remainder = remainder().with_planes(&far).expect("tiles before the planes");
                    film.with_iron(far.clone()).with_weakening(Weakening::new(&tiles, &means, remainder))
                }
                _ => film,
            };
            let sampler = Sampler::new(&film, &volume, &ideal, 7).expect("a sampler");
            for number in 0..3 {
                let sample = film.sample(7, number).expect("tiles");
                assert_eq!(sample.tiles(), film.sample_tiles(7, number).expect("tiles"));
                let parts = if kind.contains(' ') { 3 } else { 1 + usize::from(["recoil", "plates"].contains(&kind)) };
                assert_eq!(sample.film().len(), parts);
                let read_t = sampler.readings_of_t(number).expect("readings");
                let sensor = sample.sensor(&HallSensor::default());
                let noise_t = sample.noise_t(read_t.len(), &HallSensor::default());
                let beside = sample.beside().expect("a neighbour");
                let last = read_t.len() - 1;
                for (reading, (place, read_t)) in sampler.points().iter().zip(&read_t).enumerate() {
                    let mut b_t = sample.rotation() * field_t(sample.film(), sample.point_of_film(*place));
                    // The first reading, at the reference point, lacks later contributions.
                    if reading != last {
                        b_t = b_t * sample.strength()
                            + sample.stray_field_t()
                            + beside.field(Quantity::FluxDensity, sample.point_beside(*place)).expect("outside");
                    }
                    let known_t = sensor.gain * (sensor.rotation.inverse() * b_t) + sensor.offset_t + noise_t[reading];
                    assert!(known_t.distance(*read_t) < allowed_t, "{kind}: {read_t}, not {known_t}");
                }
            }
        }
        // With recoil, errors beyond the allowed one without the gradient of the remainder.
        let gradient = remainder().gradient(Quantity::FluxDensity, DVec3::new(0.0, 0.0, -3.0)).expect("outside");
        assert!((gradient * DVec3::splat(0.1)).length() > 10.0 * 0.03_f64.powi(2) * largest_remainder_t);
    }

    /// The errors add to those of the sensor as ordered: offsets add, gains multiply, and it turns
    /// about its own axes. Without noise in the tolerance, its own noise counts.
    #[test]
    fn sensor_has_its_own_properties_and_the_errors() {
        let tolerance = tolerance(0.1);
        let sample = RealFilm::new(&[tile([0.0; 3], [0.1; 3]); 2], &tolerance).sample(7, 3).expect("tiles");
        let ordered = HallSensor {
            rotation: DQuat::from_rotation_x(0.7),
            gain: DVec3::new(2.0, 3.0, 4.0),
            offset_t: DVec3::new(1e-3, 2e-3, 3e-3),
            noise_t: DVec3::new(1e-5, 2e-5, 3e-5),
            count_t: DVec3::splat(1e-6),
            ..HallSensor::default()
        };
        let (errors, found) = (sample.sensor(&HallSensor::default()), sample.sensor(&ordered));
        assert!(found.gain.distance(ordered.gain * errors.gain) < 1e-15);
        assert!(found.offset_t.distance(ordered.offset_t + errors.offset_t) < 1e-18);
        assert!(found.rotation.dot(ordered.rotation * errors.rotation).abs() > 1.0 - 1e-15);
        assert_eq!((found.count_t, found.noise_t), (ordered.count_t, ordered.noise_t));
        let stated = sample.noise_t(3, &ordered);
        assert!(stated == sample.noise_t(3, &HallSensor::default()) && stated[0].x.abs() > 2e-5, "{stated:?}");
        let mut quiet = tolerance;
        quiet.common.sensor.noise_t = Default::default();
        let quiet = RealFilm::new(&[tile([0.0; 3], [0.1; 3]); 2], &quiet).sample(7, 3).expect("tiles");
        // The deviates are the same.
        for (own, stated) in quiet.noise_t(3, &ordered).iter().zip(&stated) {
            let known = *stated * ordered.noise_t / DVec3::new(1e-4, 1e-4, 2e-4);
            assert!(own.distance(known) < 1e-18, "{own}, not {known}");
        }
        assert_eq!(quiet.noise_t(2, &HallSensor::default()), [DVec3::ZERO; 2]);
    }

    /// Figures of a sample are the figures of its readings, in a range and for given tiles too.
    #[test]
    fn errors_of_samples_are_the_figures_of_their_readings() {
        let tiles = [tile([-2.0, 0.3, 0.5], [-0.3, 0.1, 0.0]), tile([2.0, 0.0, 0.5], [0.3, 0.0, 0.1])];
        let grid = Grid::new(DVec3::new(-1.0, -1.0, -5.0), DVec3::new(1.0, 1.0, -3.0), [2, 3, 2]).expect("a grid");
        let volume = EvaluationGrid { grid, reference: DVec3::new(0.0, 0.1, -4.0) };
        let ideal = IdealFilm::new(10.0, 1.0, 0.12).expect("a film");
        let film = RealFilm::new(&tiles, &tolerance(0.1));
        let sampler = Sampler::new(&film, &volume, &ideal, 5).expect("a sampler");
        assert_eq!((sampler.seed(), sampler.film().tiles()), (5, &tiles[..]));
        let of = |sample: u64| {
            let read_t = sampler.readings_of_t(sample).expect("readings");
            let (at_reference_t, field_t) = read_t.split_last().expect("readings");
            volume.figures(field_t, *at_reference_t, &ideal).expect("figures")
        };
        assert_eq!(sampler.errors_of(3), Ok(of(3)));
        assert_ne!(of(3), of(4));
        assert_eq!(sampler.errors_of_tiles(3, &film.sample_tiles(5, 3).expect("tiles")), Ok(of(3)));
        let begun = std::sync::atomic::AtomicUsize::new(0);
        let count = || _ = begun.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let found = sampler.errors_of_range(3..6, count).expect("samples");
        assert_eq!((found.as_slice(), begun.into_inner()), (&[of(3), of(4), of(5)][..], 3));
        let of_all = crate::sampler::statistics(&found).expect("samples");
        assert_eq!(of_all.amplitude.count, 3);
        assert!((of_all.amplitude.mean.value - (3..6).map(|n| of(n).amplitude).sum::<f64>() / 3.0).abs() < 1e-15);
        assert_eq!(crate::sampler::statistics(&[]), None);
    }
}
