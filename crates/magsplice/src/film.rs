//! A film: a layout evaluated step by step, from field to comparison and decoupling.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_head::SensorHead;
use magsplice_ideal::IdealFilm;
use magsplice_layout::{BYTES_PER_POINT, Layout, TileErrors, WorkingVolume};
use magsplice_magnet::{Accuracy, Grid, PointError, PointErrorCause, PointErrors, Quantity};
use magsplice_sensor::SensedField;
use magsplice_tolerance::{EvaluationGrid, RealFilm, Weakening};

use crate::film_error::FilmError;
use crate::film_recoil::FilmRecoil;
use crate::stage::{Progress, Stage};

/// Number of pairs of tile and point between progress callbacks: about a tenth of a second of one
/// thread.
const PAIRS_BETWEEN_CALLS: usize = 1 << 24;

/// A layout with its tiles prepared for evaluation. Lengths in millimetres, flux density in tesla.
///
/// ```
/// use magsplice::prelude::*;
///
/// let text = r#"
///     format = 1
///     name = "four squares"
///     [ideal]
///     wavelength_mm = 10.0
///     thickness_mm = 1.0
///     amplitude_t = 0.12
///     [volume]
///     x_mm = [-1.0, 1.0]
///     y_mm = [-1.0, 1.0]
///     z_mm = [-4.0, -3.0]
///     step_mm = 0.5
///     [[tile]]
///     position_mm = [2.5, 2.5, 0.5]
///     size_mm = [3.3, 3.3, 1.0]
///     polarization_t = [0.085, 0.085, 0.0]
///     mirror = { axes = ["x", "y"] }
/// "#;
/// let film = Film::new(Layout::parse(text, "example")?)?;
/// assert!(film.compare()?.comparison.amplitude > 0.5);
/// assert!(film.decouple()?.decoupling.uniformity_rmse.r_x.unwrap() < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Recoil
/// Tiles with a recoil permeability above 1 are divided into cells whose polarization agrees with
/// the field of all of them. The division is refined until the error of B is at most the fraction
/// `recoil_error` of `[material]` of the change of B by recoil, at points of the working volume or,
/// in a layout without one, around the tiles. [`Film::recoil`] returns the result.
///
/// Clones share the layout, the prepared tiles and the field of the working volume.
#[derive(Clone)]
pub struct Film {
    layout: Arc<Layout>,
    scene: Arc<Scene>,
    recoil: Option<FilmRecoil>,
    /// B over the working volume, once it was needed.
    volume_field_t: Arc<OnceLock<Result<Vec<DVec3>, FilmError>>>,
    progress: Option<Arc<dyn Progress>>,
}

impl fmt::Debug for Film {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Film").field("layout", &self.layout.name).finish_non_exhaustive()
    }
}

impl Film {
    /// Prepares the tiles of a layout for evaluation.
    ///
    /// # Errors
    /// [`FilmError::Recoil`] if tiles have a recoil permeability and their polarization is not
    /// known to the stated error.
    pub fn new(layout: impl Into<Arc<Layout>>) -> Result<Film, FilmError> {
        let layout = layout.into();
        let recoil = FilmRecoil::new(&layout, &|_: Stage| {})?;
        Ok(Film::with_recoil(layout, recoil))
    }

    /// Prepares the tiles of a layout. `progress` receives the progress of this and all later work,
    /// see [`Film::reporting_to`].
    ///
    /// # Errors
    /// As [`Film::new`].
    pub fn with_progress(layout: impl Into<Arc<Layout>>, progress: Arc<dyn Progress>) -> Result<Film, FilmError> {
        let layout = layout.into();
        let recoil = FilmRecoil::new(&layout, &*progress)?;
        Ok(Film::with_recoil(layout, recoil).reporting_to(progress))
    }

    /// The film whose tiles have the polarization that an earlier film found, see [`Film::recoil`].
    /// Layouts of both must have the same tiles and material; other tables may differ. Nothing is
    /// solved again.
    ///
    /// # Panics
    /// If a tile is not before the planes of iron, which [`Layout::checked`] refuses.
    pub fn with_recoil(layout: impl Into<Arc<Layout>>, recoil: Option<FilmRecoil>) -> Film {
        let layout = layout.into();
        let scene = match &recoil {
            Some(recoil) => Scene::of_cells(recoil.magnetization.cells(), recoil.magnetization.owners()),
            None => Scene::new(&layout.bare_tiles()),
        };
        let scene = scene.with_planes(&layout.iron).expect("a checked layout has all tiles before its planes");
        Film { layout, scene: Arc::new(scene), recoil, volume_field_t: Arc::default(), progress: None }
    }

    /// The film whose tiles keep the polarization of the layout, whatever their recoil
    /// permeability.
    ///
    /// # Panics
    /// As [`Film::with_recoil`].
    pub fn rigid(layout: impl Into<Arc<Layout>>) -> Film {
        Film::with_recoil(layout, None)
    }

    /// The same film, whose fields of the working volume have this accuracy. A new film is exact.
    pub fn with_accuracy(self, accuracy: Accuracy) -> Film {
        if accuracy == self.scene.accuracy() {
            return self;
        }
        let scene = Arc::unwrap_or_clone(self.scene).with_accuracy(accuracy);
        Film { scene: Arc::new(scene), volume_field_t: Arc::default(), ..self }
    }

    /// The same film, which reports its progress between parts of its work, from any thread. A
    /// panic in `progress` ends the work and propagates to the caller: this is the way to interrupt
    /// the work.
    pub fn reporting_to(self, progress: Arc<dyn Progress>) -> Film {
        Film { progress: Some(progress), ..self }
    }

    /// Reports a stage of the work, if anything receives it.
    pub fn tell(&self, stage: Stage) {
        if let Some(progress) = &self.progress {
            progress.show(stage);
        }
    }

    /// The layout of the film.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// The polarization of tiles with a recoil permeability. `None` if no tile of the layout has
    /// one.
    pub fn recoil(&self) -> Option<&FilmRecoil> {
        self.recoil.as_ref()
    }

    /// The prepared tiles, or their cells if they have a recoil permeability.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The working volume of the layout.
    ///
    /// # Errors
    /// If the layout has none.
    pub fn volume(&self) -> Result<&WorkingVolume, FilmError> {
        self.layout.volume.as_ref().ok_or(FilmError::Missing("volume"))
    }

    /// The working volume, for work that takes so many bytes for each of its points.
    ///
    /// # Errors
    /// If the layout has none, or [`FilmError::Memory`].
    pub fn volume_for(&self, bytes_per_point: f64) -> Result<&WorkingVolume, FilmError> {
        let volume = self.volume()?;
        volume.check_memory(bytes_per_point).map_err(FilmError::Memory)?;
        Ok(volume)
    }

    /// The ideal film of the layout.
    ///
    /// # Errors
    /// If the layout has none.
    pub fn ideal(&self) -> Result<&IdealFilm, FilmError> {
        self.layout.ideal.as_ref().ok_or(FilmError::Missing("ideal"))
    }

    /// The film with the random errors of films as made.
    ///
    /// Tiles with a recoil permeability weaken and turn as the tiles without errors do. The part of
    /// the field that the mean polarizations do not represent is the same in all films. The effect
    /// of the errors of one tile on the polarization of the others is neglected: it is of the order
    /// of the susceptibility times the errors.
    ///
    /// # Errors
    /// If the layout states no errors, or has recoil beside iron.
    pub fn real_film(&self) -> Result<RealFilm, FilmError> {
        let tolerance = self.layout.tolerance.as_ref().ok_or(FilmError::Missing("tolerance"))?;
        let of_strips = self.layout.tiles.iter().zip(&tolerance.tiles).filter(|(named, _)| named.disc.is_some());
        if of_strips.into_iter().any(|(_, errors)| *errors != TileErrors::default()) {
            return Err(FilmError::StripErrors);
        }
        if self.recoil.is_some() && tolerance.common.iron.is_some() {
            return Err(FilmError::RecoilNearIron);
        }
        let film = RealFilm::new(&self.layout.bare_tiles(), tolerance).with_iron(self.layout.iron.clone());
        Ok(self.weakened(film).with_head(self.head().cloned()))
    }

    /// A film with other tiles at the places of this film. Its tiles weaken and turn as the tiles
    /// of this film do.
    ///
    /// # Panics
    /// If it does not have as many tiles.
    pub fn weakened(&self, film: RealFilm) -> RealFilm {
        let Some(recoil) = &self.recoil else { return film };
        let solution = &recoil.magnetization;
        let remainder = Scene::new(&solution.deviations()).with_planes(&self.layout.iron);
        let remainder = remainder.expect("cells of tiles before the iron, as the layout requires");
        film.with_weakening(Weakening::new(&self.layout.bare_tiles(), &solution.mean_tiles(), remainder))
    }

    /// The field of the film as read by the sensor of the layout, in the volume spanned by a grid.
    /// Without `[sensor]` in the layout the sensor is perfect.
    ///
    /// # Errors
    /// [`FilmError::Sensor`] if the field changes too much over the active area.
    pub fn sensed_field(&self, volume: &Grid) -> Result<SensedField<'_>, FilmError> {
        let sensed = match (&self.layout.sensor, self.head()) {
            (_, Some(head)) => SensedField::of_head(&self.scene, head, volume),
            (Some(sensor), None) => SensedField::new(&self.scene, sensor.element, volume),
            (None, None) => Ok(SensedField::from(&*self.scene)),
        };
        sensed.map_err(FilmError::Sensor)
    }

    /// The head of the layout; `None` for one sensor.
    pub fn head(&self) -> Option<&SensorHead> {
        self.layout.head()
    }

    /// The field at a position of the sensor: at the position itself, or the weighted sum over the
    /// places of a head.
    pub(crate) fn seen_t<E>(&self, position: DVec3, field_t: impl Fn(DVec3) -> Result<DVec3, E>) -> Result<DVec3, E> {
        self.head().map_or_else(|| field_t(position), |head| head.seen(position, &field_t))
    }

    /// The points of the working volume and the reference point, for work that takes so many bytes
    /// for each point.
    ///
    /// # Errors
    /// As [`Film::volume_for`].
    pub fn evaluation_grid(&self, bytes_per_point: f64) -> Result<EvaluationGrid, FilmError> {
        let volume = self.volume_for(bytes_per_point)?;
        Ok(EvaluationGrid { grid: volume.grid, reference: volume.reference_mm })
    }

    /// B in tesla on the grid of the working volume, z fastest, to the film's accuracy. Of a head,
    /// it is the weighted sum of B at the places of its sensors. It is computed once.
    ///
    /// # Errors
    /// [`FilmError::Missing`] if the layout has no working volume; [`FilmError::Memory`] if it has
    /// too many points; [`FilmError::Points`] if the field does not exist at some of them.
    pub fn volume_field_t(&self) -> Result<&[DVec3], FilmError> {
        let known = self.volume_field_t.get_or_init(|| self.field_of_volume_t());
        known.as_deref().map_err(Clone::clone)
    }

    fn field_of_volume_t(&self) -> Result<Vec<DVec3>, FilmError> {
        let grid = &self.volume_for(BYTES_PER_POINT)?.grid;
        if self.head().is_some() {
            return self.field_at_t(&grid.points().collect::<Vec<DVec3>>());
        }
        let mut field = vec![DVec3::ZERO; grid.len()];
        let evaluated = self.with_counted_points(grid.len(), |progress| {
            self.scene.field_on_grid_with_progress(Quantity::FluxDensity, grid, &mut field, progress)
        });
        evaluated.map(|()| field).map_err(FilmError::Points)
    }

    /// B in tesla at points, in their order, to the film's accuracy. Of a head, it is the weighted
    /// sum of B at the places of its sensors.
    ///
    /// # Errors
    /// [`FilmError::Points`] if the field does not exist at some of the points.
    pub fn field_at_t(&self, points: &[DVec3]) -> Result<Vec<DVec3>, FilmError> {
        let one = |points: &[DVec3]| -> Result<Vec<DVec3>, FilmError> {
            let mut field = vec![DVec3::ZERO; points.len()];
            let evaluated = self.with_counted_points(points.len(), |progress| {
                self.scene.field_with_progress(Quantity::FluxDensity, points, &mut field, progress)
            });
            evaluated.map(|()| field).map_err(FilmError::Points)
        };
        let Some(head) = self.head() else { return one(points) };
        let mut sums = vec![DVec3::ZERO; points.len()];
        for of in &head.elements {
            let places: Vec<DVec3> = points.iter().map(|point| *point + of.place).collect();
            sums.iter_mut().zip(one(&places)?).for_each(|(sum, b)| *sum += of.weight * b);
        }
        Ok(sums)
    }

    /// A callback that is called, from any thread, as often as something begins, and reports how
    /// many have begun as progress of a stage.
    pub(crate) fn counting(&self, name: &'static str, of: Option<usize>, unit: &'static str) -> impl Fn() + Sync {
        let done = AtomicUsize::new(0);
        move || self.tell(Stage { name, done: done.fetch_add(1, Ordering::Relaxed), of, unit })
    }

    /// Evaluates `of` points with a callback that is told, from any thread, how many more begin.
    /// The progress callback of the film is called from time to time.
    pub fn with_counted_points<T>(&self, of: usize, evaluate: impl FnOnce(&(dyn Fn(usize) + Sync)) -> T) -> T {
        let between = (PAIRS_BETWEEN_CALLS / self.scene.tile_count().max(1)).max(1);
        let done = AtomicUsize::new(0);
        let tell = |done: usize| self.tell(Stage { name: "field", done, of: Some(of), unit: "points" });
        tell(0);
        evaluate(&|points| {
            let before = done.fetch_add(points, Ordering::Relaxed);
            let after = before + points;
            if before / between < after / between {
                tell(after);
            }
        })
    }

    /// B in tesla at the reference point of the working volume, exact for any accuracy of the film.
    /// Of a head, it is the weighted sum of B at the places of its sensors.
    ///
    /// # Errors
    /// If the layout has no working volume, or the field does not exist at the point.
    pub fn reference_field_t(&self) -> Result<DVec3, FilmError> {
        let point = self.volume()?.reference_mm;
        let refused =
            |cause: PointErrorCause| FilmError::Points(PointErrors(vec![PointError { index: 0, point, cause }]));
        self.seen_t(point, |place| self.scene.field(Quantity::FluxDensity, place).map_err(refused))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use magsplice_magnet::{Permeability, Tolerance};

    use super::*;

    /// A layout with 51 x 51 x 51 points, 3 stretches, in a box that begins at `z_mm`.
    fn layout(z_mm: f64) -> Layout {
        let text = format!(
            "format = 1\nname = \"one\"\n\
             [[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n\
             [volume]\nx_mm = [-2.5, 2.5]\ny_mm = [-2.5, 2.5]\nz_mm = [{z_mm:?}, {:?}]\nstep_mm = 0.1\n",
            z_mm + 5.0
        );
        Layout::parse(&text, "layout").unwrap()
    }

    /// The field from the film on its grid, and from its scene at the points of the grid.
    fn both(layout: &Layout, accuracy: Accuracy) -> [Result<Vec<DVec3>, FilmError>; 2] {
        let film = Film::new(layout.clone()).unwrap().with_accuracy(accuracy);
        let grid = &film.volume().unwrap().grid;
        let at_once = match accuracy {
            Accuracy::Exact => film.scene().field_at(Quantity::FluxDensity, &grid.points().collect::<Vec<DVec3>>()),
            Accuracy::Within(_) => film.scene().field_on_grid(Quantity::FluxDensity, grid),
        };
        [film.volume_field_t().map(<[DVec3]>::to_vec), at_once.map_err(FilmError::Points)]
    }

    #[test]
    fn parts_of_a_grid_change_no_digit_and_no_error() {
        let below = layout(-6.0);
        for accuracy in [Accuracy::Exact, Accuracy::Within(Tolerance::relative(1e-6).unwrap())] {
            let [film, scene] = both(&below, accuracy);
            assert!(film.is_ok() && film == scene);
        }
        // Edges of the tile are among the points, in more than one part of the grid.
        let [film, scene] = both(&layout(-3.5), Accuracy::Exact);
        let Err(FilmError::Points(errors)) = &film else { panic!("{film:?}") };
        assert!(errors.0.first().unwrap().index < 1 << 16 && errors.0.last().unwrap().index > 1 << 16);
        assert_eq!(film, scene);
    }

    #[test]
    fn film_with_a_known_recoil_has_its_field() {
        let mut layout = layout(-6.0);
        layout.material.permeability = Permeability::isotropic(1.2).unwrap();
        let solved = Film::new(layout.clone()).unwrap();
        let known = Film::with_recoil(layout.clone(), solved.recoil().cloned());
        let [solved, known, rigid] = [&solved, &known, &Film::rigid(layout)].map(|film| film.reference_field_t());
        assert!(solved == known && solved != rigid);
    }

    #[test]
    fn progress_is_told_from_time_to_time() {
        let told = Arc::new(Mutex::new(Vec::new()));
        let heard = told.clone();
        let progress = Arc::new(move |stage: Stage| heard.lock().unwrap().push(stage));
        let film = Film::with_progress(layout(-6.0), progress).unwrap();
        film.volume_field_t().unwrap();
        let stage = |done, of| Stage { name: "field", done, of: Some(of), unit: "points" };
        // Its single tile is evaluated in less than a tenth of a second.
        assert_eq!(*told.lock().unwrap(), [stage(0, 132_651)]);
        told.lock().unwrap().clear();
        film.with_counted_points(1 << 30, |progress| (0..4).for_each(|_| progress(PAIRS_BETWEEN_CALLS / 2)));
        let [first, second] = [1, 2].map(|calls| stage(calls * PAIRS_BETWEEN_CALLS, 1 << 30));
        assert_eq!(*told.lock().unwrap(), [stage(0, 1 << 30), first, second]);
    }
}
