//! A film that a search found.

use magsplice_design::{SearchResult, SpliceTrial};
use magsplice_layout::Layout;
use serde::Serialize;

use super::out_of_range::OutOfRange;
use crate::film::Film;
use crate::film_error::FilmError;

/// A film that a search found, and what its sensor reads.
#[derive(Clone, Debug, Serialize)]
pub struct FoundFilm {
    /// The film.
    #[serde(flatten)]
    pub search: SearchResult,
    /// Readings beyond the range of the layout's sensor. `None` if all are within it, or the layout
    /// has no range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub out_of_range: Option<OutOfRange>,
    /// Searches with one number of the request changed, if a film designed without an initial
    /// layout is useless.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub trials: Vec<SpliceTrial>,
}

impl FoundFilm {
    /// The film of a search, whose layout is `layout`, without trials.
    ///
    /// # Errors
    /// If the sensor of the layout cannot read the field.
    pub fn new(search: SearchResult, layout: Layout) -> Result<FoundFilm, FilmError> {
        let out_of_range = match layout.sensor {
            Some(_) => Film::new(layout)?.out_of_range()?,
            None => None,
        };
        Ok(FoundFilm { search, out_of_range, trials: Vec::new() })
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use magsplice_design::DesignProblem;
    use magsplice_layout::{Brief, Goal, Outline, Symmetry, Variable};

    use super::*;

    /// The errors of a film found below a head are those of its written layout, to round-off of
    /// 1e-12 over the smallest error of 1e-2.
    #[test]
    fn film_found_below_a_head_has_the_errors_of_its_layout() {
        let mut layout = Layout::read("../../layouts/heads/published-cross.toml").unwrap_or_else(|e| panic!("{e}"));
        let edges = Some([-10.0, 10.0]);
        layout.brief = Some(Brief {
            vary: [Variable::Size, Variable::Position].into(),
            symmetry: Symmetry::FourFold,
            goal: Goal::Displacement,
            outline_mm: Outline { x: edges, y: edges },
            smallest_cut_mm: Some(0.8),
            step_mm: Some(2.0),
            starts: 1,
            ..Brief::default()
        });
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        // One step is enough for another film.
        let found = problem.search(&|_| ControlFlow::Break(())).unwrap_or_else(|e| panic!("{e}"));
        let written = problem.designed_layout(&found, "test").to_compact_toml();
        let film = Film::new(Layout::parse(&written, "test").unwrap_or_else(|e| panic!("{e}"))).unwrap();
        let decoupling = film.decouple().unwrap().decoupling;
        let errors = [
            (found.after.figures.displacement_rmse_mm.x, decoupling.displacement_rmse_mm.x),
            (found.after.figures.displacement_rmse_mm.z, decoupling.displacement_rmse_mm.z),
            (found.after.figures.amplitude, film.compare().unwrap().comparison.amplitude),
        ];
        for (found, written) in errors {
            assert!((found / written - 1.0).abs() < 1e-10, "{found} is not {written}");
        }
        assert!(found.after.figures.displacement_rmse_mm.x < found.before.figures.displacement_rmse_mm.x);
    }
}
