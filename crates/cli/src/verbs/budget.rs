//! `magsplice budget`: tells where the displacement error of the films that are made comes from.

use std::path::Path;

use magsplice::Stage;
#[cfg(feature = "report")]
use magsplice_report::{BudgetBar, budget_figure};

use crate::args::budget::BudgetArgs;
use crate::args::formats::TextOrJson;
use crate::failure::Failure;
use crate::output::destination::Output;
#[cfg(feature = "report")]
use crate::output::figure_file;
use crate::progress::ProgressLine;
use crate::sampling::film_budget::BudgetedFilm;
use crate::sampling::scene::SampledScene;
use crate::{json, remarks, text};

pub(crate) fn run(args: &BudgetArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let mut layout = remarks::read_layout(&args.layout, remarks::OF_COMPARISONS, quiet, &progress)?;
    args.preset.apply(&mut layout);
    let scene = SampledScene::new(&args.layout, &layout, &progress, &remarks::teller(quiet, &progress))?;
    let inputs: [&Path; 1] = [&args.layout];
    let mut output = Output::open(args.result.output.as_deref(), &inputs)?;
    #[cfg(feature = "report")]
    let figure = figure_file::open(args.figure.as_deref(), &inputs)?;
    let seed = args.seed.or(layout.tolerance.as_ref().map(|tolerance| tolerance.seed)).unwrap_or(1);
    progress.show(Stage::uncounted("budget"));
    let film = BudgetedFilm::new(&scene, seed, args.samples)?;
    progress.end();
    #[cfg(feature = "report")]
    if let Some(file) = figure {
        let bars: Vec<BudgetBar> = film
            .found
            .parts()
            .into_iter()
            .map(|part| BudgetBar { name: part.name, mean_squares_mm2: part.mean_squares_mm2 })
            .collect();
        file.write(budget_figure(&bars, film.found.totals_mm2()))?;
    }
    let result = match args.result.format {
        TextOrJson::Text => text::budget::budget(&film),
        TextOrJson::Json => json::pretty(&json::budget::BudgetJson::new(&film)),
    };
    output.write(|w| w.write_all(result.as_bytes()))?;
    output.finish()
}
