//! `magsplice diagnose`: tells which tiles of a film that was made are wrong.

use std::path::{Path, PathBuf};

use magsplice::FilmError;
use magsplice::layout::{FilmTolerance, Layout, TileForm};
use magsplice::prelude::DVec3;
use magsplice::scan::DiagnosisError;

use crate::args::diagnose::{DiagnoseArgs, DiagnoseFormat};
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::readings;
use crate::json::diagnose::DiagnoseJson;
use crate::output::destination::Output;
#[cfg(feature = "report")]
use crate::output::figure_file;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::sensor::diagnosed_film::{self, DiagnosedFilm};
use crate::text::number::number;
use crate::words::{film_failure, no_field};
use crate::{json, remarks, text};

pub(crate) fn run(args: &DiagnoseArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let original = remarks::read_layout(&args.layout, remarks::OF_TILES, quiet, &progress)?;
    let mut layout = original.clone();
    args.preset.apply(&mut layout);
    if args.as_ordered {
        layout.tolerance = None;
    }
    let inputs: Vec<&Path> = [&args.layout, &args.scan].into_iter().map(PathBuf::as_path).collect();
    let found_file = args.output.as_deref().map(|path| Output::open(Some(path), &inputs)).transpose()?;
    #[cfg(feature = "report")]
    let figure = figure_file::open(args.figure.as_deref(), &inputs)?;
    let noise_t = noise_t(args, &layout)?;
    let groups = [readings::POSITIONS, readings::flux_densities(None)];
    let (rows, lines) = readings::read_all(&args.scan, &groups)?;
    let (points_mm, readings_t): (Vec<DVec3>, Vec<DVec3>) =
        rows.into_iter().map(|[point, reading]| (point, reading)).unzip();
    let element = layout.sensor.as_ref().map(|sensor| sensor.element).unwrap_or_default();
    if !quiet && (element.plates != [DVec3::ZERO; 3] || element.active_area != [0.0; 2]) {
        failure::tell(&format_args!(
            "{}: the plates of [sensor] count as points at the positions of the scan",
            args.layout.display()
        ));
    }

    let ordinary = ordinary(&layout);
    let has_ordinary = ordinary != FilmTolerance::default();
    let ordered = prepare(&args.layout, &layout, &progress, &remarks::teller(quiet, &progress))?;
    let diagnosis = ordered
        .diagnose(points_mm, &readings_t, args.noise, args.free(), args.false_alarm)
        .map_err(|error| refused(args, &layout, &lines, error))?;
    let (recoil, readings) = (ordered.recoil().cloned(), readings_t.len());
    progress.end();
    let film = DiagnosedFilm {
        layout: &layout,
        recoil,
        diagnosis,
        readings,
        noise_t,
        has_ordinary,
        false_alarm: args.false_alarm,
    };
    if let Some(mut file) = found_file {
        let scan = args.scan.file_name().map_or_else(|| "a scan".into(), |name| name.to_string_lossy());
        let folder = args.output.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        let origin = format!("the film of {}", args.scan.display());
        let text = film.found_layout(&original, &scan).to_edited_toml(TileForm::Plain, folder, &origin)?;
        file.write(|w| w.write_all(text.as_bytes()))?;
        file.finish()?;
    }
    #[cfg(feature = "report")]
    if let Some(file) = figure {
        file.write(super::diagnose_figure::draw(&film))?;
    }
    let result = match args.format {
        DiagnoseFormat::Text => text::diagnose::diagnosis(&film, args),
        DiagnoseFormat::Json => json::pretty(&DiagnoseJson::new(&film)),
        DiagnoseFormat::Csv => csv(&film),
    };
    // A layout on standard output leaves no room for anything else.
    if args.output.as_deref() != Some(Path::new("-")) {
        crate::output::destination::print(&result)?;
    }
    if !quiet && film.diagnosis.is_residual_too_large() {
        failure::tell(&format_args!(
            "{}: chi squared of the residual is {} times its expectation: the noise is larger than stated, the film has \
             errors of another kind, or the positions are not those stated{}",
            args.scan.display(),
            number(film.diagnosis.chi_squared / film.diagnosis.freedom as f64),
            if args.fit.is_empty() { " (--fit fits them)" } else { "" }
        ));
    }
    Ok(())
}

/// The noise of a flux density along each axis of the film.
fn noise_t(args: &DiagnoseArgs, layout: &Layout) -> Result<DVec3, Failure> {
    let of_sensor = layout.sensor.as_ref().map(|sensor| sensor.element.deviation_t() / sensor.element.gain.abs());
    match args.noise.map(|noise| noise.deviation_t).or(of_sensor).filter(|noise_t| noise_t.min_element() > 0.0) {
        Some(noise_t) => Ok(noise_t),
        None => Err(Failure::Points {
            path: args.layout.clone(),
            message: "the layout has no noise: give --noise, such as 10uT, or noise_ut or part in [sensor]".to_owned(),
        }),
    }
}

/// The errors that tiles and groups of tiles ordinarily have.
fn ordinary(layout: &Layout) -> FilmTolerance {
    let Some(tolerance) = &layout.tolerance else { return FilmTolerance::default() };
    FilmTolerance { tiles: tolerance.tiles.clone(), groups: tolerance.groups.clone(), ..FilmTolerance::default() }
}

fn refused(args: &DiagnoseArgs, layout: &Layout, lines: &[u64], error: FilmError) -> Failure {
    let path = args.scan.clone();
    match error {
        FilmError::Points(errors) => {
            let mut faults = FaultList::default();
            for error in errors.0 {
                let (line, cause) = (lines[error.index], no_field(error.cause, layout));
                faults.add(line, format!("line {line}: {cause}"));
            }
            faults.failure(path.display().to_string())
        }
        FilmError::Diagnosis(DiagnosisError::NoDerivative { tile, point: DVec3 { x, y, z } }) => Failure::Points {
            path,
            message: format!(
                "the field of tile \"{}\" has no derivatives at ({x}, {y}, {z}) mm, must be away from its edges",
                layout.tiles[tile].name
            ),
        },
        FilmError::Diagnosis(error) => Failure::Points { path, message: error.to_string() },
        error => film_failure(&args.layout, layout, error),
    }
}

/// One line for each component of each error.
fn csv(film: &DiagnosedFilm) -> String {
    let mut csv = "tile,kind,component,value,deviation,chi_squared\n".to_owned();
    for named in &film.diagnosis.named {
        for estimate in &named.components {
            csv += &format!(
                "\"{}\",{},{},{:?},{:?},{:?}\n",
                film.name(named.candidate.tile).replace('"', "\"\""),
                diagnosed_film::kind(named.candidate.kind),
                estimate.error.key(),
                estimate.error.shown(estimate.value),
                estimate.error.shown(estimate.deviation),
                named.chi_squared
            );
        }
    }
    csv
}
