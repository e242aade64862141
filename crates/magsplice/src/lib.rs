//! Exact simulation of spliced magnet films, from a layout file to the decoupling error.
//!
//! The library as one crate: [`layout`] reads files, [`field`] computes fields and compares them, [`decouple`] judges them, [`expect`] holds them
//! against what the layout states, [`design`] searches for better films, and [`Film`] runs the whole way for one layout. The [`prelude`] holds what most programs need.
//!
//! # Units
//! Lengths in millimetres, as in layout files; flux density and polarization in tesla.
//!
//! # Example
//! ```
//! use magsplice::prelude::*;
//!
//! let text = r#"
//!     format = 1
//!     name = "a pair"
//!     [[tile]]
//!     position_mm = [2.5, 0.0, 0.5]
//!     size_mm = [3.3, 3.3, 1.0]
//!     polarization_t = [0.12, 0.0, 0.0]
//!     mirror = { axes = ["x"] }
//! "#;
//! let layout = Layout::parse(text, "example").unwrap();
//! let scene = Scene::new(&layout.bare_tiles());
//! let b_t = scene.field(Quantity::FluxDensity, DVec3::new(0.0, 0.0, -4.0)).unwrap();
//! assert!(b_t.z > 0.0 && b_t.x.abs() < 1e-18);
//! ```

mod expectations;
mod film;
mod stage;

pub use film::{Film, FilmError};
pub use magsplice_decouple as decouple;
pub use magsplice_design as design;
pub use magsplice_expect as expect;
pub use magsplice_field as field;
pub use magsplice_layout as layout;
pub use stage::Stage;

/// What most programs need.
pub mod prelude {
    pub use crate::film::{Film, FilmError};
    pub use glam::{DMat3, DQuat, DVec3};
    pub use magsplice_decouple::{Branch, Decoupling, Parameters};
    pub use magsplice_field::{Comparison, Grid, IdealFilm, Quantity, Scene, Tile};
    pub use magsplice_layout::Layout;
}
