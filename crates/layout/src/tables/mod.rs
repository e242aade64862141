//! The TOML tables of a layout file as written: every key with its unit, unknown keys refused, no
//! value checked yet.
//!
//! Each table is a type of its own, named after its key. Its doc comments are the descriptions in
//! the JSON Schema that `magsplice schema` prints. A new table is a type here, a field of
//! [`LayoutFile`], a rule file in `read/`, and a function in `write.rs`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use self::design::DesignTable;
use self::expect::ExpectTable;
use self::ideal::IdealTable;
use self::lattice::LatticeTable;
use self::material::MaterialTable;
use self::sensor::{ElastomerTable, SensorTable};
use self::tile::{KindTable, TileTable};
use self::tolerance::ToleranceTable;
use self::volume::VolumeTable;

/// `[design]`: what a search may change, and its goal.
pub(crate) mod design;
/// Distributions of errors in `[tolerance]`.
pub(crate) mod distribution;
/// `[expect]`: bounds and a baseline for the film.
pub(crate) mod expect;
/// `[ideal]`: the sinusoidal film to compare with.
pub(crate) mod ideal;
/// `[[lattice]]`: a film cut along lines parallel to x and y.
pub(crate) mod lattice;
/// `[material]`, and `recoil_permeability` of tiles and kinds.
pub(crate) mod material;
/// `rotation` of a tile.
pub(crate) mod rotation;
/// `[sensor]` and `[elastomer]`: what reads the field, and what the film rides on.
pub(crate) mod sensor;
/// `[[tile]]` with its `grid` and `mirror`, and `[kind.NAME]`.
pub(crate) mod tile;
/// `[tolerance]`: the errors of the films that are made.
pub(crate) mod tolerance;
/// `[volume]`: the region in which the field is evaluated.
pub(crate) mod volume;

/// A spliced magnet film or any other arrangement of block magnets. Lengths are in mm, polarization
/// is in T.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "magsplice layout")]
pub(crate) struct LayoutFile {
    /// Version of the format: 1.
    #[schemars(with = "i64", extend("const" = 1, "example" = "1"))]
    pub(crate) format: Spanned<i64>,
    /// Name of the layout.
    #[schemars(extend("example" = "\"my film\""))]
    pub(crate) name: String,
    /// Free text about the layout.
    pub(crate) description: Option<String>,
    /// The sinusoidal film to compare with (Dai 2024, Eq. 1). `compare` and `decouple` need it.
    #[schemars(with = "Option<IdealTable>")]
    pub(crate) ideal: Option<Spanned<IdealTable>>,
    /// The region in which the field is evaluated. `compare` and `decouple` need it, and so does
    /// `field` without `--points`.
    #[schemars(with = "Option<VolumeTable>")]
    pub(crate) volume: Option<Spanned<VolumeTable>>,
    /// Requirements on the film, evaluated by `check`.
    #[schemars(with = "Option<ExpectTable>")]
    pub(crate) expect: Option<Spanned<ExpectTable>>,
    /// What `design` may change to improve the film, and its goal.
    #[schemars(with = "Option<DesignTable>")]
    pub(crate) design: Option<Spanned<DesignTable>>,
    /// The errors of the films that are made from the layout.
    #[schemars(with = "Option<ToleranceTable>")]
    pub(crate) tolerance: Option<Spanned<ToleranceTable>>,
    /// The sensor below the film.
    #[schemars(with = "Option<SensorTable>")]
    pub(crate) sensor: Option<Spanned<SensorTable>>,
    /// The elastic layer between film and sensor.
    #[schemars(with = "Option<ElastomerTable>")]
    pub(crate) elastomer: Option<Spanned<ElastomerTable>>,
    /// The material of the tiles.
    #[schemars(with = "Option<MaterialTable>")]
    pub(crate) material: Option<Spanned<MaterialTable>>,
    /// The steps that led to this layout, one text each.
    #[serde(default)]
    #[schemars(extend("example" = "[\"designed by hand\"]"))]
    pub(crate) history: Vec<String>,
    /// Depth by which tiles may overlap, in mm: that of films as they were measured. Default: 0.
    pub(crate) overlap_mm: Option<f64>,
    /// Sizes and strengths by name, shared by all tiles that give this name as their kind.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, KindTable>")]
    pub(crate) kind: BTreeMap<String, Spanned<KindTable>>,
    /// Tiles, each single or repeated.
    #[serde(default)]
    #[schemars(with = "Vec<TileTable>")]
    pub(crate) tile: Vec<Spanned<TileTable>>,
    /// Films cut along lines parallel to x and y.
    #[serde(default)]
    #[schemars(with = "Vec<LatticeTable>")]
    pub(crate) lattice: Vec<Spanned<LatticeTable>>,
}
