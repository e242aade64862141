//! Layout files of spliced magnet films: TOML to tiles and back.
//!
//! The only crate of magsplice that knows TOML, and the only one that fixes a unit of length: millimetres. A file is read into
//! types that mirror it key by key, checked as a whole, and only then becomes a [`Layout`]. docs/layout-format.md describes
//! every key.
//!
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
//! let layout = Layout::parse(text, "example").unwrap();
//! assert_eq!(layout.tiles.len(), 2);
//! assert_eq!(layout.tiles[1].tile.polarization_t().x, -0.12);
//! ```

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod brief;
mod error;
mod expectations;
mod findings;
mod lattice;
mod layout;
mod parts;
mod repeat;
mod resolve;
mod schema;
mod volume;
mod written;

pub use brief::{Brief, Goal, StockPart, Symmetry, Vary};
pub use error::{LayoutError, Problem};
pub use expectations::{Expectations, ExpectedField};
pub use layout::{Layout, NamedTile, Plain, WorkingVolume};
pub use parts::Part;
pub use schema::schema;
pub use written::Rotation;

/// A layout with a comment on every key, to start from.
pub const COMMENTED_LAYOUT: &str = include_str!("commented.toml");
