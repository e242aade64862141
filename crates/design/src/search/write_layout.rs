//! The film found, as a layout.

use glam::DVec3;
use magsplice_decouple::{Figures, PerAxis, PerParameter};
use magsplice_layout::{Expectations, FigureBounds, Layout, MAX_NAME_BYTES, MadeExpectations};
use magsplice_tolerance::Statistics;

use crate::problem::design_problem::DesignProblem;
use crate::search::metrics::Metrics;
use crate::search::search_result::SearchResult;

/// Relative margin of the written expectations above the errors reached, for round-off.
const MARGIN: f64 = 0.01;

/// Relative margin of the written percentiles above the upper ends of their intervals of 95 %.
///
/// The written file may have its tiles in another order, and then its samples differ. The 95th
/// percentile of 1000 samples has a standard error of 1.5 %. Two such estimates differ by more than
/// the interval, this margin and the interval of the check in one of 2000 films.
const MADE_MARGIN: f64 = 0.02;

/// Ending of the names of designed films.
const DESIGNED: &str = ", designed";

impl DesignProblem<'_> {
    /// The layout of a film found, with the errors it reached as expectations and one more line of
    /// history.
    ///
    /// `program` is the program in the history, such as "magsplice 1.0 design". The description and
    /// the baseline of the field are dropped, because they belong to the film before. Tiles whose
    /// strength has become 0 are dropped too.
    pub fn designed_layout(&self, result: &SearchResult, program: &str) -> Layout {
        let start = format!("\"{}\" (sha256 {})", self.layout.name, &self.layout.sha256[..12]);
        self.layout_from(&start, result, program)
    }

    /// [`designed_layout`](DesignProblem::designed_layout) of a film that began as the pattern of
    /// [`SpliceRequest::layout`](crate::SpliceRequest::layout). The history contains this pattern,
    /// because no file has its tiles.
    pub fn spliced_layout(&self, result: &SearchResult, program: &str) -> Layout {
        let start = format!("the start pattern (Dai 2024, Fig. 5) for \"{}\"", self.layout.name);
        // No other film has the name.
        Layout { name: self.layout.name.clone(), ..self.layout_from(&start, result, program) }
    }

    fn layout_from(&self, start: &str, result: &SearchResult, program: &str) -> Layout {
        let spaced = result.spacing_mm.and_then(|spacing_mm| self.layout.with_head_spacing(spacing_mm));
        let mut layout = spaced.unwrap_or_else(|| self.layout.clone().into_owned());
        for (named, tile) in layout.tiles.iter_mut().zip(&result.tiles) {
            (named.tile, named.kind) = (*tile, None);
        }
        let tiles = &result.tiles;
        let is_kept = |index: usize| tiles.get(index).is_none_or(|tile| tile.polarization_t() != DVec3::ZERO);
        if let Some(tolerance) = &mut layout.tolerance {
            tolerance.retain_tiles(is_kept);
        }
        let mut index = 0;
        layout.tiles.retain(|_| {
            index += 1;
            is_kept(index - 1)
        });
        if !layout.name.ends_with(DESIGNED) && layout.name.len() + DESIGNED.len() <= MAX_NAME_BYTES {
            layout.name += DESIGNED;
        }
        layout.description = None;
        let bound = |reached: f64| three_digits_up(reached * (1.0 + MARGIN));
        let of_made = |errors: Statistics| {
            // Infinite where there are too few samples.
            let [_, highest] = errors.p95.interval;
            highest.is_finite().then(|| three_digits_up(highest * (1.0 + MADE_MARGIN)))
        };
        let made = result.made.as_ref().filter(|made| made.preset.is_none()).map(|made| FigureBounds {
            displacement_rmse_mm: made.after.displacement_rmse_mm.map(of_made),
            ..FigureBounds::default()
        });
        let made = made.filter(|bounds| *bounds != FigureBounds::default());
        let made = made.map(|bounds| MadeExpectations { bounds, ..MadeExpectations::default() });
        let Figures { uniformity_rmse, displacement_rmse_mm, amplitude } = result.after.figures;
        layout.expectations = Expectations {
            bounds: FigureBounds {
                uniformity_rmse: uniformity_rmse.map(|reached| reached.map(bound)),
                displacement_rmse_mm: displacement_rmse_mm.map(|reached| Some(bound(reached))),
                least_amplitude: Some((amplitude * 1e4).floor() / 1e4),
            },
            field: None,
            made: made.or(layout.expectations.made),
            ..layout.expectations
        };
        layout.brief = Some(self.brief.clone());
        layout.history.push(self.history_line(start, result, program));
        layout
    }

    fn history_line(&self, start: &str, result: &SearchResult, program: &str) -> String {
        let errors = |metrics: &Metrics, made: Option<&Figures<Statistics>>| {
            let Figures { uniformity_rmse, displacement_rmse_mm, amplitude } = metrics.figures;
            let in_words = |value: Option<f64>| value.map_or("one point".to_owned(), |value| format!("{value:.3e}"));
            let PerParameter { r_x, r_y, s_z } = uniformity_rmse.map(in_words);
            let PerAxis { x, y, z } = displacement_rmse_mm;
            format!(
                "uniformity RMSE {r_x}, {r_y}, {s_z}, displacement RMSE {x:.3e}, {y:.3e}, {z:.3e} mm, \
                 amplitude {amplitude:.4}"
            ) + &made.map_or(String::new(), |made| {
                let PerAxis { x, y, z } = made.displacement_rmse_mm.map(|axis| axis.p95.value);
                format!(", as made P95 {x:.3e}, {y:.3e}, {z:.3e} mm")
            })
        };
        let made = result.made.as_ref().filter(|made| made.preset.is_none());
        format!(
            "{program}: from {start}, {} free parameters, {} starts, seed {}: {} -> {}",
            self.variable_count(),
            self.brief.starts,
            self.brief.seed,
            errors(&result.before, made.and_then(|made| made.before.as_ref())),
            errors(&result.after, made.map(|made| &made.after))
        ) + if result.interrupted { "; interrupted, the best film found until then" } else { "" }
    }
}

/// The value rounded up to three digits.
fn three_digits_up(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return value;
    }
    let unit = value.log10().floor() as i32 - 2;
    let digits = (value / 10_f64.powi(unit)).ceil();
    // Parsed from decimals, so that it is written with three digits.
    format!("{digits}e{unit}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_rounded_up() {
        assert_eq!(three_digits_up(0.0012341), 0.00124);
        assert_eq!(three_digits_up(9.999e-6), 1e-5);
        assert_eq!(three_digits_up(0.0), 0.0);
    }
}
