//! A layout file at work: its layout, the progress line, the film, and failures.

use std::iter;
use std::path::Path;
use std::sync::Arc;

use magsplice::layout::{FindingSubject, Layout, LayoutError, WorkingVolume};
use magsplice::{Film, FilmError};

use crate::csv_input::table::are_typed;
use crate::failure::{self, Failure};
use crate::output::destination::{self, Output};
#[cfg(feature = "report")]
use crate::output::figure_file::{self, FigureFile};
#[cfg(feature = "report")]
use crate::output::page_file;
use crate::progress::ProgressLine;
use crate::remarks;
use crate::text::recoil::beyond_knee;
use crate::words::film_failure;

/// A working volume that is missing for a verb about sensors.
pub(crate) const OF_SENSORS: &str = " with the region of the sensor: add one; docs/layout-format.md describes it";
/// A working volume that is missing for a verb that takes points from it.
pub(crate) const OF_POINTS: &str = " to take points from: add one, or give --points";

/// A layout file with which a verb works.
pub(crate) struct Session<'p> {
    pub(crate) path: &'p Path,
    pub(crate) layout: Arc<Layout>,
    pub(crate) progress: Arc<ProgressLine>,
    subjects: &'static [FindingSubject],
    quiet: bool,
}

/// Endings of tables, which no layout has.
const OF_TABLES: [&str; 5] = ["csv", "tsv", "txt", "dat", "xlsx"];

/// The failure of a layout that cannot be read. A table in its place is called a table.
fn layout_failure(path: &Path, error: LayoutError) -> Failure {
    let is_table =
        path.extension().is_some_and(|ending| OF_TABLES.iter().any(|table| ending.eq_ignore_ascii_case(table)));
    match error {
        LayoutError::Syntax { .. } if is_table => {
            Failure::at(path, "is a table, must be a layout (TOML), such as film.toml; the layout comes first")
        }
        error => error.into(),
    }
}

impl<'p> Session<'p> {
    /// Reads a layout. Its findings about `subjects` are printed unless `quiet`.
    pub(crate) fn open(
        path: &'p Path,
        subjects: &'static [FindingSubject],
        quiet: bool,
    ) -> Result<Session<'p>, Failure> {
        Session::begin(path, subjects, quiet, ProgressLine::start(!quiet))
    }

    /// The same for a verb with points: no progress line appears between points that a person
    /// types.
    pub(crate) fn open_with_points(
        path: &'p Path,
        points: Option<&Path>,
        subjects: &'static [FindingSubject],
        quiet: bool,
    ) -> Result<Session<'p>, Failure> {
        Session::begin(path, subjects, quiet, ProgressLine::start(!quiet && !are_typed(points)))
    }

    /// The same with a progress line that has begun.
    pub(crate) fn begin(
        path: &'p Path,
        subjects: &'static [FindingSubject],
        quiet: bool,
        progress: Arc<ProgressLine>,
    ) -> Result<Session<'p>, Failure> {
        let layout = Arc::new(Layout::read(path).map_err(|error| layout_failure(path, error))?);
        if !quiet {
            progress.suspend(|| remarks::tell(path, &layout, subjects));
        }
        Ok(Session { path, layout, progress, subjects, quiet })
    }

    /// A layout that was read, and of which no finding is printed.
    pub(crate) fn of(path: &'p Path, layout: Layout, progress: Arc<ProgressLine>, quiet: bool) -> Session<'p> {
        Session { path, layout: Arc::new(layout), progress, subjects: &[], quiet }
    }

    /// The film, with the polarization of its tiles solved if they have a recoil permeability.
    /// Warns of cells beyond the knee of the material.
    pub(crate) fn film(&self) -> Result<Film, Failure> {
        let film = Film::with_progress(self.layout.clone(), self.progress.clone());
        let film = film.map_err(|error| self.failed(error))?;
        if let Some(found) = film.recoil().and_then(|recoil| beyond_knee(recoil, &self.layout)) {
            self.tell(&format!("warning: {}: {found}", self.path.display()));
        }
        Ok(film)
    }

    /// Refuses a layout without an ideal film, or if it is needed, without a working volume.
    /// `purpose` is what `verb` is for.
    pub(crate) fn require_film(&self, needs_volume: bool, verb: &str, purpose: &str) -> Result<(), Failure> {
        let missing = match (&self.layout.ideal, &self.layout.volume) {
            (None, _) => "ideal",
            (_, None) if needs_volume => "volume",
            _ => return Ok(()),
        };
        let path = self.path.display();
        Err(Failure::at(
            self.path,
            format_args!(
                "the layout has no [{missing}] table, which this needs: `magsplice {verb}` {purpose}. For the field of \
                 any arrangement of magnets use `magsplice field {path}`. For a film, add [{missing}]; \
                 docs/layout-format.md describes it"
            ),
        ))
    }

    /// The working volume. `use_of_volume` is one of the constants of this file.
    pub(crate) fn volume(&self, use_of_volume: &str) -> Result<&WorkingVolume, Failure> {
        let missing = || Failure::at(self.path, format_args!("the layout has no [volume] table{use_of_volume}"));
        self.layout.volume.as_ref().ok_or_else(missing)
    }

    /// The failure of the film: points without a field one by one, with the names of tiles.
    pub(crate) fn failed(&self, error: FilmError) -> Failure {
        film_failure(self.path, &self.layout, error)
    }

    /// The failure of a verb that needs the noise of readings. `option` would give it.
    pub(crate) fn no_noise(&self, option: &str) -> Failure {
        let message = format_args!("the layout has no noise: give {option}, or noise_ut or part in [sensor]");
        Failure::at(self.path, message)
    }

    /// Prints a remark on standard error, unless remarks are unwanted.
    pub(crate) fn tell(&self, remark: &str) {
        if !self.quiet {
            self.progress.suspend(|| failure::tell(&remark));
        }
    }

    /// Opens the destination of a result, which must not replace the layout or another input.
    pub(crate) fn output<'a>(
        &'a self,
        path: Option<&Path>,
        inputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<Output, Failure> {
        let inputs: Vec<&Path> = iter::once(self.path).chain(inputs).collect();
        Output::open(path, &inputs)
    }

    /// Opens the file of a figure in the same way.
    #[cfg(feature = "report")]
    pub(crate) fn figure<'a>(
        &'a self,
        path: Option<&Path>,
        inputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<Option<FigureFile>, Failure> {
        let inputs: Vec<&Path> = iter::once(self.path).chain(inputs).collect();
        figure_file::open(path, &inputs)
    }

    /// Opens the file of a page in the same way.
    #[cfg(feature = "report")]
    pub(crate) fn page<'a>(
        &'a self,
        path: Option<&Path>,
        inputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<Option<Output>, Failure> {
        let inputs: Vec<&Path> = iter::once(self.path).chain(inputs).collect();
        page_file::open(path, &inputs)
    }

    /// Prints a text on standard output. The work is done.
    pub(crate) fn print(&self, text: &str) -> Result<(), Failure> {
        self.progress.end();
        destination::print(text)
    }

    /// Writes a text to its destination. The work is done.
    pub(crate) fn write(&self, output: Output, text: &str) -> Result<(), Failure> {
        self.progress.end();
        output.complete(text)
    }

    /// Prints the number of the findings that were printed before a long result.
    pub(crate) fn recall(&self) {
        remarks::recall(&self.layout, self.subjects, self.quiet);
    }
}
