//! Exact simulation of spliced magnet films, from a layout file to the decoupling error.
//!
//! This crate is the library as a whole. Each module is a crate of its own:
//!
//! * [`magnet`]: tiles, grids, quantities, accuracy.
//! * [`ideal`]: the ideal film, and the comparison of two fields.
//! * [`field`]: the field of tiles, exact or to a tolerance.
//! * [`pair`]: the mean field of one tile in another, and their force and torque.
//! * [`force`]: force and torque of tiles on each other, and the order in which to place them.
//! * [`recoil`]: how the field of the tiles changes their polarization.
//! * [`decouple`]: decoupling parameters and their errors.
//! * [`sensor`]: positions of a sensor from what it reads.
//! * [`layout`]: layout files.
//! * [`tolerance`]: films whose tiles are misplaced, turned and of unequal strength.
//! * [`making`]: which measured tile goes to which place of a film.
//! * [`expect`]: expectations of a layout, compared with computed values.
//! * [`design`]: the search for better films.
//!
//! [`Film`] evaluates one layout step by step. The [`prelude`] holds the types that most programs
//! need.
//!
//! # Units
//! Lengths in millimetres, as in layout files; flux density and polarization in tesla. Without
//! layout files any unit of length will do, because the field depends on ratios of lengths only.
//!
//! # Features
//! * `layout` (on by default): layout files, [`Film`], [`results`], [`expect`], [`tolerance`] and
//!   [`making`].
//!   Without it, no TOML, no SHA-2 and no random numbers are compiled.
//! * `design` (on by default): [`design`]. Without it, no solver of quadratic programs is compiled.
//! * `serde` (with `layout`): `Serialize` for results, `Serialize` and `Deserialize` for values.
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

/// Outcomes of the expectations of a film.
#[cfg(feature = "layout")]
mod expectations;
/// A layout evaluated step by step.
#[cfg(feature = "layout")]
mod film;
/// Why a film could not be evaluated.
#[cfg(feature = "layout")]
mod film_error;
/// The polarization of films with a recoil permeability.
#[cfg(feature = "layout")]
mod film_recoil;
/// Results of films, serializable.
#[cfg(feature = "layout")]
pub mod results;
/// Progress of an evaluation.
#[cfg(feature = "layout")]
mod stage;
/// The number of threads that compute.
#[cfg(feature = "layout")]
pub mod threads;

#[cfg(feature = "layout")]
pub use film::Film;
#[cfg(feature = "layout")]
pub use film_error::FilmError;
#[cfg(feature = "layout")]
pub use film_recoil::{FiguresWithRecoil, FilmRecoil, RecoilEstimate, RecoilSummary};
pub use magsplice_decouple as decouple;
#[cfg(feature = "design")]
pub use magsplice_design as design;
#[cfg(feature = "layout")]
pub use magsplice_expect as expect;
pub use magsplice_field as field;
pub use magsplice_force as force;
pub use magsplice_head as head;
pub use magsplice_ideal as ideal;
#[cfg(feature = "layout")]
pub use magsplice_layout as layout;
pub use magsplice_magnet as magnet;
#[cfg(feature = "layout")]
pub use magsplice_making as making;
pub use magsplice_pair as pair;
pub use magsplice_recoil as recoil;
#[cfg(feature = "layout")]
pub use magsplice_scan as scan;
pub use magsplice_sensor as sensor;
#[cfg(feature = "layout")]
pub use magsplice_tolerance as tolerance;
#[cfg(feature = "layout")]
pub use stage::{Progress, Stage};

/// The types that most programs need.
pub mod prelude {
    #[cfg(feature = "layout")]
    pub use crate::film::Film;
    #[cfg(feature = "layout")]
    pub use crate::film_error::FilmError;
    pub use glam::{DMat3, DQuat, DVec3};
    pub use magsplice_decouple::{Branch, Decoupling, Parameters};
    #[cfg(feature = "design")]
    pub use magsplice_design::{DesignProblem, SearchResult};
    pub use magsplice_field::{FittedField, Scene};
    pub use magsplice_ideal::{Comparison, IdealFilm};
    #[cfg(feature = "layout")]
    pub use magsplice_layout::Layout;
    pub use magsplice_magnet::{Accuracy, Grid, Quantity, Tile, Tolerance};
}

/// The README's example, which is tested with those of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
