//! The extension module of the Python package `magsplice`: conversions between Python and the
//! library.
//!
//! The package in `python/magsplice` is the public part. It passes contiguous arrays of doubles to
//! this module and converts results to classes. This module views arrays in place, releases the
//! interpreter during work, and polls for signals.

// Methods of a Python class take `&self` and values as Python passes them.
#![allow(clippy::needless_pass_by_value)]

/// Films moved, turned, selected and joined.
mod assembly;
/// The assignment of measured tiles to places.
mod assignment;
/// The displacement error of films as made, split into its causes.
mod budget;
/// Expectations of a film.
mod check;
/// Faulty tiles of a film as made.
mod diagnosis;
/// Numbers of a film: comparison and decoupling.
mod evaluation;
/// Python exceptions for the errors of the library.
mod exceptions;
/// Experiments that move the film.
mod experiment;
/// The film for the workshop and for firmware.
mod export;
/// A layout with its prepared tiles.
mod film;
/// Forces of tiles on each other.
mod forces;
/// Ctrl-C during work.
mod interruption;
/// The program `magsplice`.
mod program;
/// Positions and forces from readings.
mod readings;
/// The effect of recoil in a film.
mod recoil;
/// Figures and pages.
mod report;
/// Results of the library as dictionaries.
mod results;
/// Samples of films as made.
mod samples;
/// Measured and computed scans.
mod scan;
/// Tiles prepared for evaluation.
mod scene;
/// Searches for films.
mod search;
/// The threads of the library's work, also in forked processes.
mod threads;
/// NumPy arrays viewed as vectors.
mod vectors;

/// The extension module of the package magsplice.
#[pyo3::pymodule]
mod _magsplice {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::assembly::{joined, moved, rotated, selected};
    #[pymodule_export]
    use crate::assignment::assign;
    #[pymodule_export]
    use crate::budget::budget;
    #[pymodule_export]
    use crate::check::check;
    #[pymodule_export]
    use crate::diagnosis::diagnose;
    #[pymodule_export]
    use crate::evaluation::{compare, decouple};
    #[pymodule_export]
    use crate::experiment::experiment;
    #[pymodule_export]
    use crate::export::{c_header, parts};
    #[pymodule_export]
    use crate::film::{Film, layout_text};
    #[pymodule_export]
    use crate::forces::forces;
    #[pymodule_export]
    use crate::program::run_program;
    #[pymodule_export]
    use crate::readings::{calibrate, read, remark_on_range, resolution};
    #[pymodule_export]
    use crate::recoil::{recoil, recoil_estimate};
    #[pymodule_export]
    use crate::report::{ideal_film_figures, layout_figure, layout_svg, live_page, report, view};
    #[pymodule_export]
    use crate::samples::{sampled, samples, statistics};
    #[pymodule_export]
    use crate::scan::{sample, scan};
    #[pymodule_export]
    use crate::scene::{Scene, grid_axes};
    #[pymodule_export]
    use crate::search::{design, pattern};

    #[pymodule_export]
    use crate::vectors::shifted;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::threads::watch_forks(module)
    }

    /// Version of the library.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "the name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
