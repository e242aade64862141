//! `magsplice assign`: places measured tiles.

use std::io::Write;
use std::path::Path;

use magsplice::layout::{Distribution, FilmTolerance, Layout, MAX_NAME_BYTES};
use magsplice::making::{AssignmentError, AssignmentProblem, AssignmentSettings, MeasurementErrors, PlaceGroup};
use magsplice::prelude::Tile;
use magsplice::tolerance::{RealFilm, TileChanges};
use magsplice::{Film, Stage};
#[cfg(feature = "report")]
use magsplice_report::{LaidTile, SvgText, laying_plan_figure};

use super::search::PROGRAM;
use crate::args::assign::AssignArgs;
use crate::args::formats::TextOrJson;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::laying::assigned_film::AssignedFilm;
use crate::laying::laying_plan::{self, PlanRow, SHIM};
use crate::laying::measured_tiles::{self, part_in_words};
use crate::laying::placed_tiles::{self, PartlyLaid};
use crate::output::destination::{Output, print};
#[cfg(feature = "report")]
use crate::output::figure_file;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::words::no_film;
#[cfg(feature = "report")]
use crate::{cut_list::CutList, printed};
use crate::{json, made_layout, remarks, text};

/// Times that each start is disturbed and searched anew. Twice as many lower the error of the shipped
/// films by less than a tenth.
const KICKS: usize = 200;

/// What the name of a layout with measured tiles ends with.
const ASSIGNED: &str = ", assigned";

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
        None => PartlyLaid { film: layout.bare_tiles(), groups, rows: Vec::new() },
    };
    let mut film = assigned(args, &layout, &partly, &shims, &progress, quiet)?;
    film.measured = count;
    let assigned = layout_text(args, &film, measured.has_sizes)?;
    progress.end();

    output.write(|writer| writer.write_all(assigned.as_bytes()))?;
    let to_file = !output.is_standard();
    output.finish()?;
    if let Some(mut plan) = plan {
        plan.write(|writer| writer.write_all(laying_plan::csv(&film.plan).as_bytes()))?;
        plan.finish()?;
    }
    #[cfg(feature = "report")]
    if figure.is_some() || page.is_some() {
        let rows: Vec<LaidTile> = film.plan.iter().zip(&film.tiles).map(|(row, tile)| laid_tile(row, tile)).collect();
        let drawn = laying_plan_figure(&rows, SvgText::Text).map_err(|error| Failure::Format(error.to_string()))?;
        if let Some(mut page) = page {
            let text = printed::plan_page(&CutList::new(&layout, None), &drawn, &film.plan);
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
    progress: &ProgressLine,
    quiet: bool,
) -> Result<AssignedFilm<'a>, Failure> {
    let purpose = "places tiles so that a film decouples best";
    let stated = Film::rigid(layout);
    let missing = |error| no_film(&args.layout, error, "assign", purpose);
    let (ideal, volume) = (stated.ideal().map_err(missing)?, stated.evaluation_grid().map_err(missing)?);
    let show = |stage: Stage| progress.show(stage);
    let ordered = prepare(&args.layout, layout, &show, &remarks::teller(quiet, progress))?;
    progress.show(Stage::uncounted("assigning tiles"));
    let failed = |error: AssignmentError| assignment_failure(args, layout, partly, error);
    let without_errors = |error| failed(AssignmentError::Film(error));
    let film = ordered.weakened(RealFilm::new(&partly.film, &FilmTolerance::default()));
    let model = TileChanges::new(&film, &volume, ideal).map_err(without_errors)?;
    let ordered_rms_mm = model.exact_rms_mm(&layout.bare_tiles()).map_err(without_errors)?;
    let settings =
        AssignmentSettings { starts: args.starts, kicks: KICKS, seed: args.seed, may_turn_over: !args.keep_side_up };
    let problem = AssignmentProblem::new(&model, &partly.film, &partly.groups, shims, &settings).map_err(failed)?;
    let found = problem.solve(&settings).map_err(failed)?;
    let tiles = problem.film(&found.placed, &found.shim_factors).map_err(failed)?;
    let measurement = match args.errors.errors() {
        Some(errors) => {
            let with_errors = problem.rms_of_measured_mm(&found.placed, &found.shim_factors, &errors, args.seed);
            Some((errors, with_errors.map_err(failed)?))
        }
        None => None,
    };
    let mut plan: Vec<(usize, PlanRow)> = partly.rows.clone();
    plan.extend(found.placed.iter().map(|placed| {
        let tile = &partly.groups[placed.group].tiles[placed.tile];
        let place = &layout.tiles[placed.place].name;
        (placed.place, PlanRow::new(place, &tile.name, placed.orientation, &tiles[placed.place], false))
    }));
    plan.extend(shims.iter().map(|&shim| {
        let as_ordered = magsplice::making::Orientation::AS_MEASURED;
        (shim, PlanRow::new(&layout.tiles[shim].name, SHIM, as_ordered, &tiles[shim], false))
    }));
    plan.sort_by_key(|(place, _)| *place);
    let plan = plan.into_iter().map(|(_, row)| row).collect();
    let shims = shims.iter().map(|&shim| (shim, shim_strength_t(&partly.film[shim], &tiles[shim]))).collect();
    let recoil = ordered.recoil().cloned();
    Ok(AssignedFilm { layout, recoil, measured: 0, ordered_rms_mm, found, measurement, tiles, plan, shims })
}

/// The strength of a shim in tesla, negative if it is reversed.
fn shim_strength_t(ordered: &Tile, shim: &Tile) -> f64 {
    let j_t = shim.polarization_t();
    j_t.length() * j_t.dot(ordered.polarization_t()).signum()
}

fn assignment_failure(args: &AssignArgs, layout: &Layout, partly: &PartlyLaid, error: AssignmentError) -> Failure {
    let name = |place: usize| &layout.tiles[place].name;
    let (path, message) = match error {
        AssignmentError::TooFew { group, places, tiles } => {
            let part = part_in_words(group, partly.groups[group].size_mm, places);
            (
                &args.measured,
                format!("{part} has {tiles} of the measured tiles: measure more, or lay them with --placed"),
            )
        }
        AssignmentError::NoOrientation { place } => {
            (&args.layout, format!("place \"{}\": its tile must be turned over: leave out --keep-side-up", name(place)))
        }
        AssignmentError::Shim { tile } => (
            &args.layout,
            format!("--shim {}: what it does cannot be told from the other shims: choose another place", name(tile)),
        ),
        error => (&args.layout, error.to_string()),
    };
    Failure::Points { path: path.clone(), message }
}

/// The layout file of the film with its measured tiles. Refuses a film that breaks a rule of layouts.
fn layout_text(args: &AssignArgs, film: &AssignedFilm, has_sizes: bool) -> Result<String, Failure> {
    let mut layout = film.layout.clone();
    made_layout::replace_tiles(&mut layout, &film.tiles);
    if !layout.name.ends_with(ASSIGNED) && layout.name.len() + ASSIGNED.len() <= MAX_NAME_BYTES {
        layout.name += ASSIGNED;
    }
    if let Some(tolerance) = &mut layout.tolerance {
        of_measured_tiles(tolerance, film.measurement.as_ref().map(|(errors, _)| errors), has_sizes);
    }
    layout.history.push(format!(
        "{PROGRAM} assign: measured tiles in \"{}\" (sha256 {}), RMS displacement error {:.5} mm, in the order of the list \
         {:.5} mm",
        film.layout.name,
        &film.layout.sha256[..12],
        film.found.rms_mm,
        film.found.in_order_rms_mm,
    ));
    let text = layout.to_compact_toml();
    Layout::parse(&text, &format!("the film of {}", args.measured.display()))?;
    Ok(text)
}

/// Leaves the errors of laying. Strength and direction are known but for the errors of the measurements,
/// and so are sides if they were measured.
fn of_measured_tiles(tolerance: &mut FilmTolerance, errors: Option<&MeasurementErrors>, has_sizes: bool) {
    let errors = errors.copied().unwrap_or_default();
    for tile in &mut tolerance.tiles {
        tile.strength = Distribution::normal(errors.strength);
        tile.direction_rad = [Distribution::normal(errors.direction_rad), Distribution::normal(errors.direction_rad)];
        if has_sizes {
            tile.size_mm = std::array::from_fn(|_| Distribution::normal(errors.size_mm.unwrap_or(0.0)));
        }
    }
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
