//! One figure for print: of a given width, with text that is readable at it.

use magsplice::Film;

use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::ReportError;
use crate::figure_drafts::drafts;
use crate::figures::layout_from_above;
use crate::film_results::{FilmResults, ReportInput};
use crate::panel::NUMBERS_PX;
use crate::shared_ranges::SharedRanges;
use crate::sheet::{HEADING_PX, PX_PER_MM};

const POINTS_PER_PX: f64 = 72.0 / 96.0;
/// Sizes of text in print, in points: numbers are at least as large as the first, and names at most
/// as large as the second.
const LETTERS_PT: [f64; 2] = [7.0, 9.0];

/// What is printed of a figure.
#[derive(Clone, Copy, Debug, Default)]
pub struct Print {
    /// Width in millimetres. `None` for the width of the report.
    pub width_mm: Option<f64>,
    /// One component of the maps, 0 to 2 for x, y, z: its maps are below each other. `None` for the
    /// whole figure.
    pub component: Option<usize>,
}

/// One figure of the report of a film, for print.
///
/// # Errors
/// As [`Report::new`](crate::Report::new), and
/// - [`ReportError::NoFigure`] if the report of the film has no figure of this name.
/// - [`ReportError::NoComponents`] if the figure has no maps of components.
/// - [`ReportError::Width`] if its text would be smaller than 7 pt or larger than 9 pt.
pub fn print_figure(
    film: &Film,
    input: &ReportInput,
    name: &str,
    print: Print,
    text: SvgText,
) -> Result<Drawing, ReportError> {
    let all = drafts(&FilmResults::new(film, input)?, &SharedRanges::default())?;
    let names: Vec<&str> = all.iter().map(|draft| draft.name).collect();
    let missing = ReportError::NoFigure { name: name.to_owned(), names: names.join(", ") };
    let mut draft = all.into_iter().find(|draft| draft.name == name).ok_or(missing)?;
    if let Some(component) = print.component {
        let Some(maps) = draft.maps.take() else { return Err(ReportError::NoComponents { figure: draft.name }) };
        // A sheet on which text has the middle of its sizes in print.
        let [least, most] = scales();
        let usual_mm = 0.5 * (least + most) * WIDTH_OF_A_COLUMN_PX / PX_PER_MM;
        let width_px = print.width_mm.unwrap_or(usual_mm) * PX_PER_MM / (0.5 * (least + most));
        if width_px < LEAST_COLUMN_PX {
            let least_mm = LEAST_COLUMN_PX * least / PX_PER_MM;
            return Err(width(&draft, print.width_mm.unwrap_or(usual_mm), [least_mm, f64::INFINITY]));
        }
        draft = FigureDraft::of_maps(draft.name, draft.caption, maps.stacked(component, width_px), draft.csv)?;
    }
    let Some(width_mm) = print.width_mm else { return draft.rendered(text) };
    let [least, most] = scales();
    let natural_mm = draft.width_px()? / PX_PER_MM;
    let width_px = width_mm * PX_PER_MM / (0.5 * (least + most));
    if draft.name == layout_from_above::NAME && width_mm < least * natural_mm && width_px >= LEAST_COLUMN_PX {
        let column = layout_from_above::in_column(film.layout(), width_px)?;
        return column.scaled(text, width_mm * PX_PER_MM / width_px);
    }
    let scale = width_mm / natural_mm;
    if !(least - 1e-3..=most + 1e-3).contains(&scale) {
        let narrowest_mm = if draft.name == layout_from_above::NAME {
            LEAST_COLUMN_PX * 0.5 * (least + most) / PX_PER_MM
        } else {
            least * natural_mm
        };
        return Err(width(&draft, width_mm, [narrowest_mm, most * natural_mm]));
    }
    draft.scaled(text, scale)
}

/// Width of a sheet with a column of maps where none is stated, and the least, in pixels.
const WIDTH_OF_A_COLUMN_PX: f64 = 400.0;
const LEAST_COLUMN_PX: f64 = 300.0;

/// The least and the largest scale at which text has its size in print.
fn scales() -> [f64; 2] {
    [LETTERS_PT[0] / (POINTS_PER_PX * NUMBERS_PX), LETTERS_PT[1] / (POINTS_PER_PX * HEADING_PX)]
}

fn width(draft: &FigureDraft, width_mm: f64, [least, most]: [f64; 2]) -> ReportError {
    let at_most = if most.is_finite() { format!(" to {:.0}", most.floor()) } else { " or more".to_owned() };
    let component = if draft.maps.is_some() { ", or one component, which fits a column" } else { "" };
    let instead = format!("{:.0}{at_most} mm{component}", least.ceil());
    ReportError::Width { figure: draft.name, width_mm, instead }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_in_print_has_7_to_9_points() {
        let [least, most] = scales();
        assert!(least < most);
        for scale in [least, most] {
            for px in [NUMBERS_PX, HEADING_PX] {
                let points = scale * px * POINTS_PER_PX;
                assert!((7.0 - 1e-9..=9.0 + 1e-9).contains(&points), "{points}");
            }
        }
    }
}
