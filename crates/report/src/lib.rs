//! Figures of a film and its field, and a page that shows them.
//!
//! The last step before the program: [`Report::of`] takes a prepared [`Film`](magsplice::Film) and the numbers as the program prints them, and gives the
//! figures of Dai 2024 for it as SVG and PNG, and one HTML page that holds everything. plotters draws; colours are readable in print
//! and by the colour-blind; letters are outlines of the one font in `fonts/`, so that a figure is the same everywhere.
//!
//! This crate computes no field and no parameter by itself, and writes no files.

mod arrow;
mod colours;
mod drafts;
mod figure;
mod figures;
mod front;
mod image;
mod page;
mod panel;
mod report;
mod sheet;
mod solid;
mod survey;
mod typeset;
mod units;

pub use figure::Figure;
pub use front::{Axis, Front, FrontFilm};
pub use report::{Numbers, Report, ReportError};
