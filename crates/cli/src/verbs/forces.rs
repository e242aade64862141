//! `magsplice forces`: forces and torques of the tiles on each other, and orders of laying.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use magsplice::force::{LayingOrder, LeastHolding, OrderSettings};
use magsplice::layout::Layout;
use magsplice::{FilmError, SolvedForces, Stage};
#[cfg(feature = "report")]
use magsplice_report::{TileForce, forces_figure};

use crate::args::forces::{ForcesArgs, ForcesFormat};
use crate::failure::Failure;
use crate::film_loads::{FilmLoads, OrderSource, OrderedLoads};
use crate::inputs::laying_order;
use crate::output::choice;
use crate::output::destination::Output;
#[cfg(feature = "report")]
use crate::output::figure_file;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::words::film_failure;
use crate::{json, remarks, text};

pub(crate) fn run(args: &ForcesArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_TILES, quiet, &progress)?;
    let order_path = args.order.as_deref().filter(|order| !["given", "least"].contains(order)).map(PathBuf::from);
    let given: Vec<usize> = (0..layout.tiles.len()).collect();
    let order = match &order_path {
        Some(path) => laying_order::read(path, &layout)?,
        None => given.clone(),
    };
    let inputs: Vec<&Path> = std::iter::once(args.layout.as_path()).chain(order_path.as_deref()).collect();
    let format = choice::choose(args.format, args.output.as_deref(), Some(ForcesFormat::Text))?;
    let mut output = Output::open(args.output.as_deref(), &inputs)?;
    #[cfg(feature = "report")]
    let figure = figure_file::open(args.figure.as_deref(), &inputs)?;
    let show = |stage: Stage| progress.show(stage);
    let film = prepare(&args.layout, &layout, &show, &remarks::teller(quiet, &progress))?;
    let SolvedForces { loads: forces, recoil } =
        film.forces(args.turned_error).map_err(|error| failed(args, &layout, error))?;
    let ordered = |tiles: Vec<usize>| LayingOrder::new(&forces, tiles).expect("each tile once");
    let given = ordered(given);
    let order = match (args.order.as_deref(), order_path) {
        (None, _) => None,
        (Some("least"), None) => {
            let settings = OrderSettings { seed: args.seed, ..OrderSettings::default() };
            let counted = Counter { progress: &progress, name: "order of laying", of: settings.runs, unit: "runs" };
            let found = LeastHolding::search(&forces, &settings, counted.callback());
            Some(OrderedLoads::least(&found, args.seed, &given))
        }
        (Some(_), None) => Some(OrderedLoads::new(&given, OrderSource::Given, &given)),
        (Some(_), Some(path)) => {
            Some(OrderedLoads::new(&ordered(order), OrderSource::File(path.display().to_string()), &given))
        }
    };
    let loads = FilmLoads::new(&layout, &forces, recoil, order);
    progress.end();
    #[cfg(feature = "report")]
    if let Some(file) = figure {
        file.write(forces_figure(&drawn_tiles(&loads), loads.order.is_some()))?;
    }
    let result = match format {
        ForcesFormat::Text => text::forces::forces(&loads),
        ForcesFormat::Json => json::pretty(&json::forces::ForcesJson::new(&loads)),
        ForcesFormat::Csv => loads.csv(),
    };
    output.write(|w| w.write_all(result.as_bytes()))?;
    output.finish()
}

fn failed(args: &ForcesArgs, layout: &Layout, error: FilmError) -> Failure {
    match error {
        FilmError::Forces { ref tiles, .. } if !tiles.is_empty() => {
            Failure::Points { path: args.layout.clone(), message: format!("{error} (--turned-error)") }
        }
        error => film_failure(&args.layout, layout, error),
    }
}

/// Counts what is done, from any thread, for the progress line.
struct Counter<'a> {
    progress: &'a ProgressLine,
    name: &'static str,
    of: usize,
    unit: &'static str,
}

impl Counter<'_> {
    fn callback(&self) -> impl Fn() + Sync {
        let done = AtomicUsize::new(0);
        move || {
            let done = done.fetch_add(1, Ordering::Relaxed);
            self.progress.show(Stage { name: self.name, done, of: Some(self.of), unit: self.unit });
        }
    }
}

/// The tiles with the forces to draw: those by all others, or while they are laid.
#[cfg(feature = "report")]
fn drawn_tiles<'a>(loads: &FilmLoads<'a>) -> Vec<TileForce<'a>> {
    let tiles = &loads.layout.tiles;
    match &loads.order {
        None => tiles
            .iter()
            .zip(&loads.tiles)
            .map(|(tile, load)| TileForce { tile, force_n: load.force_n, step: None })
            .collect(),
        Some(order) => order
            .steps
            .iter()
            .enumerate()
            .map(|(step, (tile, load))| TileForce { tile: &tiles[*tile], force_n: load.force_n, step: Some(step + 1) })
            .collect(),
    }
}
