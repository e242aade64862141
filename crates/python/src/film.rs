//! A layout with its prepared tiles.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use magsplice::FilmError;
use magsplice::layout::{FilmTolerance, Layout, NamedTile, Preset};
use magsplice::magnet::Tile;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::exceptions::{failed, of_film, of_layout};
use crate::interruption::Interruption;
use crate::scene::Scene;
use crate::vectors::{Triple, rows_of, vectors, written_rows};

/// A layout with its prepared tiles.
#[pyclass(frozen, module = "magsplice._magsplice")]
pub(crate) struct Film {
    pub(crate) layout: Arc<Layout>,
    /// What the first evaluation prepared for all others.
    prepared: PyOnceLock<magsplice::Film>,
    scene: PyOnceLock<Py<Scene>>,
}

/// First and last point, points along x, y, z, corners as written, step and reference point of a
/// working volume.
type Volume = (Triple, Triple, Triple<usize>, Triple, Triple, Triple, Triple);

/// Names, kinds, centres, sides, polarizations, rotations, and own recoil permeabilities of tiles.
type Tiles<'py> = (
    Vec<String>,
    Vec<Option<String>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
);

/// Indices of the tiles, then centres, sides, polarizations and rotations of cells.
type Cells<'py> = (
    Vec<usize>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
);

#[pymethods]
impl Film {
    /// The film in a layout file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Film> {
        py.detach(|| Layout::read(&path)).map(Film::from).map_err(of_layout)
    }

    /// The film in the text of a layout file. Paths in it are relative to `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, origin, folder=None))]
    fn parse(py: Python<'_>, text: &str, origin: &str, folder: Option<PathBuf>) -> PyResult<Film> {
        let layout = py.detach(|| match folder {
            Some(folder) => Layout::parse_beside(text, origin, folder),
            None => Layout::parse(text, origin),
        });
        layout.map(Film::from).map_err(of_layout)
    }

    /// The prepared tiles.
    #[getter]
    fn scene(&self, py: Python<'_>) -> PyResult<Py<Scene>> {
        let scene = self.scene.get_or_try_init(py, || Py::new(py, Scene::from(self.evaluated(py)?.scene().clone())))?;
        Ok(scene.clone_ref(py))
    }

    /// Name of the layout.
    #[getter]
    fn name(&self) -> &str {
        &self.layout.name
    }

    /// The author's text about the layout.
    #[getter]
    fn description(&self) -> Option<&str> {
        self.layout.description.as_deref()
    }

    /// The steps that led to the layout.
    #[getter]
    fn history(&self) -> Vec<String> {
        self.layout.history.clone()
    }

    /// SHA-256 of the text of the layout.
    #[getter]
    fn sha256(&self) -> &str {
        &self.layout.sha256
    }

    /// Properties that are allowed but usually a mistake.
    #[getter]
    fn findings(&self) -> Vec<String> {
        self.layout.findings.iter().map(ToString::to_string).collect()
    }

    /// Wavelength, thickness and amplitude of the ideal film.
    #[getter]
    fn ideal(&self) -> Option<(f64, f64, f64)> {
        self.layout.ideal.map(|ideal| (ideal.wavelength(), ideal.thickness(), ideal.amplitude_t()))
    }

    /// The working volume.
    #[getter]
    fn volume(&self) -> Option<Volume> {
        self.layout.volume.map(|volume| {
            let grid = volume.grid;
            let [lower, upper] = [volume.lower_mm, volume.upper_mm].map(DVec3::into);
            let [step, reference] = [volume.step_mm, volume.reference_mm].map(DVec3::into);
            (grid.lower().into(), grid.upper().into(), grid.counts().into(), lower, upper, step, reference)
        })
    }

    /// Number of samples and seed of the films that are made.
    #[getter]
    fn sampling(&self) -> Option<(u64, u64)> {
        self.layout.tolerance.as_ref().map(|tolerance| (tolerance.samples, tolerance.seed))
    }

    /// Number of tiles.
    fn __len__(&self) -> usize {
        self.layout.tiles.len()
    }

    /// The tiles as arrays; rotations are quaternions (x, y, z, w). Permeabilities are along and
    /// across the polarization, NaN for tiles that have that of the material.
    fn tiles<'py>(&self, py: Python<'py>) -> PyResult<Tiles<'py>> {
        let tiles = &self.layout.tiles;
        let of_each =
            |value: &dyn Fn(&NamedTile) -> DVec3| rows_of(py, &tiles.iter().map(value).collect::<Vec<DVec3>>());
        let permeability = PyArray2::zeros(py, [tiles.len(), 2], false);
        for (row, named) in permeability.readwrite().as_slice_mut()?.as_chunks_mut::<2>().0.iter_mut().zip(tiles) {
            *row = named.permeability.map_or([f64::NAN; 2], |own| [own.along(), own.across()]);
        }
        Ok((
            tiles.iter().map(|named| named.name.clone()).collect(),
            tiles.iter().map(|named| named.kind.clone()).collect(),
            of_each(&|named| named.tile.position()),
            of_each(&|named| named.tile.size()),
            of_each(&|named| named.tile.polarization_t()),
            rotations(py, tiles.iter().map(|named| &named.tile))?,
            permeability,
        ))
    }

    /// The cells of tiles with a recoil permeability: the indices of their tiles, centres, sides,
    /// polarizations and rotations. None without.
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Option<Cells<'py>>> {
        let Some(recoil) = self.evaluated(py)?.recoil() else { return Ok(None) };
        let cells = recoil.magnetization.cells();
        let of_each = |value: &dyn Fn(&Tile) -> DVec3| rows_of(py, &cells.iter().map(value).collect::<Vec<DVec3>>());
        let owners = recoil.magnetization.owners().to_vec();
        let (position, size) = (of_each(&Tile::position), of_each(&Tile::size));
        Ok(Some((owners, position, size, of_each(&Tile::polarization_t), rotations(py, cells.iter())?)))
    }

    /// B of the ideal film at points, in tesla; NaN where they are not below the film.
    fn ideal_b<'py>(&self, py: Python<'py>, points: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let ideal = self.layout.ideal.ok_or(FilmError::Missing("ideal")).map_err(of_film)?;
        let points = vectors(&points)?;
        let (field_t, ()) = written_rows(py, points.len(), |field_t| {
            py.detach(|| {
                for (field_t, point) in field_t.iter_mut().zip(points) {
                    *field_t = ideal.flux_density_t(*point).unwrap_or(DVec3::NAN);
                }
            });
            Ok(())
        })?;
        Ok(field_t)
    }

    /// The layout in the plain form as JSON.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.layout.plain()).map_err(failed)
    }

    /// The layout as TOML, in the plain form or with mirror images left out.
    fn to_toml(&self, compact: bool) -> String {
        if compact { self.layout.to_compact_toml() } else { self.layout.to_toml() }
    }
}

/// The rotations of tiles, as quaternions (x, y, z, w).
fn rotations<'a, 'py>(
    py: Python<'py>,
    tiles: impl ExactSizeIterator<Item = &'a Tile>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rotation = PyArray2::zeros(py, [tiles.len(), 4], false);
    for (row, tile) in rotation.readwrite().as_slice_mut()?.as_chunks_mut::<4>().0.iter_mut().zip(tiles) {
        *row = tile.rotation().to_array();
    }
    Ok(rotation)
}

impl From<Layout> for Film {
    fn from(layout: Layout) -> Film {
        Film { layout: Arc::new(layout), prepared: PyOnceLock::new(), scene: PyOnceLock::new() }
    }
}

impl Film {
    /// The film, to be evaluated.
    pub(crate) fn evaluated(&self, py: Python<'_>) -> PyResult<&magsplice::Film> {
        self.prepared.get_or_try_init(py, || {
            let interruption = Arc::new(Interruption::default());
            let prepare = || magsplice::Film::with_progress(self.layout.clone(), interruption.clone());
            interruption.run(py, prepare)?.map_err(of_film)
        })
    }

    /// Evaluates the film in a thread. A signal ends the work.
    pub(crate) fn run<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(magsplice::Film) -> Result<T, FilmError> + Send,
    ) -> PyResult<T> {
        run(py, self.evaluated(py)?.clone(), work)
    }

    /// A film with the tiles and the material of this one, and other tables.
    pub(crate) fn with_tables(&self, py: Python<'_>, layout: Layout) -> PyResult<magsplice::Film> {
        let recoil = self.evaluated(py)?.recoil().cloned();
        Ok(py.detach(|| magsplice::Film::with_recoil(layout, recoil)))
    }

    /// The layout with the errors of a preset instead of those it states. Samples and seed stay.
    pub(crate) fn layout_with_errors(&self, preset: Option<&str>) -> PyResult<Layout> {
        let mut layout = Layout::clone(&self.layout);
        let errors = match preset {
            None => return Ok(layout),
            Some("by-hand") => Preset::ByHand.errors(),
            Some("workshop") => Preset::Workshop.errors(),
            Some("jig") => Preset::Jig.errors(),
            Some(other) => {
                return Err(PyValueError::new_err(format!(
                    "preset = {other:?}, must be \"by-hand\", \"workshop\" or \"jig\""
                )));
            }
        };
        let FilmTolerance { samples, seed, .. } = layout.tolerance.take().unwrap_or_default();
        let of_tiles = FilmTolerance::of_tiles(&errors, layout.tiles.len());
        layout.tolerance = Some(FilmTolerance { samples, seed, ..of_tiles });
        Ok(layout)
    }
}

/// Evaluates a film in a thread. A signal ends the work.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    film: magsplice::Film,
    work: impl FnOnce(magsplice::Film) -> Result<T, FilmError> + Send,
) -> PyResult<T> {
    let interruption = Arc::new(Interruption::default());
    let film = film.telling(interruption.clone());
    interruption.run(py, || work(film))?.map_err(of_film)
}
