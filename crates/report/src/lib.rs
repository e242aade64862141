//! Figures of a film and its field, and an HTML page that shows them.
//!
//! [`Report::new`] takes a prepared [`Film`](magsplice::Film), and films as made and checked
//! expectations if there are any. It returns the figures of Dai 2024 for this film as SVG and PNG,
//! and one HTML page that contains everything. [`front_figures`] draws the trade-offs that a design
//! search found.
//!
//! plotters draws the figures. Their colours are readable in print and by colour-blind readers.
//! Text of SVG files is text or outlines ([`SvgText`]). In PNG files and on the page it is drawn
//! with the font in `fonts/`, so that a figure looks the same on every machine.
//!
//! This crate computes no field and no decoupling parameter by itself: [`Film`](magsplice::Film)
//! does. It writes no files.

/// Colour scales for values, and colours for directions.
mod colours;
/// The data behind figures as CSV.
mod csv;
/// [`Drawing`]: SVG, PNG and CSV.
mod drawing;
/// [`ReportError`].
mod error;
/// All figures of a report in order, before text becomes outlines.
mod figure_drafts;
/// One file per kind of figure.
mod figures;
/// [`ReportInput`], and all numbers of a film.
mod film_results;
/// Units of flux density (T, mT, uT, nT) in which numbers have few digits.
mod flux_unit;
/// Parts of pages.
mod html;
/// Arrows, corner brackets and dots and crosses, drawn in several figures.
mod marks;
/// The numbers of films as tables.
mod number_tables;
/// The page of one film.
mod page;
/// The data on the page that its scripts draw: tiles, maps, colours.
mod page_data;
/// [`PairReport`]: two films side by side.
mod pair;
/// A rectangle with axes on a sheet, and its colour bar.
mod panel;
/// Figures as PDF.
mod pdf;
/// [`print_figure`]: one figure of a given width.
mod print;
/// Pages to print: bill of materials, placement plan.
mod printed_film;
/// A page to print: a figure and tables.
mod printed_page;
/// Images made of pixels inside a figure, and data URLs.
mod raster_image;
/// [`Report`].
mod report;
/// Planes through a scan, measured beside simulated.
mod scan_planes;
/// Ranges of axes and colours that two films share.
mod shared_ranges;
/// A drawing area in pixels with lines, polygons and text, written as SVG.
mod sheet;
/// The numbers to draw: the field, the ideal film and the decoupling parameters.
mod survey;
/// Outlines of tiles from above and in section.
mod tile_shapes;
/// Symbols with subscripts, numbers on axes, and the font.
mod typeset;
/// The verdict and the most important numbers of a film.
mod verdict;

pub use colours::tile_colours;
pub use drawing::{Drawing, SvgText};
pub use error::ReportError;
pub use figures::budget::budget_figure;
pub use figures::diagnosis::diagnosis_figure;
pub use figures::experiment::experiment_figure;
pub use figures::forces::forces_figure;
pub use figures::front::front_figures;
pub use figures::ideal_film::ideal_film_figures;
pub use figures::layout_from_above::layout_figure;
pub use figures::placement_plan::placement_plan_figure;
pub use figures::scan_maps::scan_figures;
pub use film_results::{FilmSamples, ReportInput};
pub use pair::PairReport;
pub use print::{Print, print_figure};
pub use printed_film::{bill_page, parts_figure, plan_page};
pub use report::Report;
pub use tile_shapes::from_above as tile_outline;
