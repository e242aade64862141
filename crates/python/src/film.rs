//! A layout with its prepared tiles.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use magsplice::FilmError;
use magsplice::head::Board;
use magsplice::layout::{FilmTolerance, Layout, LayoutError, NamedTile, Preset};
use magsplice::magnet::Tile;
use magsplice_report::{tile_colours, tile_outline};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::exceptions::{bad_value, failed, of_film, of_layout, one_of};
use crate::interruption::Interruption;
use crate::scene::Scene;
use crate::threads::detached;
use crate::vectors::{Triple, rows, rows_of, vectors};

/// The presets in messages.
pub(crate) const PRESETS: &str = "\"by-hand\", \"workshop\" or \"jig\"";

/// A layout with its prepared tiles. The class `magsplice.Film` inherits from it.
#[pyclass(frozen, subclass, module = "magsplice._magsplice")]
pub(crate) struct Film {
    pub(crate) layout: Arc<Layout>,
    /// Text, name of the text, and folder of its files, for copies of the film.
    #[pyo3(get, name = "_source")]
    pub(crate) source: (String, String, Option<String>),
    /// The film prepared by the first evaluation.
    prepared: PyOnceLock<magsplice::Film>,
    scene: PyOnceLock<Py<Scene>>,
}

/// Rows of three or four numbers.
type Rows<'py> = Bound<'py, PyArray2<f64>>;

/// First and last point, points along x, y, z, corners as written, step and reference point of a
/// working volume.
type Volume = (Triple, Triple, Triple<usize>, Triple, Triple, Triple, Triple);

/// Board, spacing, places and weights of a head.
type Head = (Option<&'static str>, Option<f64>, Vec<Triple>, Vec<Triple>);

/// Names, kinds, centres, sides, polarizations, rotations, and own recoil permeabilities of tiles.
type Tiles<'py> = (Vec<String>, Vec<Option<String>>, Rows<'py>, Rows<'py>, Rows<'py>, Rows<'py>, Rows<'py>);

/// Names of tiles, then centres, sides, polarizations and rotations of cuboids.
type Blocks<'py> = (Vec<String>, Rows<'py>, Rows<'py>, Rows<'py>, Rows<'py>);

/// The text of a layout file.
#[pyfunction]
pub(crate) fn layout_text(path: PathBuf) -> PyResult<String> {
    let origin = path.display().to_string();
    let bytes = std::fs::read(&path).map_err(|error| of_layout(LayoutError::Read { path, error }))?;
    String::from_utf8(bytes)
        .map_err(|error| of_layout(LayoutError::Syntax { origin, message: format!("not UTF-8 text: {error}") }))
}

#[pymethods]
impl Film {
    /// The film from the text of a layout file. Its paths are relative to `folder`.
    #[new]
    #[pyo3(signature = (text, origin, folder=None))]
    fn new(py: Python<'_>, text: String, origin: String, folder: Option<PathBuf>) -> PyResult<Film> {
        let layout = py.detach(|| match &folder {
            Some(folder) => Layout::parse_beside(&text, &origin, folder),
            None => Layout::parse(&text, &origin),
        });
        let layout = Arc::new(layout.map_err(of_layout)?);
        let source = (text, origin, folder.map(|folder| folder.display().to_string()));
        Ok(Film { layout, source, prepared: PyOnceLock::new(), scene: PyOnceLock::new() })
    }

    /// The prepared tiles.
    #[getter]
    fn _scene(&self, py: Python<'_>) -> PyResult<Py<Scene>> {
        let scene = self.scene.get_or_try_init(py, || Py::new(py, Scene::from(self.evaluated(py)?.scene().clone())))?;
        Ok(scene.clone_ref(py))
    }

    /// Name of the layout.
    #[getter]
    fn name(&self) -> &str {
        &self.layout.name
    }

    /// The author's description of the layout.
    #[getter]
    fn description(&self) -> Option<&str> {
        self.layout.description.as_deref()
    }

    /// Steps in the history of the layout, one text each.
    #[getter]
    fn history(&self) -> Vec<String> {
        self.layout.history.clone()
    }

    /// SHA-256 of the text of the layout, in hexadecimal.
    #[getter]
    fn sha256(&self) -> &str {
        &self.layout.sha256
    }

    /// Allowed properties that are usually a mistake, one sentence each.
    #[getter]
    fn findings(&self) -> Vec<String> {
        self.layout.findings.iter().map(ToString::to_string).collect()
    }

    /// Layout as TOML, for the program and `loads`.
    ///
    /// Parameters
    /// ----------
    /// compact : bool
    ///     Whether to omit tiles that are mirror images of others. Otherwise there is one
    ///     ``[[tile]]`` for each tile.
    #[pyo3(signature = (*, compact=true))]
    fn to_toml(&self, compact: bool) -> String {
        if compact { self.layout.to_compact_toml() } else { self.layout.to_toml() }
    }

    /// The layout in the plain form as JSON.
    fn _to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.layout.plain()).map_err(failed)
    }

    /// Whether the layouts have the same names and numbers, those of files beside them too.
    fn _is_same(&self, other: &Film) -> PyResult<bool> {
        Ok(self.layout.tolerance == other.layout.tolerance && self._to_json()? == other._to_json()?)
    }

    /// Wavelength, thickness and amplitude of the ideal film.
    #[getter]
    fn _ideal(&self) -> Option<Triple> {
        self.layout.ideal.map(|ideal| (ideal.wavelength(), ideal.thickness(), ideal.amplitude_t()))
    }

    /// The working volume.
    #[getter]
    fn _volume(&self) -> Option<Volume> {
        self.layout.volume.map(|volume| {
            let grid = volume.grid;
            let [lower, upper] = [volume.lower_mm, volume.upper_mm].map(DVec3::into);
            let [step, reference] = [volume.step_mm, volume.reference_mm].map(DVec3::into);
            (grid.lower().into(), grid.upper().into(), grid.counts().into(), lower, upper, step, reference)
        })
    }

    /// The board, the spacing, the places and the weights of a head.
    #[getter]
    fn _head(&self) -> Option<Head> {
        let head = self.layout.sensor.as_ref()?.head.as_ref()?;
        let (places, weights) =
            head.sensors.elements.iter().map(|of| (Triple::from(of.place), Triple::from(of.weight))).unzip();
        Some((head.board.map(Board::name), head.spacing_mm, places, weights))
    }

    /// Whether the reference point of the working volume is the default, or there is no volume.
    #[getter]
    fn _has_default_reference(&self) -> bool {
        self.layout.volume.is_none_or(|volume| volume.has_default_reference())
    }

    /// Number of samples and seed of films as made.
    #[getter]
    fn _sampling(&self) -> (u64, u64) {
        let default = FilmTolerance::default();
        let tolerance = self.layout.tolerance.as_ref().unwrap_or(&default);
        (tolerance.samples, tolerance.seed)
    }

    /// File of the layout's baseline, relative to the layout.
    #[getter]
    fn _baseline_file(&self) -> Option<PathBuf> {
        self.layout.expectations.field.as_ref().map(|field| field.file.clone())
    }

    /// Number of tiles.
    fn __len__(&self) -> usize {
        self.layout.tiles.len()
    }

    /// The tiles as arrays; rotations are quaternions (x, y, z, w). Permeabilities are along and
    /// across the polarization, NaN for tiles with the permeability of the material.
    fn _tiles<'py>(&self, py: Python<'py>) -> PyResult<Tiles<'py>> {
        let tiles = &self.layout.tiles;
        let names = tiles.iter().map(|named| named.name.clone()).collect();
        let kinds = tiles.iter().map(|named| named.kind.clone()).collect();
        let own = |named: &NamedTile| named.permeability.map_or([f64::NAN; 2], |own| [own.along(), own.across()]);
        let permeability = rows(py, tiles.iter().map(own))?;
        let [position, size, polarization_t, rotation] = cuboids(py, &self.layout.bare_tiles())?;
        Ok((names, kinds, position, size, polarization_t, rotation, permeability))
    }

    /// The cuboids whose fields are added: the tiles, or their cells if they have a recoil
    /// permeability, and their images in iron.
    fn _blocks<'py>(&self, py: Python<'py>) -> PyResult<Blocks<'py>> {
        let tiles = self.layout.bare_tiles();
        let film = self.evaluated(py)?;
        let magnetization = film.recoil().map(|recoil| &*recoil.magnetization);
        let blocks = magnetization.map_or(&tiles[..], |of| of.cells());
        let images = self.layout.iron.images(blocks).map_err(failed)?;
        let owner = |block: usize| magnetization.map_or(block, |of| of.owners()[block]);
        let name = |block: usize| &self.layout.tiles[owner(block)].name;
        let of_images = images.owners.iter().map(|block| format!("image of {}", name(*block)));
        let names = (0..blocks.len()).map(|block| name(block).clone()).chain(of_images).collect();
        let [position, size, polarization_t, rotation] = cuboids(py, &[blocks, &images.tiles].concat())?;
        Ok((names, position, size, polarization_t, rotation))
    }

    /// The outline of each tile from above in millimetres, J of the tiles in the frame of the film
    /// in tesla, and their colours in reports: red, green and blue from 0 to 1.
    fn _outlines<'py>(&self, py: Python<'py>) -> PyResult<(Vec<Rows<'py>>, Rows<'py>, Rows<'py>)> {
        let tiles = self.layout.bare_tiles();
        let outline = |tile: &Tile| rows(py, tile_outline(tile).iter().map(DVec2::to_array));
        let polarization_t = || tiles.iter().map(|tile| tile.scene_polarization_t());
        let colours = tile_colours(polarization_t()).into_iter().map(|colour| colour.map(|c| f64::from(c) / 255.0));
        let outlines = tiles.iter().map(outline).collect::<PyResult<_>>()?;
        Ok((outlines, rows(py, polarization_t().map(|of| of.to_array()))?, rows(py, colours)?))
    }

    /// B of the ideal film at points, in tesla; NaN where they are not below the film.
    fn _ideal_b<'py>(&self, points: PyReadonlyArray2<'py, f64>) -> PyResult<Rows<'py>> {
        let ideal = self.layout.ideal.ok_or(FilmError::Missing("ideal")).map_err(of_film)?;
        let (py, points) = (points.py(), vectors(&points)?);
        let at = |point: &DVec3| ideal.flux_density_t(*point).unwrap_or(DVec3::NAN);
        let field_t: Vec<DVec3> = detached(py, || points.iter().map(at).collect())?;
        Ok(rows_of(py, &field_t))
    }
}

/// Centres, sides, polarizations and rotations of cuboids; rotations are quaternions (x, y, z, w).
fn cuboids<'py>(py: Python<'py>, tiles: &[Tile]) -> PyResult<[Rows<'py>; 4]> {
    Ok([
        rows(py, tiles.iter().map(|tile| tile.position().to_array()))?,
        rows(py, tiles.iter().map(|tile| tile.size().to_array()))?,
        rows(py, tiles.iter().map(|tile| tile.polarization_t().to_array()))?,
        rows(py, tiles.iter().map(|tile| tile.rotation().to_array()))?,
    ])
}

impl Film {
    /// The prepared film.
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

    /// A film with the tiles and the material of this film, and other tables.
    pub(crate) fn with_tables(&self, py: Python<'_>, layout: Layout) -> PyResult<magsplice::Film> {
        let recoil = self.evaluated(py)?.recoil().cloned();
        detached(py, || magsplice::Film::with_recoil(layout, recoil))
    }

    /// The layout with the errors of a preset instead of its own. Samples and seed are unchanged.
    pub(crate) fn layout_with_errors(&self, preset: Option<&str>) -> PyResult<Layout> {
        let mut layout = Layout::clone(&self.layout);
        let errors = match preset {
            None => return Ok(layout),
            Some(name) => one_of::<Preset>("preset", name, PRESETS)?.errors(),
        };
        let FilmTolerance { samples, seed, .. } = layout.tolerance.take().unwrap_or_default();
        let of_tiles = FilmTolerance::of_film(&errors, &layout.tiles).map_err(bad_value)?;
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
    let film = film.reporting_to(interruption.clone());
    interruption.run(py, || work(film))?.map_err(of_film)
}
