//! `magsplice assign`: places measured tiles.

use std::path::{Path, PathBuf};

use clap::Args;
use magsplice::layout::{Layout, TileForm};
use magsplice::making::{AssignmentError, AssignmentSettings, PartlyPlaced, PlaceGroup};
#[cfg(feature = "report")]
use magsplice::results::BillOfMaterials;
use magsplice::results::FilmAssignment;
use magsplice::{Film, FilmError};
#[cfg(feature = "report")]
use magsplice_report::{SvgText, placement_plan_figure, plan_page};

use crate::args::formats::TextOrJson;
use crate::args::measurement::MeasurementArgs;
use crate::args::numbers::{seed, whole};
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::{measured_tiles, placed_tiles};
use crate::output::PROGRAM;
use crate::output::destination::print;
use crate::remarks;
use crate::session::Session;

/// The summary and the plan as text.
mod text;

/// Assign measured tiles to the places of a film, each with its orientation.
///
/// Each row of the table is a tile that was cut: its name in the column tile; its part, by its
/// number in `magsplice tiles` or the name of a tile or kind of the layout, in the column part; and
/// its polarization (jx_t, jy_t, jz_t), magnetization (mx_a_per_m, ...), moment (moment_x_a_m2,
/// ...) or strength (strength_t, with or without direction_deg and tilt_deg). Axes are the axes of
/// the part: x along its first side, y along its second, z up. Measured sides are in size_x_mm,
/// size_y_mm, size_z_mm. Tiles in excess of the places are spares. Tiles whose magnetization is
/// missing are left out.
///
/// The tiles are placed so that the displacement error of the film is least: local searches from
/// many starts, by the exact derivatives and then the exact field. The result is a layout with the
/// measured tiles, and a plan: for each place the tile, the side that is up, and the direction of
/// its mark, an arrow. Before a tile is measured, draw this arrow on its upper side, along +x of
/// its part.
#[derive(Args)]
#[command(
    after_help = "Example:\n  magsplice assign layouts/designed-stock.toml --measured tiles.csv -o assigned.toml \
    --plan plan.csv --figure plan.png\n  \
    magsplice assign film.toml --measured tiles.csv --placed plan.csv -o assigned.toml --shim rim-1"
)]
pub(crate) struct AssignArgs {
    /// Layout file
    layout: PathBuf,
    /// CSV file with the measured tiles
    #[arg(long, value_name = "TABLE")]
    measured: PathBuf,
    /// CSV file of tiles already placed, with the columns of --plan. They stay; the remaining tiles
    /// compensate. Positions are as measured; rows with no in the column placed are ignored
    #[arg(long, value_name = "TABLE")]
    placed: Option<PathBuf>,
    /// Place of a shim: a tile whose best strength is computed; may be repeated
    #[arg(long, value_name = "PLACE")]
    shim: Vec<String>,
    /// Turn no tile over: the side that was up when it was measured stays up
    #[arg(long)]
    keep_side_up: bool,
    /// Number of random starts [default: 16 at a time until 4 agree on the best, at most 128]
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 1..=MAX_STARTS))]
    starts: Option<usize>,
    /// Seed of the random numbers
    #[arg(long, value_name = "SEED", default_value = "1", value_parser = seed)]
    seed: u64,
    /// Layout file to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "LAYOUT")]
    output: Option<PathBuf>,
    /// CSV file for the plan
    #[arg(long, value_name = "TABLE")]
    plan: Option<PathBuf>,
    /// Draw the plan into this file, .pdf, .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FIGURE")]
    figure: Option<PathBuf>,
    /// Write the plan and the bill of materials as a page to print (HTML)
    #[cfg(feature = "report")]
    #[arg(long, value_name = "PAGE")]
    page: Option<PathBuf>,
    /// Format of the summary
    #[arg(long, value_enum, default_value = "text")]
    format: TextOrJson,
    #[command(flatten)]
    errors: MeasurementArgs,
}

pub(crate) fn run(args: &AssignArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_COMPARISONS, quiet)?;
    let inputs = || [Some(&args.measured), args.placed.as_ref()].into_iter().flatten().map(PathBuf::as_path);
    let output = session.output(args.output.as_deref(), inputs())?;
    let plan = args.plan.as_deref().map(|plan| session.output(Some(plan), inputs())).transpose()?;
    #[cfg(feature = "report")]
    let figure = session.figure(args.figure.as_deref(), inputs())?;
    #[cfg(feature = "report")]
    let page = session.page(args.page.as_deref(), inputs())?;

    let measured = measured_tiles::read(&args.measured, &session.layout, &|remark| session.tell(remark))?;
    let mut groups = measured.groups;
    let shims = shims(args, &session.layout, &mut groups)?;
    let (partly, ignored) = match &args.placed {
        Some(path) => placed_tiles::read(path, &session.layout, &groups)?,
        None => (PartlyPlaced { film: session.layout.bare_tiles(), groups, plan: Vec::new() }, Vec::new()),
    };
    session.require_film(true, "assign", "places tiles so that a film decouples best")?;
    let film = session.film()?;
    let settings = AssignmentSettings {
        starts: args.starts,
        seed: args.seed,
        may_turn_over: !args.keep_side_up,
        ..AssignmentSettings::default()
    };
    let found = film.assign(&partly, &shims, &settings, args.errors.errors());
    let found = found.map_err(|error| assignment_failure(args, &session, error))?;
    for turn in &found.common_turns {
        session.tell(&format!("{}: {turn}", args.measured.display()));
    }
    let assigned = layout_text(args, &film, &found, measured.has_sizes)?;
    session.progress.end();

    let to_file = !output.is_standard();
    output.complete(&assigned)?;
    plan.map_or(Ok(()), |plan| plan.complete(&text::plan_csv(&found.plan)))?;
    #[cfg(feature = "report")]
    if figure.is_some() || page.is_some() {
        let drawn = placement_plan_figure(&found, SvgText::Text)?;
        if let Some(page) = page {
            page.complete(&plan_page(&BillOfMaterials::new(&session.layout, None), &drawn, &found.plan))?;
        }
        if let Some(file) = figure {
            file.write(Ok(drawn))?;
        }
    }
    for (path, ignored) in [(Some(&args.measured), measured.ignored), (args.placed.as_ref(), ignored)] {
        if let Some(path) = path.filter(|_| !ignored.is_empty()) {
            session.tell(&format!("{}: columns that were not read: {}", path.display(), ignored.join(", ")));
        }
    }
    let summary = args.format.shown(&found, || text::summary(&film, &found, args.output.as_deref()));
    if to_file {
        print(&summary)?;
    } else if !quiet {
        failure::print_escaped(&summary);
    }
    Ok(())
}

/// The indices of the shims, whose places are taken out of the groups.
fn shims(args: &AssignArgs, layout: &Layout, groups: &mut [PlaceGroup]) -> Result<Vec<usize>, Failure> {
    let (mut shims, mut faults) = (Vec::new(), FaultList::default());
    for name in &args.shim {
        match layout.tiles.iter().position(|named| named.name == *name) {
            None => faults.add(0, format!("--shim {name}: must be the name of a tile of the layout")),
            Some(tile) if shims.contains(&tile) => faults.add(0, format!("--shim {name} is given twice")),
            Some(tile) => shims.push(tile),
        }
    }
    if !faults.is_empty() {
        return Err(faults.failure(args.layout.display()));
    }
    groups.iter_mut().for_each(|group| group.places.retain(|place| !shims.contains(place)));
    Ok(shims)
}

/// The failure with the file and the option that it is about.
fn assignment_failure(args: &AssignArgs, session: &Session, error: FilmError) -> Failure {
    let FilmError::Assignment { error: found, .. } = &error else { return session.failed(error) };
    let (path, option) = match found {
        AssignmentError::TooFew(_) => (&args.measured, " (--placed)"),
        AssignmentError::NoOrientation { .. } => (&args.layout, " (leave out --keep-side-up)"),
        AssignmentError::Shim { .. } => (&args.layout, " (--shim)"),
        _ => (&args.layout, ""),
    };
    Failure::at(path, format!("{error}{option}"))
}

/// The layout file of the film with its measured tiles. Refuses a film that breaks a rule of
/// layouts.
fn layout_text(args: &AssignArgs, film: &Film, found: &FilmAssignment, has_sizes: bool) -> Result<String, Failure> {
    let program = format!("{PROGRAM} assign");
    let layout = film.assigned_layout(found, has_sizes, &program);
    let folder = args.output.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    let origin = format!("the film of {}", args.measured.display());
    Ok(layout.to_edited_toml(TileForm::Compact, folder, &origin)?)
}

/// Largest number of starts.
const MAX_STARTS: usize = 10_000;
