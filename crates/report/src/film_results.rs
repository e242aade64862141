//! All that the page of a film shows besides its figures.

use magsplice::decouple::Figures;
use magsplice::layout::NamedTile;
use magsplice::results::{CheckedExpectation, FilmEvaluation, FilmResolution, ResolutionSummary, SampledFilm};
use magsplice::{Film, FilmError};

use crate::error::ReportError;
use crate::page_data::page_grid;
use crate::survey::{GridField, Survey, tiles_to_draw};

/// What a report shows of a film beside what it computes itself.
#[derive(Clone, Debug, Default)]
pub struct ReportInput {
    /// Films as made, if the layout states errors.
    pub samples: Option<FilmSamples>,
    /// The expectations of the layout that were checked.
    pub expectations: Vec<CheckedExpectation>,
    /// The results as a JSON object, contained in the page for programs.
    pub json: String,
    /// The live page of the film, which a report in a folder has beside its own.
    pub live_page: Option<String>,
}

/// Samples of films as made.
#[derive(Clone, Debug)]
pub struct FilmSamples {
    /// Their statistics, and the film as it was ordered.
    pub found: SampledFilm,
    /// The errors of each sample.
    pub errors: Vec<Figures>,
}

/// A film with its numbers.
pub(crate) struct FilmResults<'a> {
    pub(crate) film: &'a Film,
    pub(crate) input: &'a ReportInput,
    /// The tiles that are drawn.
    pub(crate) tiles: Vec<&'a NamedTile>,
    /// `None` without a working volume.
    pub(crate) survey: Option<Survey<'a>>,
    /// The field at the points of the map on the page.
    pub(crate) page_field: Option<GridField>,
    /// `None` without an ideal film or a working volume.
    pub(crate) evaluation: Option<FilmEvaluation>,
    /// `None` without noise of a sensor.
    pub(crate) resolution: Option<FilmResolution>,
    /// What the report lacks, and why.
    pub(crate) absent: Vec<String>,
}

impl<'a> FilmResults<'a> {
    pub(crate) fn new(film: &'a Film, input: &'a ReportInput) -> Result<FilmResults<'a>, ReportError> {
        let survey = Survey::new(film)?;
        let evaluation = if film.ideal().is_ok() && survey.is_some() { Some(film.evaluate()?) } else { None };
        let page_field =
            survey.as_ref().map(|survey| GridField::new(film, page_grid(&survey.volume.grid))).transpose()?;
        Ok(FilmResults {
            page_field,
            film,
            input,
            tiles: tiles_to_draw(film.layout()),
            resolution: resolution(film)?,
            survey,
            evaluation,
            absent: absent(film),
        })
    }

    /// The deviations by the field of the layout. `None` also where no displacement is resolved.
    pub(crate) fn resolution_mm(&self) -> Option<ResolutionSummary> {
        let found = self.resolution.as_ref()?;
        found.summary(&found.by_field_mm)
    }
}

/// The resolution of the sensor; `None` if the layout states none with noise.
fn resolution(film: &Film) -> Result<Option<FilmResolution>, FilmError> {
    if film.volume().is_err() || film.layout().sensor.is_none() {
        return Ok(None);
    }
    match film.resolution(None) {
        Ok(found) => Ok(Some(found)),
        Err(FilmError::NoNoise) => Ok(None),
        Err(error) => Err(error),
    }
}

/// What the report of a film lacks, and why.
fn absent(film: &Film) -> Vec<String> {
    let without_volume = "no field and no decoupling: the layout has no [volume] table";
    let without_ideal =
        "no comparison and no decoupling: the layout has no [ideal] table that describes the ideal film";
    let absent = [(film.volume().is_err(), without_volume), (film.ideal().is_err(), without_ideal)];
    absent.into_iter().filter(|(is_absent, _)| *is_absent).map(|(_, what)| what.to_owned()).collect()
}
