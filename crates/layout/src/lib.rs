//! Layout files of spliced magnet films: TOML to tiles and back.
//!
//! A file is read into `tables`, types that mirror it key by key. The rules in `read` check the
//! tables as a whole, and only then do they become a [`Layout`]. `write` turns a layout into tables
//! and text again. docs/layout-format.md describes every key.
//!
//! This is the only crate of magsplice that knows TOML, and the only one that fixes a unit of
//! length: millimetres. It computes no field.
//!
//! # Example
//! ```
//! use magsplice_layout::Layout;
//!
//! let text = r#"
//!     format = 1
//!     name = "two tiles"
//!     [[tile]]
//!     position_mm = [-2.0, 0.0, 0.5]
//!     size_mm = [3.3, 1.7, 1.0]
//!     polarization_t = [0.12, 0.0, 0.0]
//!     mirror = { axes = ["x"] }
//! "#;
//! let layout = Layout::parse(text, "example")?;
//! assert_eq!(layout.tiles.len(), 2);
//! assert_eq!(layout.tiles[1].tile.polarization_t().x, -0.12);
//! # Ok::<(), magsplice_layout::LayoutError>(())
//! ```

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// The design brief: what a search may change, and its goal.
mod brief;
/// A layout to text for people: kinds, mirror images, one line for each tile.
mod compact;
/// Distributions of errors.
mod distribution;
/// The text of a layout file, against the schema.
mod document;
/// A layout in the text from which it was read.
mod edit;
/// Errors of reading a layout.
mod error;
/// Units of errors, and what no error exceeds.
mod error_unit;
/// Requirements on a film.
mod expectations;
/// Properties that are allowed but usually a mistake.
mod finding;
/// A hash of what determines samples.
mod fingerprint;
/// The checked layout: tiles, ideal film, working volume.
mod layout;
/// The format version, and counts and lengths above which a file is refused.
mod limits;
/// Layouts of films that were made.
mod made_tiles;
/// The material of the tiles.
mod material;
/// The bill of materials.
mod parts;
/// Magnitudes that no magnet and no film has.
mod plausible;
/// Usual errors of tiles.
mod presets;
/// Text to tables to a checked layout: every rule for files.
mod read;
/// Rotations in every form of the file.
mod rotation;
/// The JSON Schema of the layout file.
mod schema;
/// The sensor and the elastic layer.
mod sensor;
/// The TOML tables as written.
mod tables;
/// What a film that is made differs by from its layout.
mod tolerance;
/// Degrees to quaternions and directions, and why lengths need no conversion.
mod units;
/// A layout to tables and text.
mod write;
/// Material and permeabilities to their tables.
mod write_material;
/// Sensor and elastic layer to their tables.
mod write_sensor;
/// Tolerances to their table.
mod write_tolerance;

pub use brief::{Brief, Goal, StockPart, Symmetry, Under, Variables};
pub use distribution::Distribution;
pub use document::is_layout;
pub use edit::TileForm;
pub use error::{LayoutError, LayoutFault};
pub use expectations::{Expectations, ExpectedField, FigureBounds, MadeExpectations};
pub use finding::{Finding, FindingSubject};
pub use layout::{Layout, NamedTile, SourceFile, WorkingVolume};
pub use limits::{MAX_NAME_BYTES, SAMPLE_COUNTS};
pub use material::Material;
pub use parts::Part;
pub use plausible::{
    MAX_LENGTH_RATIO, SHORTEST_WAVELENGTH_MM, STRONGEST_MAGNET_T, STRONGEST_MATERIAL_T, meant_length,
    meant_polarization,
};
pub use presets::Preset;
pub use rotation::{EulerOrder, InvalidEulerOrder, ORTHOGONALITY_TOLERANCE, Rotation, RotationFault, RotationFaults};
pub use schema::schema;
pub use sensor::{Elastomer, StatedSensor};
pub use tolerance::{
    CommonErrors, ErrorGroup, FilmPose, FilmTolerance, Neighbour, SensorErrors, StrayField, Temperature, TileErrors,
};
pub use units::{direction_from_degrees, ten_decimals};
pub use write::PlainLayout;

/// A layout file with a comment on every key, as `magsplice init` writes it.
pub const COMMENTED_LAYOUT: &str = include_str!("commented.toml");
