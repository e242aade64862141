//! Layout files of spliced magnet films: TOML to tiles and back.
//!
//! Each table of the file has a file of its own here, with its keys, its rules and the way back to
//! text. `file` holds them all: it checks a document against the JSON Schema of the types, resolves
//! its tables into a [`Layout`] only if no rule is broken, and writes a layout as text again.
//! docs/layout-format.md describes every key.
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

/// Tolerances of a field as people write them.
mod accuracy;
/// Layouts whose tiles are moved, turned, selected or joined.
mod assembled;
/// `[design]`: what a search may change, and its goal.
mod brief;
/// Decimal numbers with a unit.
pub mod decimal;
/// Errors of discs.
mod disc_errors;
/// `[elastomer]`: the elastic layer between film and sensor.
mod elastomer;
/// Errors of reading a layout.
mod error;
/// Units of errors, and what no error exceeds.
mod error_unit;
/// `[expect]`: requirements on a film.
mod expectations;
/// The list of broken rules, with lines.
mod faults;
/// The layout file as a whole.
mod file;
/// Files beside a layout.
mod files;
/// Properties that are allowed but usually a mistake.
mod finding;
/// Findings about tiles, and about lengths beside each other.
mod findings;
/// A hash of what determines samples.
mod fingerprint;
/// The keys of one Hall sensor.
mod hall_keys;
/// Several Hall sensors read as one.
mod head;
/// `[ideal]`: the sinusoidal film to compare with.
mod ideal;
/// The checked layout: tiles, ideal film, working volume.
mod layout;
/// The format version, and counts and lengths above which a file is refused.
mod limits;
/// Layouts of films that were made.
mod made_tiles;
/// `[material]`: the material of the tiles.
mod material;
/// Memory that work takes, asked for before it is taken.
mod memory;
/// Rules for names.
mod names;
/// One number for all axes, or three.
mod one_or_three;
/// The bill of materials.
mod parts;
/// Where the tables of a text begin.
mod places;
/// `[[plane]]`: flat iron near the film.
mod plane;
/// Magnitudes that no magnet and no film has.
mod plausible;
/// Rotations in every form of the file.
mod rotation;
/// `[sensor]`: the sensor below the film.
mod sensor;
/// Parts of sensors, with their settings.
mod sensor_part;
/// The rule that tables come with the tables they need.
mod tables_present;
/// `[[tile]]`, `[kind.NAME]` and `[[lattice]]`.
mod tile;
/// `[tolerance]`: the differences of a film as made from its layout.
mod tolerance;
/// Degrees to quaternions and directions, and the units that keys state.
mod units;
/// `[volume]`: the region in which the sensor moves.
mod volume;
/// Values that a file has in another form than memory.
mod written_as;

pub use accuracy::{FLUX_DENSITY_UNITS, relative_tolerance, tolerance_of_text};
pub use brief::{Brief, Goal, MinMax, Outline, StockPart, Symmetry, Under, Variable};
pub use disc_errors::DiscErrorsFault;
pub use elastomer::Elastomer;
pub use error::{LayoutError, LayoutFault};
pub use expectations::{Expectations, ExpectedField, FigureBounds, MadeExpectations};
pub use file::PlainLayout;
pub use file::edit::TileForm;
pub use file::references::referenced_files;
pub use file::schema::schema;
pub use file::set::{PathStep, TextEdit, TextEditError, document_of, edited_text};
pub use file::text::is_layout;
pub use finding::{Finding, FindingSubject};
pub use head::StatedHead;
pub use layout::{Layout, NamedTile, SourceFile, WholeDisc};
pub use limits::{BYTES_PER_POINT, MAX_NAME_BYTES, SAMPLE_COUNTS};
pub use material::Material;
pub use memory::{MemoryError, check_memory};
pub use names::rearranges_text;
pub use parts::Part;
pub use plausible::{
    MAX_LENGTH_RATIO, SHORTEST_WAVELENGTH_MM, STRONGEST_MAGNET_T, STRONGEST_MATERIAL_T, meant_length,
    meant_polarization,
};
pub use rotation::{EulerOrder, InvalidEulerOrder, ORTHOGONALITY_TOLERANCE, Rotation, RotationFaults};
pub use sensor::StatedSensor;
pub use sensor_part::PartSetting;
pub use tolerance::{
    CommonErrors, Distribution, ErrorGroup, FilmPose, FilmTolerance, NearIron, Neighbour, Preset, SensorErrors,
    StrayField, Temperature, TileErrors,
};
pub use units::{direction_from_degrees, ten_decimals};
pub use volume::WorkingVolume;

/// A layout file with a comment on every key, as `magsplice init` writes it.
pub const COMMENTED_LAYOUT: &str = include_str!("commented.toml");
