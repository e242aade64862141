//! The figures of the sensor of a film, with their captions.

use magsplice::results::EXPERIMENT_STEP_MM;
use magsplice::{Film, Stage};

use crate::error::{DrawError, ReportError};
use crate::figure_drafts::FigureDraft;
use crate::figures::experiment;
use crate::figures::resolution::ResolutionMaps;
use crate::shared_ranges::SharedRanges;
use crate::survey::Survey;

/// The figures of the sensor: none if the layout states neither a sensor nor an elastic layer.
pub(crate) fn sensor_drafts(
    film: &Film,
    survey: &Survey,
    ranges: &SharedRanges,
) -> Result<Vec<FigureDraft>, ReportError> {
    let layout = film.layout();
    let mut drafts = Vec::new();
    if layout.sensor.is_none() && layout.elastomer.is_none() {
        return Ok(drafts);
    }
    film.tell(Stage::uncounted("drawing the sensor"));
    let mut add = |name: &'static str, caption: String, drawn: Result<(String, String), DrawError>| {
        let (svg, csv) = drawn.map_err(|source| ReportError::Drawing { figure: name, source })?;
        drafts.push(FigureDraft { name, caption, svg, csv });
        Ok::<(), ReportError>(())
    };
    let heights_mm: Vec<f64> =
        survey.z_planes().into_iter().map(|plane| survey.volume.grid.coordinate(2, plane)).collect();
    if let Some(maps) = ResolutionMaps::new(film, survey.volume, &heights_mm)? {
        let caption = "Resolution: the standard deviation of the displacement along x, y and z that the noise of the \
                       sensor and its counts cause, by the field of the layout. No unbiased estimate from one reading \
                       has a smaller one. Grey: beyond the range of the sensor."
            .to_owned();
        add("resolution", caption, maps.draw(ranges).map(|svg| (svg, maps.csv())))?;
    }
    let experiments = film.experiments(EXPERIMENT_STEP_MM, None, None)?;
    let drawn = experiment::draw(&experiments).map(|svg| (svg, experiment::csv(&experiments)));
    add("experiment", experiment::caption(&experiments), drawn)?;
    Ok(drafts)
}
