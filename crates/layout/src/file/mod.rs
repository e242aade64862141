//! The layout file as a whole: its tables, and how they become a layout and text again.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Table;

use crate::brief::Brief;
use crate::elastomer::Elastomer;
use crate::expectations::Expectations;
use crate::ideal::IdealTable;
use crate::layout::Layout;
use crate::limits::FORMAT;
use crate::material::MaterialTable;
use crate::plane::PlaneTable;
use crate::sensor::SensorTable;
use crate::tile::lattice::LatticeTable;
use crate::tile::single::{KindTable, TileTable};
use crate::tolerance::table::ToleranceTable;
use crate::volume::VolumeTable;

/// A document against the schema.
mod check;
/// A layout to text for people: kinds, mirror images, one line for each tile.
mod compact;
/// A changed layout in the text from which it was read.
pub(crate) mod edit;
/// What the schema requires of a value.
mod form;
/// From the tables of a file to a checked layout.
mod read;
/// The files to which the text of a layout refers.
pub(crate) mod references;
/// The JSON Schema of the layout file.
pub(crate) mod schema;
/// Sentences about values of a wrong type.
mod sentence;
/// Values set in the text of a layout file.
pub(crate) mod set;
/// The text of a layout file.
pub(crate) mod text;
/// Values of a document, for the types that are read from them.
pub(crate) mod values;

// The comments are descriptions in the JSON Schema.
/// A spliced magnet film or any other arrangement of block magnets. Lengths are in mm, polarization
/// is in T.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[schemars(title = "magsplice layout")]
pub(crate) struct LayoutFile {
    /// Version of the format: 1.
    #[schemars(extend("const" = 1, "example" = "1"))]
    format: i64,
    /// Name of the layout.
    #[schemars(extend("example" = "\"my film\""))]
    name: String,
    /// Free text about the layout.
    description: Option<String>,
    /// The steps that led to this layout, one text each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("example" = "[\"designed by hand\"]"))]
    history: Vec<String>,
    /// Depth by which tiles may overlap, in mm: of measured films, and of tables with few decimals.
    /// Default: 0.
    overlap_mm: Option<f64>,
    /// The sinusoidal film to compare with (Dai 2024, Eq. 1). `compare` and `decouple` need it.
    ideal: Option<IdealTable>,
    /// The region in which the field is evaluated. `compare` and `decouple` need it, and so does
    /// `field` without `--points`.
    volume: Option<VolumeTable>,
    /// Requirements on the film, evaluated by `check`.
    expect: Option<Expectations>,
    /// What `design` may change to improve the film, and its goal.
    design: Option<Brief>,
    /// The errors of films as made.
    tolerance: Option<ToleranceTable>,
    /// The sensor below the film.
    sensor: Option<SensorTable>,
    /// The elastic layer between film and sensor.
    elastomer: Option<Elastomer>,
    /// Flat iron near the film.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    plane: Vec<PlaneTable>,
    /// The material of the tiles.
    material: Option<MaterialTable>,
    /// Sizes and strengths by name, shared by all tiles that give this name as their kind.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    kind: BTreeMap<String, KindTable>,
    /// Tiles, each single or repeated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    tile: Vec<TileTable>,
    /// Films cut along lines parallel to x and y.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lattice: Vec<LatticeTable>,
}

/// A layout in the plain form: repetitions written out as one `tile` each. It only serializes, as
/// an object with the keys of a layout file, in their order and without those that are not given;
/// see [`Layout::plain`].
#[derive(Serialize)]
#[serde(transparent)]
pub struct PlainLayout(Table);

impl Layout {
    /// The layout as TOML in the plain form: one `[[tile]]` for each tile. Parsing the text gives
    /// the same tiles, bit for bit.
    ///
    /// # Panics
    /// If the path of the expected field is not UTF-8 or a seed is above `i64::MAX`, which no
    /// layout file can express.
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{COMMENTED_LAYOUT, Layout};
    ///
    /// let layout = Layout::parse(COMMENTED_LAYOUT, "commented")?;
    /// let again = Layout::parse(&layout.to_toml(), "plain form")?;
    /// assert_eq!(again.tiles[55].tile, layout.tiles[55].tile);
    /// # Ok::<(), magsplice_layout::LayoutError>(())
    /// ```
    pub fn to_toml(&self) -> String {
        self.file().to_toml()
    }

    /// The layout in the plain form, to be serialized in any format.
    pub fn plain(&self) -> PlainLayout {
        PlainLayout(self.file().table())
    }

    fn file(&self) -> LayoutFile {
        let names: Vec<&str> = self.tiles.iter().map(|named| named.name.as_str()).collect();
        LayoutFile { tile: self.tiles.iter().map(Into::into).collect(), ..self.without_tiles(&names) }
    }

    /// The layout without tiles. `names` are the names of the tiles in the table of tolerances.
    fn without_tiles(&self, names: &[&str]) -> LayoutFile {
        LayoutFile {
            format: FORMAT,
            name: self.name.clone(),
            description: self.description.clone(),
            history: self.history.clone(),
            overlap_mm: (self.overlap_mm != 0.0).then_some(self.overlap_mm),
            ideal: self.ideal.map(Into::into),
            volume: self.volume.as_ref().map(Into::into),
            expect: (!self.expectations.is_empty()).then(|| self.expectations.clone()),
            design: self.brief.clone(),
            tolerance: self.tolerance.as_ref().map(|tolerance| ToleranceTable::of(tolerance, names)),
            sensor: self.sensor.as_ref().map(Into::into),
            elastomer: self.elastomer,
            plane: self.iron.planes().iter().map(Into::into).collect(),
            material: MaterialTable::of(&self.material),
            ..LayoutFile::default()
        }
    }
}

impl LayoutFile {
    fn to_toml(&self) -> String {
        self.table().to_string()
    }

    fn table(&self) -> Table {
        Table::try_from(self).expect("numbers and strings can always be written as TOML")
    }
}
