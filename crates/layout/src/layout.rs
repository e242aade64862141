//! A layout after it has been checked: named tiles, the ideal film, the working volume and the
//! requirements.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DQuat;
use magsplice_head::SensorHead;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{IronPlanes, Permeability, Tile};

use crate::brief::Brief;
use crate::elastomer::Elastomer;
use crate::expectations::Expectations;
use crate::finding::Finding;
use crate::material::Material;
use crate::rotation::Rotation;
use crate::sensor::StatedSensor;
use crate::tolerance::FilmTolerance;
use crate::volume::WorkingVolume;

/// A spliced film or any other arrangement of block magnets, with the ideal film it is compared
/// with and the requirements it must meet.
///
/// A layout from [`Layout::read`] or [`Layout::parse`] obeys every rule of docs/layout-format.md.
/// The fields are public, and a layout made or changed in memory is not checked until
/// [`Layout::checked`] does so.
///
/// # Units
/// All lengths are in millimetres, all polarizations in tesla.
///
/// # Example
/// ```
/// use magsplice_layout::Layout;
///
/// let text = r#"
///     format = 1
///     name = "two tiles"
///     [[tile]]
///     position_mm = [-2.0, 0.0, 0.5]
///     size_mm = [3.3, 1.7, 1.0]
///     polarization_t = [0.12, 0.0, 0.0]
///     mirror = { axes = ["x"] }
/// "#;
/// let layout = Layout::parse(text, "example")?;
/// assert_eq!(layout.tiles[1].name, "tile-1-mx");
/// assert_eq!(layout.tiles[1].tile.position().x, 2.0);
/// # Ok::<(), magsplice_layout::LayoutError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// Name of the layout.
    pub name: String,
    /// The author's free text about the layout.
    pub description: Option<String>,
    /// The sinusoidal film to compare with, in millimetres and tesla.
    pub ideal: Option<IdealFilm>,
    /// The region in which the field is evaluated.
    pub volume: Option<WorkingVolume>,
    /// The requirements that the film must meet.
    pub expectations: Expectations,
    /// What a search may change to improve the film, and its goal.
    pub brief: Option<Brief>,
    /// The errors of films as made. `None` if the layout specifies none.
    pub tolerance: Option<FilmTolerance>,
    /// The sensor below the film. `None` for a perfect one.
    pub sensor: Option<StatedSensor>,
    /// The elastic layer between film and sensor.
    pub elastomer: Option<Elastomer>,
    /// Flat iron that moves with the film.
    pub iron: IronPlanes,
    /// The material of the tiles.
    pub material: Material,
    /// Largest error of the field one radius away from a disc that strips of cuboids stand for, as
    /// a fraction of the largest field there. `None` without discs.
    pub shape_error: Option<f64>,
    /// Largest error of the field of an endless wave in slices where the working volume is nearest
    /// to it, as a fraction of the field there. `None` without waves or a volume beside them.
    pub slice_error: Option<f64>,
    /// The steps that led to this layout, one text each.
    pub history: Vec<String>,
    /// Depth by which tiles may overlap, in millimetres: 0 but for films as they were measured, and
    /// for numbers with few decimals.
    pub overlap_mm: f64,
    /// All tiles, repetitions written out. No two of them overlap by more than round-off and
    /// `overlap_mm`.
    pub tiles: Vec<NamedTile>,
    /// SHA-256 of the file's bytes, in lower-case hexadecimal.
    pub sha256: String,
    /// The file from which the layout was read. `None` if it was made in memory.
    pub file: Option<Arc<SourceFile>>,
    /// Properties that are allowed but usually a mistake, such as a tile without polarization.
    pub findings: Vec<Finding>,
}

/// The file of a layout as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFile {
    /// Its text.
    pub text: String,
    /// The folder that paths in the text are relative to.
    pub folder: PathBuf,
}

impl Layout {
    /// Whether the layout states errors of its tiles, which a film as made has.
    pub fn states_errors_of_tiles(&self) -> bool {
        self.tolerance.as_ref().is_some_and(|tolerance| !tolerance.tiles.is_empty())
    }

    /// The tiles without their names, in the same order, in millimetres and tesla.
    pub fn bare_tiles(&self) -> Vec<Tile> {
        self.tiles.iter().map(|named| named.tile).collect()
    }

    /// The head that reads the film; `None` for one sensor.
    pub fn head(&self) -> Option<&SensorHead> {
        Some(&self.sensor.as_ref()?.head.as_ref()?.sensors)
    }

    /// The spacing of the head in millimetres. `None` without a head, and where its sensors have
    /// fixed places.
    pub fn head_spacing_mm(&self) -> Option<f64> {
        self.sensor.as_ref()?.head.as_ref()?.spacing_mm
    }

    /// The layout with another spacing of its head, and the weights of least noise for it. `None`
    /// where the head has no spacing, or no weights keep the form of Eq. 2 at this one.
    pub fn with_head_spacing(&self, spacing_mm: f64) -> Option<Layout> {
        self.head_spacing_mm()?;
        let sensor = self.sensor.as_ref()?;
        let sensor = sensor.on_board(sensor.head.as_ref()?.board?, Some(spacing_mm), self.ideal?.wavelength()).ok()?;
        Some(Layout { sensor: Some(sensor), ..self.clone() })
    }

    /// The recoil permeability of each tile: its own, or the material's.
    pub fn permeabilities(&self) -> Vec<Permeability> {
        self.tiles.iter().map(|named| named.permeability.unwrap_or(self.material.permeability)).collect()
    }

    /// Whether the field changes the polarization of any tile.
    pub fn has_recoil(&self) -> bool {
        self.permeabilities().iter().any(|permeability| !permeability.is_rigid())
    }
}

/// A tile with its name, its kind and its rotation as written.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedTile {
    /// Name, unique within the layout.
    pub name: String,
    /// Name of the kind that gave the size, if there was one.
    pub kind: Option<String>,
    /// The rotation as written, from which the rotation of `tile` was computed.
    pub rotation: Option<Rotation>,
    /// The tile, in millimetres and tesla. With a recoil permeability above 1 its polarization is
    /// that without a field, J_r.
    pub tile: Tile,
    /// Its recoil permeability. `None` for the permeability of the material.
    pub permeability: Option<Permeability>,
    /// The disc of which it is a strip. Its strips share it.
    pub disc: Option<Arc<WholeDisc>>,
}

/// A disc that is computed as strips, which move and change together.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeDisc {
    /// Name, unique within the layout.
    pub name: String,
    /// Diameter.
    pub diameter_mm: f64,
    /// Height.
    pub height_mm: f64,
}

impl NamedTile {
    /// A tile of no kind with the permeability of the material. Its rotation is written as a
    /// quaternion.
    pub fn new(name: impl Into<String>, tile: Tile) -> NamedTile {
        let is_turned = tile.rotation() != DQuat::IDENTITY;
        let rotation = is_turned.then(|| Rotation::Quaternion(tile.rotation().to_array()).checked().ok()).flatten();
        NamedTile { name: name.into(), kind: None, rotation, tile, permeability: None, disc: None }
    }
}
