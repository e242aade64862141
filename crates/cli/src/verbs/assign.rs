//! `magsplice assign`: places measured tiles.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

#[cfg(feature = "report")]
use magsplice::FilmAssignment;
use magsplice::layout::{Layout, TileForm};
use magsplice::making::{AssignmentError, AssignmentSettings, PartlyLaid, PlaceGroup};
use magsplice::{Film, FilmError};
#[cfg(feature = "report")]
use magsplice::{making::PlanRow, prelude::Tile, results::BillOfMaterials};
#[cfg(feature = "report")]
use magsplice_report::{LaidTile, SvgText, laying_plan_figure, plan_page};

use super::search::PROGRAM;
use crate::args::assign::AssignArgs;
use crate::args::formats::TextOrJson;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::{measured_tiles, placed_tiles};
use crate::laying::assigned_film::AssignedFilm;
use crate::laying::laying_plan;
use crate::output::destination::{Output, print};
#[cfg(feature = "report")]
use crate::output::figure_file;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_film};
use crate::{json, remarks, text};

pub(crate) fn run(args: &AssignArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_COMPARISONS, quiet, &progress)?;
    let inputs: Vec<&Path> =
        [Some(&args.layout), Some(&args.measured), args.placed.as_ref()].into_iter().flatten().map(|p| &**p).collect();
    let mut output = Output::open(args.output.as_deref(), &inputs)?;
    let plan = args.plan.as_deref().map(|plan| Output::open(Some(plan), &inputs)).transpose()?;
    #[cfg(feature = "report")]
    let figure = figure_file::open(args.figure.as_deref(), &inputs)?;
    #[cfg(feature = "report")]
    let page = args.page.as_deref().map(|page| Output::open(Some(page), &inputs)).transpose()?;

    let measured = measured_tiles::read(&args.measured, &layout)?;
    let count = measured.groups.iter().map(|group| group.tiles.len()).sum();
    let mut groups = measured.groups;
    let shims = shims(args, &layout, &mut groups)?;
    let partly = match &args.placed {
        Some(path) => placed_tiles::read(path, &layout, &groups)?,
        None => PartlyLaid { film: layout.bare_tiles(), groups, plan: Vec::new() },
    };
    let mut film = assigned(args, &layout, &partly, &shims, &progress, quiet)?;
    film.measured = count;
    let assigned = layout_text(args, &film, measured.has_sizes)?;
    progress.end();

    output.write(|writer| writer.write_all(assigned.as_bytes()))?;
    let to_file = !output.is_standard();
    output.finish()?;
    if let Some(mut plan) = plan {
        plan.write(|writer| writer.write_all(laying_plan::csv(&film.assignment.plan).as_bytes()))?;
        plan.finish()?;
    }
    #[cfg(feature = "report")]
    if figure.is_some() || page.is_some() {
        let FilmAssignment { plan, tiles, .. } = &film.assignment;
        let rows: Vec<LaidTile> = plan.iter().zip(tiles).map(|(row, tile)| laid_tile(row, tile)).collect();
        let drawn = laying_plan_figure(&rows, SvgText::Text).map_err(|error| Failure::Format(error.to_string()))?;
        if let Some(mut page) = page {
            let text = plan_page(&BillOfMaterials::new(&layout, None), &drawn, plan);
            page.write(|writer| writer.write_all(text.as_bytes()))?;
            page.finish()?;
        }
        if let Some(file) = figure {
            file.write(Ok(drawn))?;
        }
    }
    if !quiet && !measured.ignored.is_empty() {
        let ignored = measured.ignored.join(", ");
        failure::tell(&format_args!("{}: columns that were not read: {ignored}", args.measured.display()));
    }
    let summary = match args.format {
        TextOrJson::Json => json::pretty(&json::assign::AssignJson::new(&film)),
        TextOrJson::Text => text::assign::assigned(&film, args.output.as_deref()),
    };
    if to_file {
        print(&summary)?;
    } else if !quiet {
        let _ = std::io::stderr().write_all(summary.as_bytes());
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
        return Err(faults.failure(args.layout.display().to_string()));
    }
    groups.iter_mut().for_each(|group| group.places.retain(|place| !shims.contains(place)));
    Ok(shims)
}

fn assigned<'a>(
    args: &AssignArgs,
    layout: &'a Layout,
    partly: &PartlyLaid,
    shims: &[usize],
    progress: &Arc<ProgressLine>,
    quiet: bool,
) -> Result<AssignedFilm<'a>, Failure> {
    let missing = |error| no_film(&args.layout, error, "assign", "places tiles so that a film decouples best");
    let stated = Film::rigid(layout.clone());
    stated.ideal().map_err(missing)?;
    stated.evaluation_grid().map_err(missing)?;
    let ordered = prepare(&args.layout, layout, progress, &remarks::teller(quiet, progress))?;
    let settings = AssignmentSettings {
        starts: args.starts,
        seed: args.seed,
        may_turn_over: !args.keep_side_up,
        ..AssignmentSettings::default()
    };
    let found = ordered.assign(partly, shims, &settings, args.errors.errors());
    let assignment = found.map_err(|error| assignment_failure(args, layout, error))?;
    Ok(AssignedFilm { layout, recoil: ordered.recoil().cloned(), measured: 0, assignment })
}

/// The failure with the file and the option that it is about.
fn assignment_failure(args: &AssignArgs, layout: &Layout, error: FilmError) -> Failure {
    let FilmError::Assignment { error: found, .. } = &error else { return film_failure(&args.layout, layout, error) };
    let (path, option) = match found {
        AssignmentError::TooFew { .. } => (&args.measured, " (--placed)"),
        AssignmentError::NoOrientation { .. } => (&args.layout, " (leave out --keep-side-up)"),
        AssignmentError::Shim { .. } => (&args.layout, " (--shim)"),
        _ => (&args.layout, ""),
    };
    Failure::Points { path: path.clone(), message: format!("{error}{option}") }
}

/// The layout file of the film with its measured tiles. Refuses a film that breaks a rule of
/// layouts.
fn layout_text(args: &AssignArgs, film: &AssignedFilm, has_sizes: bool) -> Result<String, Failure> {
    let program = format!("{PROGRAM} assign");
    let layout = Film::rigid(film.layout.clone()).assigned_layout(&film.assignment, has_sizes, &program);
    let folder = args.output.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    let origin = format!("the film of {}", args.measured.display());
    Ok(layout.to_edited_toml(TileForm::Compact, folder, &origin)?)
}

#[cfg(feature = "report")]
fn laid_tile<'a>(row: &'a PlanRow, tile: &'a Tile) -> LaidTile<'a> {
    LaidTile {
        name: &row.tile,
        tile,
        mark_rad: row.mark_deg.to_radians(),
        is_upright: row.is_upright(),
        is_laid: row.is_laid,
    }
}
