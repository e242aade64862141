//! `magsplice forces`: forces and torques of the tiles on each other, and placement orders.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use magsplice::FilmError;
use magsplice::layout::Layout;
use magsplice::prelude::DVec3;
use magsplice::results::{FilmLoads, ForceChange, OrderChoice, OrderedLoads, TileLoad};
use magsplice_export::csv;
#[cfg(feature = "report")]
use magsplice_report::forces_figure;

use crate::args::formats::{FileFormat, FileKind};
use crate::args::numbers::seed;
use crate::failure::Failure;
use crate::inputs::placement_order;
use crate::output::choice;
use crate::output::json;
use crate::remarks;
use crate::session::Session;
use crate::text::number::counted;
use crate::text::{header, rows};

/// Compute the force and torque on each tile.
///
/// The result has the force of all other tiles on each tile, and the torque about the tile's
/// centre. For tiles with parallel edges both have a closed form, exact to round-off, also where
/// the tiles touch. The magnetization is rigid, unless the layout gives a recoil permeability.
///
/// With --order, tiles are placed and glued one after another. The holding force of a step is the
/// magnitude of the force of the placed tiles on the next tile. The holding force of an order is
/// the largest of its steps. --order least searches for the order with the smallest holding force,
/// and prints a lower bound for all orders.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice forces layouts/published-film.toml\n  \
    magsplice forces film.toml --order least --figure order.svg --format csv -o order.csv\n  \
    magsplice forces film.toml --order order.csv")]
pub(crate) struct ForcesArgs {
    /// Layout file
    layout: PathBuf,
    /// Placement order: given (the order of the layout file), least (searched), or a CSV file whose
    /// column tile has the names of the tiles
    #[arg(long, value_name = "ORDER")]
    order: Option<String>,
    /// Seed of the random numbers of --order least
    #[arg(long, value_name = "SEED", default_value = "1", value_parser = seed, requires = "order")]
    seed: u64,
    /// Largest relative error of the force between two tiles that are turned against each other
    #[arg(long, value_name = "ERROR", default_value = "1e-9", value_parser = relative_error)]
    turned_error: f64,
    /// File for a figure of the tiles with their forces: .pdf, .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FIGURE")]
    figure: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else text]
    #[arg(long, value_enum)]
    format: Option<ForcesFormat>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Smallest relative error: below it, the round-off of the field decides.
const LEAST_ERROR: f64 = 1e-13;

fn relative_error(text: &str) -> Result<f64, String> {
    let error = text.parse().ok().filter(|error| (LEAST_ERROR..=0.1).contains(error));
    error.ok_or_else(|| format!("must be a number from {LEAST_ERROR:e} to 0.1"))
}

/// Formats of `forces`.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum ForcesFormat {
    /// Printed tables
    Text,
    /// Tiles, sums, and steps of the order
    Json,
    /// One line per tile, in placement order
    Csv,
}

impl FileFormat for ForcesFormat {
    fn file(self) -> FileKind {
        match self {
            ForcesFormat::Text => FileKind::text(&["txt"]),
            ForcesFormat::Json => FileKind::text(&["json"]),
            ForcesFormat::Csv => FileKind::text(&["csv"]),
        }
    }
}

pub(crate) fn run(args: &ForcesArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_TILES, quiet)?;
    let order = match args.order.as_deref() {
        None => None,
        Some("given") => Some(OrderChoice::Given),
        Some("least") => Some(OrderChoice::Least { seed: args.seed }),
        Some(word) if Path::new(word).extension().is_none() && !Path::new(word).exists() => {
            return Err(Failure::Refused(format!(
                "--order {word}: must be given, least, or a CSV file with the column tile, such as order.csv"
            )));
        }
        Some(path) => {
            let tiles = placement_order::read(Path::new(path), &session.layout)?;
            Some(OrderChoice::Stated { source: path.to_owned(), tiles })
        }
    };
    let order_path = match &order {
        Some(OrderChoice::Stated { source, .. }) => Some(PathBuf::from(source)),
        _ => None,
    };
    let format = choice::choose(args.format, args.output.as_deref(), Some(ForcesFormat::Text))?;
    let output = session.output(args.output.as_deref(), order_path.as_deref())?;
    #[cfg(feature = "report")]
    let figure = session.figure(args.figure.as_deref(), order_path.as_deref())?;
    let loads = session.film()?.forces(args.turned_error, order).map_err(|error| match error {
        FilmError::Forces { ref tiles, .. } if !tiles.is_empty() => {
            Failure::at(&args.layout, format!("{error} (--turned-error)"))
        }
        error => session.failed(error),
    })?;
    session.progress.end();
    #[cfg(feature = "report")]
    if let Some(file) = figure {
        file.write(forces_figure(&session.layout, &loads))?;
    }
    let result = match format {
        ForcesFormat::Text => text(&session.layout, &loads),
        ForcesFormat::Json => json::pretty(&loads),
        ForcesFormat::Csv => csv::loads(&loads),
    };
    session.write(output, &result)
}

/// Units of forces with their sizes in N, from the largest.
const UNITS: [(&str, f64); 3] = [("N", 1.0), ("mN", 1e-3), ("uN", 1e-6)];

/// A unit is used down to this fraction of it.
const SMALLEST_LARGEST: f64 = 0.1;

/// The loads on tiles, and a placement order, as tables.
fn text(layout: &Layout, loads: &FilmLoads) -> String {
    let mut text = header::layout(layout);
    text += "force on each tile by all others, and torque about its centre; ";
    text += match &loads.recoil {
        None => "rigid magnetization\n\n",
        Some(_) => "with recoil\n",
    };
    let largest_n = loads.tiles.iter().map(|tile| tile.load.force_n.length()).fold(0.0, f64::max);
    let unit = Unit::for_forces(largest_n);
    if let Some(ForceChange { cells, level, change_n, error_n }) = loads.recoil {
        let _ = writeln!(
            text,
            "recoil: {} at level {level}, forces change by up to {}, known to {}\n",
            counted(cells, "cell", "cells"),
            unit.force(change_n),
            unit.force(error_n)
        );
    }
    text += &unit.table(&loads.tiles, false);
    text.push('\n');
    if let Some(largest) = loads.largest() {
        let [force, torque] = largest.map(|tile| &loads.tiles[tile]);
        let _ = writeln!(text, "largest force   {} on {}", unit.force(force.load.force_n.length()), force.name);
        let largest = unit.torque(torque.load.torque_n_mm.length());
        let _ = writeln!(text, "largest torque  {largest} about the centre of {}", torque.name);
    }
    let origin = if loads.by_iron { "by the iron" } else { "round-off" };
    let [force, torque] = [loads.sum.force_n.length() / unit.size_n, loads.sum.torque_n_mm.length() / unit.size_n];
    let _ = writeln!(
        text,
        "sum of all      {force:.1e} {name}, and {torque:.1e} {name} mm about the origin: {origin}",
        name = unit.name
    );
    if let Some(order) = &loads.order {
        ordered(&mut text, order);
    }
    text
}

fn ordered(text: &mut String, order: &OrderedLoads) {
    let is_given = order.source == "given";
    let what = match order.seed {
        Some(seed) => format!("order with the smallest holding force found, seed {seed}"),
        None if is_given => "order of the layout file".to_owned(),
        None => format!("order of {}", order.source),
    };
    let _ = writeln!(text, "\n{what}: load on each tile while it is placed, by the tiles already placed\n");
    let unit = Unit::for_forces(order.holding_n);
    *text += &unit.table(&order.steps, true);
    text.push('\n');
    let Some(hardest) = order.steps.get(order.hardest_step - 1) else { return };
    let (holding, step) = (unit.force(order.holding_n), order.hardest_step);
    let _ = writeln!(text, "holding force   {holding} at step {step}, {}", hardest.name);
    if let (Some(bound_n), Some(greedy_n)) = (order.bound_n, order.greedy_holding_n) {
        let _ = writeln!(text, "bound           {}, a lower bound for all orders", unit.force(bound_n));
        let _ = writeln!(text, "greedy order    {}", unit.force(greedy_n));
    }
    if !is_given {
        let _ = writeln!(text, "given order     {}", unit.force(order.given_holding_n));
    }
}

/// A unit in which the forces of a table have few digits.
struct Unit {
    name: &'static str,
    size_n: f64,
}

impl Unit {
    fn for_forces(largest_n: f64) -> Unit {
        let fits = |(_, size_n): &(&str, f64)| largest_n >= SMALLEST_LARGEST * size_n;
        let (name, size_n) = UNITS.into_iter().find(fits).unwrap_or(UNITS[0]);
        Unit { name, size_n }
    }

    fn force(&self, force_n: f64) -> String {
        format!("{:.4} {}", force_n / self.size_n, self.name)
    }

    fn torque(&self, torque_n_mm: f64) -> String {
        format!("{:.4} {} mm", torque_n_mm / self.size_n, self.name)
    }

    fn number(&self, value: f64) -> String {
        let text = format!("{:.4}", value / self.size_n);
        // Round-off of zero.
        if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) { "0.0000".to_owned() } else { text }
    }

    fn table(&self, loads: &[TileLoad], with_steps: bool) -> String {
        let name = self.name;
        let number = rows::right(0).growing().after(2);
        let columns: [_; 9] = std::array::from_fn(|column| match column {
            0 if !with_steps => rows::right(0),
            1 => rows::left(0).growing().after(2),
            _ => number,
        });
        let (step, force, torque) =
            (if with_steps { "step" } else { "" }, format!("Fx, {name}"), format!("Tx, {name} mm"));
        let mut table = vec![[step, "tile", &force, "Fy", "Fz", "|F|", &torque, "Ty", "Tz"].map(str::to_owned)];
        for (index, TileLoad { name, load, .. }) in loads.iter().enumerate() {
            let numbers = |vector: DVec3| vector.to_array().map(|value| self.number(value));
            let ([fx, fy, fz], [tx, ty, tz]) = (numbers(load.force_n), numbers(load.torque_n_mm));
            let step = if with_steps { (index + 1).to_string() } else { String::new() };
            table.push([step, name.clone(), fx, fy, fz, self.number(load.force_n.length()), tx, ty, tz]);
        }
        rows::table(&columns, &table)
    }
}
