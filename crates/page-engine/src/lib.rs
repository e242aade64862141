//! The evaluation of a layout in a page.
//!
//! The module has one buffer. A page reserves room for a request ([`buffer::reserve`]), writes JSON
//! there, calls [`buffer::answer`], and reads JSON from [`buffer::address`]. Requests are
//! [`Request`], answers are `{"ok": ...}` or `{"error": "..."}`. Nothing else crosses the border:
//! the module imports nothing.
//!
//! The numbers are results of the crate `magsplice`, serialized as by the program.

/// The buffer, and the functions that a page calls.
pub mod buffer;
/// The numbers of a film, and maps of them.
mod evaluated;
/// Changed tiles, written into the text of their layout.
mod keep;
/// The files beside a layout that its session may read.
mod readable_files;
/// What a page asks for.
mod request;
/// A layout that is edited and evaluated.
mod session;
#[cfg(test)]
mod session_tests;
/// A layout as a page shows it.
mod state;

pub use readable_files::ReadableFiles;
pub use request::{MapQuantity, Request, TileEdit};
pub use session::{Observer, Session};
