//! Figures and pages.

use magsplice::layout::Layout;
use magsplice::making::Sorting;
use magsplice::results::SampleRun;
use magsplice_live_page::{LivePage, PageEngine, built_in_engine};
use magsplice_report::{Drawing, FilmSamples, Report, ReportInput, SvgText};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::check::{Held, expectations, known};
use crate::exceptions::{failed, of_film};
use crate::film::Film;
use crate::samples::errors_of;
use crate::scene::{Within, accuracy};
use crate::threads::detached;

/// A figure: name, caption, SVG, PNG and CSV.
type Figure<'py> = (&'static str, String, String, Bound<'py, PyBytes>, String);

/// The figures of a film, the page that shows them by itself and beside their files, and the
/// missing parts of the report. `json` are the results for the page.
#[pyfunction]
#[pyo3(signature = (film, json, outlines, within, baseline=None))]
pub(crate) fn report<'py>(
    py: Python<'py>,
    film: &Film,
    json: String,
    outlines: bool,
    within: Within,
    baseline: Option<Held<'py>>,
) -> PyResult<(Vec<Figure<'py>>, [String; 2], Vec<String>)> {
    let layout = &*film.layout;
    let evaluated = film.evaluated(py)?.clone().with_accuracy(accuracy(within)?);
    let samples = match layout {
        Layout { tolerance: Some(tolerance), ideal: Some(_), volume: Some(_), .. } => {
            let sampling = evaluated.sampling().map_err(of_film)?;
            let errors = errors_of(py, &sampling, tolerance.seed, 0..tolerance.samples, None, &|_| Ok(()))?;
            let film = layout.sample_fingerprint(&None::<Sorting>);
            let run = SampleRun { film, seed: tolerance.seed, first: 0, count: tolerance.samples };
            let found = detached(py, || sampling.statistics(run, None, &errors))?.map_err(of_film)?;
            Some(FilmSamples { found, errors })
        }
        _ => None,
    };
    let baseline = known(baseline)?;
    let made = samples.as_ref().map_or(&[][..], |samples| &samples.errors);
    let expectations = detached(py, || expectations(&evaluated, &baseline, made))?;
    let input = ReportInput { samples, expectations, json, live_page: None };
    let svg = if outlines { SvgText::Outlines } else { SvgText::Text };
    let report = detached(py, || Report::new(&evaluated, &input, svg))?;
    let Report { figures, html, html_in_folder, absent, .. } = report.map_err(failed)?;
    Ok((figures.into_iter().map(|drawn| figure(py, drawn)).collect(), [html, html_in_folder], absent))
}

fn figure(py: Python<'_>, Drawing { name, caption, svg, png, csv, .. }: Drawing) -> Figure<'_> {
    (name, caption, svg, PyBytes::new(py, &png), csv)
}

/// The tiles from above.
#[pyfunction]
pub(crate) fn layout_figure<'py>(py: Python<'py>, film: &Film) -> PyResult<Figure<'py>> {
    let drawn = detached(py, || magsplice_report::layout_figure(&film.layout, SvgText::Text))?;
    Ok(figure(py, drawn.map_err(failed)?))
}

/// The figures of the ideal film of a layout.
#[pyfunction]
pub(crate) fn ideal_film_figures<'py>(py: Python<'py>, film: &Film) -> PyResult<Vec<Figure<'py>>> {
    let evaluated = film.evaluated(py)?;
    let drawn = detached(py, || magsplice_report::ideal_film_figures(evaluated))?;
    Ok(drawn.map_err(failed)?.into_iter().map(|drawn| figure(py, drawn)).collect())
}

/// The page with the tiles alone: their picture, and a rotatable view.
#[pyfunction]
pub(crate) fn view(py: Python<'_>, film: &Film) -> PyResult<String> {
    detached(py, || {
        let layout = Layout { volume: None, ideal: None, tolerance: None, sensor: None, ..Layout::clone(&film.layout) };
        let film = magsplice::Film::rigid(layout);
        Report::new(&film, &ReportInput::default(), SvgText::Outlines).map(|report| report.html).map_err(failed)
    })?
}

/// The live page of a film, with the engine of the package or the module that is given, compressed
/// by xz. `None` without an engine.
#[pyfunction]
#[pyo3(signature = (film, text, engine=None))]
pub(crate) fn live_page(film: &Film, text: &str, engine: Option<Vec<u8>>) -> Option<String> {
    let engine = engine.or_else(|| built_in_engine().map(<[u8]>::to_vec))?;
    let name = format!("{}.toml", film.layout.name);
    Some(magsplice_live_page::live_page(&LivePage { name: &name, text, engine: PageEngine::Module(&engine) }))
}

/// The tiles from above as SVG, with text as outlines.
#[pyfunction]
pub(crate) fn layout_svg(py: Python<'_>, film: &Film) -> PyResult<String> {
    detached(py, || {
        magsplice_report::layout_figure(&film.layout, SvgText::Outlines).map(|figure| figure.svg).map_err(failed)
    })?
}
