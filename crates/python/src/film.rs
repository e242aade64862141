//! A layout with its prepared tiles.

use std::path::PathBuf;

use glam::DVec3;
use magsplice::FilmError;
use magsplice::layout::{FilmTolerance, Layout, NamedTile, TileErrors};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::exceptions::{failed, of_film, of_layout};
use crate::scene::Scene;
use crate::vectors::{Triple, rows_of, vectors, written_rows};

/// A layout with its prepared tiles.
#[pyclass(frozen, module = "magsplice._magsplice")]
pub(crate) struct Film {
    pub(crate) layout: Layout,
    scene: Py<Scene>,
}

/// First and last point, points along x, y, z, corners as written, step and reference point of a working
/// volume.
type Volume = (Triple, Triple, Triple<usize>, Triple, Triple, Triple, Triple);

/// Names, kinds, centres, sides, polarizations and rotations of tiles.
type Tiles<'py> = (
    Vec<String>,
    Vec<Option<String>>,
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
        let layout = py.detach(|| Layout::read(&path)).map_err(of_layout)?;
        Film::new(py, layout)
    }

    /// The film in the text of a layout file. Paths in it are relative to `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, origin, folder=None))]
    fn parse(py: Python<'_>, text: &str, origin: &str, folder: Option<PathBuf>) -> PyResult<Film> {
        let layout = py.detach(|| match folder {
            Some(folder) => Layout::parse_beside(text, origin, folder),
            None => Layout::parse(text, origin),
        });
        Film::new(py, layout.map_err(of_layout)?)
    }

    /// The prepared tiles.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
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

    /// The tiles as arrays; rotations are quaternions (x, y, z, w).
    fn tiles<'py>(&self, py: Python<'py>) -> PyResult<Tiles<'py>> {
        let tiles = &self.layout.tiles;
        let of_each =
            |value: &dyn Fn(&NamedTile) -> DVec3| rows_of(py, &tiles.iter().map(value).collect::<Vec<DVec3>>());
        let rotation = PyArray2::zeros(py, [tiles.len(), 4], false);
        for (row, named) in rotation.readwrite().as_slice_mut()?.as_chunks_mut::<4>().0.iter_mut().zip(tiles) {
            *row = named.tile.rotation().to_array();
        }
        Ok((
            tiles.iter().map(|named| named.name.clone()).collect(),
            tiles.iter().map(|named| named.kind.clone()).collect(),
            of_each(&|named| named.tile.position()),
            of_each(&|named| named.tile.size()),
            of_each(&|named| named.tile.polarization_t()),
            rotation,
        ))
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

impl Film {
    /// A film of a layout, whose tiles are prepared.
    pub(crate) fn new(py: Python<'_>, layout: Layout) -> PyResult<Film> {
        let scene = py.detach(|| evaluated(&layout).map(|film| film.scene().clone()))?;
        Ok(Film { layout, scene: Py::new(py, Scene::from(scene))? })
    }

    /// The film, to be evaluated; see [`evaluated`].
    pub(crate) fn evaluated(&self) -> PyResult<magsplice::Film<'_>> {
        evaluated(&self.layout)
    }

    /// The layout with the errors of a preset instead of those it states. Samples and seed stay.
    pub(crate) fn layout_with_errors(&self, preset: Option<&str>) -> PyResult<Layout> {
        let mut layout = self.layout.clone();
        let errors = match preset {
            None => return Ok(layout),
            Some("by-hand") => TileErrors::by_hand(),
            Some("workshop") => TileErrors::workshop(),
            Some("jig") => TileErrors::jig(),
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

/// A layout with its tiles prepared. Without the interpreter, since that takes time.
pub(crate) fn evaluated(layout: &Layout) -> PyResult<magsplice::Film<'_>> {
    magsplice::Film::new(layout).map_err(of_film)
}
