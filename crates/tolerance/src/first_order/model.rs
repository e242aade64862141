//! The model: residuals and sensitivities.

use glam::DVec3;
use magsplice_ideal::IdealFilm;
use magsplice_layout::CommonErrors;
use magsplice_magnet::{Axis, PerTileError, Reflection, TileError};

use super::displacement::{Displacement, OMITTED, displacement_errors_mm};
use super::sources::{Cause, ErrorSource, Moments, SensorError, noise_moments, sources};
use super::tile_response::TileResponse;
use crate::evaluation_grid::{EvaluationGrid, SampleError};
use crate::low_rank::{LowRank, add};
use crate::real_film::RealFilm;
use crate::sampler::Sampler;

/// Most bytes of sensitivities. A film of 800 tiles with all errors has 93 MB at 405 points.
const LARGEST_BYTES: usize = 1 << 31;

/// Bytes of the derivatives of the field of one tile at a place, and of the pose of the film.
const BYTES_PER_PLACE: usize = 512;

/// One error of a film to first order.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ErrorTerm {
    /// The error.
    pub source: ErrorSource,
    /// Its mean, in its unit.
    pub mean: f64,
    /// Its standard deviation, in its unit.
    pub deviation: f64,
}

/// The displacement errors of a film as linear functions of all its errors (docs/physics.md, Eq.
/// P55).
///
/// The derivatives are exact, at the film without errors beside its neighbour and iron at its mean
/// distance. Their fields are not linearized.
///
/// # Units
/// Displacements in millimetres, flux densities in tesla, angles in radians.
///
/// # Cost
/// A film of 56 tiles at 405 points takes about 0.2 s on one core. Each error with a distribution
/// needs 24 bytes per point, twice while the model is made.
///
/// # Accuracy
/// Second derivatives are left out: for errors of size s the displacement errors are wrong by the
/// order of s^2 over the square of the distance of the sensor. [`FirstOrder::check`] measures it.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_ideal::IdealFilm;
/// use magsplice_layout::{FilmTolerance, Preset};
/// use magsplice_magnet::{Grid, Tile};
/// use magsplice_tolerance::{EvaluationGrid, FirstOrder, RealFilm};
///
/// let tile = |x: f64| Tile::new(DVec3::new(x, 0.0, 0.5), DVec3::new(4.0, 9.0, 1.0), DVec3::new(0.1 * x.signum(), 0.0, 0.0));
/// let tiles = [tile(-2.5)?, tile(2.5)?];
/// let film = RealFilm::new(&tiles, &FilmTolerance::of_tiles(&Preset::Workshop.errors(), 2));
/// let grid = Grid::new(DVec3::new(-1.0, -1.0, -5.0), DVec3::new(1.0, 1.0, -3.0), [5, 5, 3])?;
/// let volume = EvaluationGrid { grid, reference: DVec3::new(0.0, 0.0, -5.0) };
/// let model = FirstOrder::new(&film, &volume, &IdealFilm::new(10.0, 1.0, 0.12)?)?;
/// let along_x = model.axis_errors(0);
/// let parts: f64 = along_x.shares.iter().map(|share| share.contribution.total_mm2()).sum();
/// assert!((along_x.nominal_mm2 + parts - along_x.expected_mm2).abs() < 1e-12 * along_x.expected_mm2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FirstOrder {
    pub(super) film: RealFilm,
    pub(super) ideal: IdealFilm,
    pub(super) points: usize,
    /// Displacement errors without errors, neighbour and iron near the film: x at all points, then
    /// y, then z.
    pub(super) nominal_mm: Vec<f64>,
    /// Their change by a neighbour, or by iron.
    pub(super) by_surroundings_mm: Option<(Cause, Vec<f64>)>,
    /// Their expectation.
    pub(super) mean_mm: Vec<f64>,
    pub(super) terms: Vec<ErrorTerm>,
    /// Derivatives of the displacement errors by the terms that have errors.
    pub(super) sensitivities: Vec<Sensitivity>,
    /// The sensitivities to terms that vary, times their deviations.
    pub(super) varying: LowRank,
    /// Variance of the displacement errors by noise of the reading at each point itself.
    pub(super) noise_mm2: Vec<f64>,
    /// Their change by the mean of this noise.
    pub(super) noise_shift_mm: Vec<f64>,
    pub(super) noise_mean_t: DVec3,
    pub(super) displacement: Displacement,
}

/// The derivatives of all displacement errors by one term.
#[derive(Clone, Debug)]
pub(super) struct Sensitivity {
    pub(super) term: usize,
    pub(super) column: Vec<f64>,
}

impl FirstOrder {
    /// The model of a film in a working volume.
    ///
    /// # Errors
    /// If the parameters or the derivatives do not exist at a point of the volume, or the
    /// derivatives need too much memory.
    pub fn new(film: &RealFilm, volume: &EvaluationGrid, ideal: &IdealFilm) -> Result<FirstOrder, SampleError> {
        let sampler = Sampler::new(film, volume, ideal, 0)?;
        let points = sampler.points();
        let last = points.len() - 1;
        let sources = sources(film);
        let active = sources.iter().filter(|(_, moments)| *moments != Moments::default()).count();
        let columns = active.checked_mul(2 * 3 * size_of::<f64>()).and_then(|bytes| bytes.checked_mul(last));
        let images = sampler.places().len().checked_mul(sampler.images().reflections.len() * BYTES_PER_PLACE);
        let bytes = columns.zip(images).map(|(columns, images)| columns.max(images));
        if bytes.is_none_or(|bytes| bytes > LARGEST_BYTES) {
            return Err(SampleError::TooLarge { bytes });
        }
        if let Some(point) = points[..last].iter().find(|point| ideal.flux_density_t(**point).is_none()) {
            return Err(SampleError::NotBelow { point: *point });
        }
        let film_t = sampler.film_t()?;
        let CommonErrors { neighbour, iron, .. } = &film.tolerance().common;
        let own_t = match iron {
            Some(_) => sampler.with_images_t(&film_t[..sampler.places().len()]),
            None => sampler.with_images_t(&film_t),
        };
        let nominal_mm = displacement_errors_mm(points, &sampler.sum_t(&own_t), ideal)?;
        let is_later = neighbour.as_ref().is_some_and(|neighbour| neighbour.later);
        let with_neighbour = |(place, (film, other)): (usize, (DVec3, &DVec3))| {
            let is_first = place % points.len() == last;
            if is_first && is_later { film } else { film + *other }
        };
        let film_and_images_t = sampler.with_images_t(&film_t).into_iter();
        let at_places_t = film_and_images_t.zip(sampler.neighbour_t()).enumerate().map(with_neighbour);
        let fields = Fields { at_places_t: at_places_t.collect(), film_t };
        let read_t = sampler.sum_t(&fields.at_places_t);
        let errors_mm = displacement_errors_mm(points, &read_t, ideal)?;
        let cause = neighbour.as_ref().map(|_| Cause::Neighbour).or(iron.as_ref().map(|_| Cause::Iron));
        let by_surroundings_mm =
            cause.map(|cause| (cause, errors_mm.iter().zip(&nominal_mm).map(|(all, own)| all - own).collect()));

        let displacement = Displacement::new(points, &read_t, ideal)?;
        let (mut terms, mut sensitivities) = (Vec::new(), Vec::new());
        for_each_derivative(&sampler, &fields, |changes_t| {
            let (source, Moments { mean, variance }) = sources[terms.len()];
            let column = displacement.changes_mm(changes_t);
            if mean != 0.0 || variance != 0.0 {
                sensitivities.push(Sensitivity { term: terms.len(), column });
            }
            terms.push(ErrorTerm { source, mean, deviation: variance.sqrt() });
        })?;

        let mut mean_mm = errors_mm;
        for Sensitivity { term, column } in &sensitivities {
            add(&mut mean_mm, terms[*term].mean, column);
        }
        let scaled = |Sensitivity { term, column }: &Sensitivity| -> Vec<f64> {
            column.iter().map(|value| terms[*term].deviation * value).collect()
        };
        let varies = |sensitivity: &&Sensitivity| terms[sensitivity.term].deviation != 0.0;
        let varying = LowRank::new(sensitivities.iter().filter(varies).map(scaled).collect(), OMITTED);
        let noise = noise_moments(film);
        let noise_t2 = DVec3::from(noise.map(|moments| moments.variance));
        let rows = displacement.rows();
        let noise_mm2 = (0..3).flat_map(|axis| rows.iter().map(move |row| (row[axis] * row[axis]).dot(noise_t2)));
        let noise_mm2 = noise_mm2.collect();
        let noise_mean_t = DVec3::from(noise.map(|moments| moments.mean));
        let noise_shift_mm: Vec<f64> =
            (0..3).flat_map(|axis| rows.iter().map(move |row| row[axis].dot(noise_mean_t))).collect();
        add(&mut mean_mm, 1.0, &noise_shift_mm);
        Ok(FirstOrder {
            film: film.clone(),
            ideal: *ideal,
            points: last,
            nominal_mm,
            by_surroundings_mm,
            mean_mm,
            terms,
            sensitivities,
            varying,
            noise_mm2,
            noise_shift_mm,
            noise_mean_t,
            displacement,
        })
    }

    /// All errors: twelve of each tile, twelve of each group, the common ones, and noise at the
    /// reference point.
    pub fn terms(&self) -> &[ErrorTerm] {
        &self.terms
    }

    /// The change of the displacement error along an axis at each point by one standard deviation
    /// of each error that varies, in mm. Numbers are indices of [`FirstOrder::terms`].
    ///
    /// # Panics
    /// If the axis is not 0, 1 or 2.
    pub fn sensitivities_mm(&self, axis: usize) -> impl Iterator<Item = (usize, Vec<f64>)> {
        let varying = self.sensitivities.iter().filter(|sensitivity| self.terms[sensitivity.term].deviation != 0.0);
        varying.map(move |Sensitivity { term, column }| {
            let deviation = self.terms[*term].deviation;
            (*term, self.along(column, axis).iter().map(|value| deviation * value).collect())
        })
    }

    /// Whether readings have noise.
    pub(super) fn has_noise(&self) -> bool {
        self.film.tolerance().common.sensor.noise_t.iter().any(|noise| !noise.is_none())
    }

    /// The part of displacement errors that belongs to an axis.
    pub(super) fn along<'a>(&self, errors_mm: &'a [f64], axis: usize) -> &'a [f64] {
        &errors_mm[axis * self.points..][..self.points]
    }
}

/// The fields at the places of the sensors.
struct Fields {
    /// Of the film, at [`Sampler::places_and_images`].
    film_t: Vec<DVec3>,
    /// Of the film, its images and its neighbour, at [`Sampler::places`].
    at_places_t: Vec<DVec3>,
}

/// Calls a function with the derivative of all readings by each error, in the order of [`sources`].
fn for_each_derivative(sampler: &Sampler, fields: &Fields, mut each: impl FnMut(&[DVec3])) -> Result<(), SampleError> {
    let (film, points, images) = (sampler.film(), sampler.points(), sampler.images());
    let (places, in_film_mm) = (sampler.places(), sampler.places_and_images());
    let none = vec![DVec3::ZERO; in_film_mm.len()];
    let tolerance = film.tolerance();
    let mut of_groups = vec![PerTileError::from_fn(|_| none.clone()); tolerance.groups.len()];
    let pose = [TileError::Position, TileError::Rotation].map(|kind| Axis::ALL.map(kind));
    let mut of_pose = vec![none.clone(); pose.as_flattened().len()];
    let in_film = film.in_film(film.tiles()).map_err(SampleError::Tile)?;
    let read_t = |of_film_t: &[DVec3]| sampler.sum_t(&sampler.with_images_t(of_film_t));
    for (number, tile) in in_film.iter().enumerate() {
        let response = TileResponse::new(number, tile, &in_film_mm)?;
        for error in TileError::ALL {
            let mut changes_t = none.clone();
            response.add_derivative(error, tile.position(), &mut changes_t);
            each(&read_t(&changes_t));
        }
        for (error, sum) in pose.as_flattened().iter().zip(&mut of_pose) {
            response.add_derivative(*error, film.centre_mm(), sum);
        }
        for (group, sums) in tolerance.groups.iter().zip(&mut of_groups) {
            let centre = film.group_centre_mm(group);
            for _ in group.tiles.iter().filter(|tile| **tile == number) {
                sums.iter_mut().for_each(|(error, sum)| response.add_derivative(error, centre, sum));
            }
        }
    }
    of_groups.iter().flat_map(PerTileError::values).for_each(|changes_t| each(&read_t(changes_t)));
    // The change of the field at each place by a motion of the places at which the film is read.
    let by_motion = |motion_mm: &dyn Fn(&Reflection, usize) -> DVec3| {
        let of_places = images.reflections.iter().flat_map(|image| (0..places.len()).map(move |place| (image, place)));
        let change = |(index, (image, place)): (usize, (&Reflection, usize))| {
            let motion_mm = motion_mm(image, place);
            -(motion_mm.x * of_pose[0][index] + motion_mm.y * of_pose[1][index] + motion_mm.z * of_pose[2][index])
        };
        sampler.with_images_t(&of_places.enumerate().map(change).collect::<Vec<_>>())
    };
    // A sensor that moves past the film and the iron that moves with it.
    let by_sensor = |moved: &dyn Fn(usize) -> DVec3| by_motion(&|image, place| image.motion(moved(place)));
    let near_iron = tolerance.common.iron.as_ref();
    let last = points.len() - 1;
    for source in ErrorSource::common(film.chips().len()) {
        let changes_t: Vec<DVec3> = match source {
            ErrorSource::FilmPosition(axis) if images.moves => by_sensor(&|_| -DVec3::AXES[axis]),
            ErrorSource::FilmPosition(axis) => sampler.with_images_t(&of_pose[axis]),
            ErrorSource::FilmRotation(axis) if images.moves => {
                let turn = DVec3::AXES[axis];
                let moved_t = by_sensor(&|place| -turn.cross(places[place] - film.centre_mm()));
                let turned_t = sampler.with_images_t(&fields.film_t).into_iter().map(|b_t| turn.cross(b_t));
                turned_t.zip(moved_t).map(|(turned_t, moved_t)| turned_t + moved_t).collect()
            }
            ErrorSource::FilmRotation(axis) => sampler.with_images_t(&of_pose[3 + axis]),
            ErrorSource::StrayField(axis) => vec![DVec3::AXES[axis]; places.len()],
            // The places move by twice the motion of the iron, away from the film.
            ErrorSource::IronDistance => by_motion(&|image, _| match near_iron {
                Some(iron) if *image != Reflection::NONE => -2.0 * iron.normal,
                _ => DVec3::ZERO,
            }),
            ErrorSource::Sensor { sensor, error } => {
                let own = sensor * points.len()..(sensor + 1) * points.len();
                let mut changes_t = vec![DVec3::ZERO; places.len()];
                let moved_t = |axis: usize| by_sensor(&|_| DVec3::AXES[axis]);
                let of_all = of_sensor(error, &fields.at_places_t, moved_t);
                changes_t[own.clone()].copy_from_slice(&of_all[own]);
                changes_t
            }
            _ => sampler.with_images_t(&fields.film_t),
        };
        let later = match source {
            ErrorSource::StrayField(_) => tolerance.common.stray_field.as_ref().is_some_and(|field| field.later),
            ErrorSource::Temperature => true,
            _ => false,
        };
        let mut changes_t = sampler.sum_t(&changes_t);
        if later {
            changes_t[last] = DVec3::ZERO;
        }
        each(&changes_t);
    }
    for axis in DVec3::AXES {
        let mut changes_t = vec![DVec3::ZERO; points.len()];
        changes_t[last] = axis;
        each(&changes_t);
    }
    Ok(())
}

/// The derivatives of the readings of a sensor by its error, from the readings and their
/// derivatives by its position along each axis.
fn of_sensor(error: SensorError, read_t: &[DVec3], by_position: impl Fn(usize) -> Vec<DVec3>) -> Vec<DVec3> {
    match error {
        SensorError::Offset(axis) => vec![DVec3::AXES[axis]; read_t.len()],
        // Axes that turn one way see the field turn the other way.
        SensorError::Rotation(axis) => read_t.iter().map(|b_t| b_t.cross(DVec3::AXES[axis])).collect(),
        SensorError::Gain(axis) => read_t.iter().map(|b_t| *b_t * DVec3::AXES[axis]).collect(),
        SensorError::Position(axis) => by_position(axis),
    }
}
