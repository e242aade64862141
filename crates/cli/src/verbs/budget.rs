//! `magsplice budget`: the displacement error of films as made, divided by its causes.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use magsplice::Film;
use magsplice::decouple::PerAxis;
use magsplice::results::{FilmBudget, Improvement};
use magsplice::tolerance::Estimate;
#[cfg(feature = "report")]
use magsplice_report::budget_figure;

use super::tolerance::sampling::require_errors;
use crate::args::formats::ResultArgs;
use crate::args::numbers::{seed, whole};
use crate::args::preset::PresetArgs;
use crate::failure::Failure;
use crate::remarks;
use crate::session::Session;
use crate::text::number::counted;
use crate::text::rows::{Column, left, right};
use crate::text::units::in_per_cent;
use crate::text::{header, rows};

/// Split the displacement error of films as made into its causes.
///
/// Splits the expected mean square of the displacement error, along x, y and z, into the splicing
/// pattern (the same pattern repeated endlessly, against the ideal film), the end of the film, and
/// each cause of [tolerance]: of the tiles, of the surroundings, and of the sensor. The shares are
/// computed to first order, with exact derivatives, and checked by exact samples. Where the two
/// disagree by more than 5 %, the program reports it and computes the shares from samples of each
/// cause alone.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice budget layouts/robust-in-plane.toml\n  \
    magsplice budget layouts/published-film.toml --preset workshop --figure budget.png")]
pub(crate) struct BudgetArgs {
    /// Layout file
    layout: PathBuf,
    #[command(flatten)]
    preset: PresetArgs,
    /// Number of samples that check the shares, or from which they are computed
    #[arg(long, value_name = "N", default_value = "200", value_parser = |text: &str| whole(text, 20..=1_000_000_u64))]
    samples: u64,
    /// Seed of the random numbers [default: the value of [tolerance], else 1]
    #[arg(long, value_name = "SEED", value_parser = seed)]
    seed: Option<u64>,
    /// File for a bar chart of the budget: .pdf, .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FIGURE")]
    figure: Option<PathBuf>,
    #[command(flatten)]
    result: ResultArgs,
}

pub(crate) fn run(args: &BudgetArgs, quiet: bool) -> Result<(), Failure> {
    let mut session = Session::open(&args.layout, remarks::OF_COMPARISONS, quiet)?;
    let remark = args.preset.apply(Arc::make_mut(&mut session.layout), &args.layout)?;
    remark.iter().for_each(|remark| session.tell(remark));
    require_errors(&session)?;
    let film = session.film()?;
    let output = session.output(args.result.output.as_deref(), [])?;
    #[cfg(feature = "report")]
    let figure = session.figure(args.figure.as_deref(), [])?;
    let seed = args.seed.or(film.layout().tolerance.as_ref().map(|tolerance| tolerance.seed)).unwrap_or(1);
    let found = film.budget(seed, args.samples).map_err(|error| session.failed(error))?;
    #[cfg(feature = "report")]
    if let Some(file) = figure {
        session.progress.end();
        file.write(budget_figure(&found))?;
    }
    let result = args.result.format.shown(&found, || text(&film, &found));
    session.write(output, &result)
}

/// Number of causes and of tiles that are listed as worth improving.
const LISTED: usize = 3;

fn text(film: &Film, found: &FilmBudget) -> String {
    let mut text = header::with_recoil(film);
    text += "displacement error of films as made: RMS in mm, and share of the mean square\n\n";
    let mut table = vec![row("", ["x", "y", "z"].map(str::to_owned))];
    for part in &found.parts {
        table.push(row(&part.name, with_share(part.mean_square_mm2, part.share)));
    }
    let totals = found.total_mm2;
    let all = PerAxis { x: 1.0, y: 1.0, z: 1.0 };
    table.push(row("total", with_share(totals, all)));
    let sampled = format!("{} of films", exact_samples(found));
    table.push(row(&sampled, found.sampled_mm2.to_array().map(|square| format!("{:<13}", rms(square)))));
    text += &rows::table(&COLUMNS, &table);
    text.push('\n');
    if found.parts.iter().any(|part| part.mean_square_mm2.to_array().iter().any(|square| *square < 0.0)) {
        let sentence = "a minus sign marks the root of a negative mean square: causes that partly cancel, or a \
                        mean that brings the film nearer to the ideal one";
        rows::prose(&mut text, sentence);
    }
    if let Some(why) = &found.no_pattern {
        rows::prose(&mut text, &format!("the splicing pattern and the end of the film are not separated: {why}"));
    }
    if let Some(squares_mm2) = found.compensated_pattern_mm2 {
        let [x, y, z] = squares_mm2.to_array().map(rms);
        let sentence = format!(
            "the same splicing pattern, repeated endlessly, would have an error of {x}, {y}, {z} mm; the end of the \
             film compensates it"
        );
        rows::prose(&mut text, &sentence);
    }
    rows::prose(&mut text, &validity(found));
    let causes = listed(found, &found.worth_halving);
    if !causes.is_empty() {
        rows::prose(
            &mut text,
            &format!("causes most worth halving, with the share of the total mean square saved: {causes}"),
        );
    }
    let tiles = listed(found, &found.tiles_worth_halving);
    if !tiles.is_empty() {
        rows::prose(&mut text, &format!("tiles whose errors are most worth halving: {tiles}"));
    }
    text
}

/// Name of a part and its errors along x, y, z.
const COLUMNS: [Column; 4] = [left(28), right(20), right(20), right(20)];

fn row(label: &str, [x, y, z]: [String; 3]) -> [String; 4] {
    [label.chars().take(28).collect(), x, y, z]
}

/// Root mean squares with shares of the totals.
fn with_share(squares_mm2: PerAxis, shares: PerAxis) -> [String; 3] {
    let (squares_mm2, shares) = (squares_mm2.to_array(), shares.to_array());
    [0, 1, 2].map(|axis| format!("{} {:>6.1} %", rms(squares_mm2[axis]), in_per_cent(shares[axis])))
}

/// Length below which a part is round-off: a millionth of what any workshop can measure.
const ROUND_OFF_MM: f64 = 1e-9;

/// The root of a mean square, negative for one that compensates others.
fn rms(square_mm2: f64) -> String {
    let root = square_mm2.abs().sqrt().copysign(square_mm2);
    let root = if root.abs() < ROUND_OFF_MM { 0.0 } else { root };
    if root != 0.0 && root.abs() < 1e-4 { format!("{root:.1e}") } else { format!("{:.4}", root + 0.0) }
}

fn exact_samples(found: &FilmBudget) -> String {
    counted(found.samples as usize, "exact sample", "exact samples")
}

/// Whether the first order holds, in words.
fn validity(found: &FilmBudget) -> String {
    let PerAxis { x, y, z } = found.mean_square_ratio;
    let ratio = |(name, ratio): (&str, Option<Estimate>)| match ratio {
        Some(Estimate { value, interval: [low, high] }) => format!("{name} {value:.3} ({low:.3} .. {high:.3})"),
        None => format!("{name} -"),
    };
    let ratios = [("x", x), ("y", y), ("z", z)].map(ratio).join(", ");
    if found.is_first_order {
        format!("the first order holds within 5 %: mean square of {} / first order: {ratios}", exact_samples(found))
    } else {
        format!(
            "the first order does not hold within 5 % (mean square of exact samples / first order: {ratios}), so each cause \
             was sampled alone; halving a cause saves about three quarters of its part"
        )
    }
}

/// The first of the improvements with what they save of the total.
fn listed(found: &FilmBudget, improvements: &[Improvement]) -> String {
    let sum = |of: PerAxis| of.to_array().iter().sum::<f64>();
    let total = sum(found.total_mm2);
    let named = improvements.iter().take(LISTED);
    let named = named.map(|item| format!("{} ({:.0} %)", item.name, in_per_cent(sum(item.saved_mm2) / total)));
    named.collect::<Vec<_>>().join(", ")
}
