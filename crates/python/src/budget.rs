//! Where the displacement error of films that are made comes from.

use magsplice::tolerance::Estimate;
use pyo3::prelude::*;

use crate::film::{Film, run};
use crate::vectors::Triple;

/// Names with values along x, y, z.
type Named = Vec<(String, Triple)>;

/// A budget, with the fields of the Python class. Mean squares are in mm^2.
#[derive(IntoPyObject)]
pub(crate) struct BudgetNumbers {
    first_order: bool,
    parts: Named,
    endless_pattern_mm2: Option<Triple>,
    total_mm2: Triple,
    sampled_mm2: Triple,
    /// Ratios along x, y, z with the ends of their intervals.
    mean_square_ratio: Triple<Option<Triple>>,
    worth_halving: Named,
    tiles_worth_halving: Named,
    no_pattern: Option<String>,
}

/// The budget of the errors that the layout states, or of those of a preset.
#[pyfunction]
pub(crate) fn budget(
    py: Python<'_>,
    film: &Film,
    preset: Option<&str>,
    seed: u64,
    samples: u64,
) -> PyResult<BudgetNumbers> {
    let layout = film.layout_with_errors(preset)?;
    let film = film.with_tables(py, layout)?;
    let found = run(py, film, |film| film.budget(seed, samples))?;
    let layout = &found.layout;
    let ratio = |Estimate { value, interval: [low, high] }| (value, low, high);
    let budget = &found.budget;
    Ok(BudgetNumbers {
        first_order: found.is_first_order,
        parts: found.parts().into_iter().map(|part| (part.name, part.mean_squares_mm2.into())).collect(),
        endless_pattern_mm2: found.endless_pattern_mm2().map(Into::into),
        total_mm2: found.totals_mm2().into(),
        sampled_mm2: found.sampled_mm2().into(),
        mean_square_ratio: found.check.axes.map(|axis| axis.mean_square_ratio.map(ratio)).into(),
        worth_halving: budget.causes.iter().map(|item| (found.cause(item.cause), item.saved_mm2.into())).collect(),
        tiles_worth_halving: budget
            .tiles
            .iter()
            .map(|item| (layout.tiles[item.tile].name.clone(), item.saved_mm2.into()))
            .collect(),
        no_pattern: found.no_pattern.map(|error| error.to_string()),
    })
}
