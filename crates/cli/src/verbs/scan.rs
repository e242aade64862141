//! `magsplice scan`: compares a measured scan with the layout.

use std::path::{Path, PathBuf};

use magsplice::layout::Layout;
use magsplice::prelude::{DVec3, Grid};
use magsplice::results::{ColumnQuantity, FieldAtPoints, Points, Source, Table};
use magsplice::scan::{ScanError, fit_scan};
use magsplice::{Film, Stage};

use crate::args::formats::{TableFormat, TextOrJson};
use crate::args::sensor::ScanArgs;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::readings;
use crate::json::scan::ScanJson;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::sensor::scanned_film::ScannedFilm;
use crate::text::number::number;
use crate::words::{film_failure, no_field};
use crate::{json, remarks, text};

pub(crate) fn run(args: &ScanArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_TILES, quiet, &progress)?;
    let film = prepare(&args.layout, &layout, &progress, &remarks::teller(quiet, &progress))?;
    let inputs: Vec<&Path> = [&args.layout, &args.scan].into_iter().map(PathBuf::as_path).collect();
    let mut output = Output::open(args.result.output.as_deref(), &inputs)?;
    let save = match args.save.as_deref() {
        Some(path) => {
            let format: TableFormat = choice::choose(None, Some(path), None)?;
            choice::accept(format, Some(path), false)?;
            Some((format, Output::open(Some(path), &inputs)?))
        }
        None => None,
    };
    #[cfg(feature = "report")]
    let figures = super::scan_figures::open(args, &inputs)?;
    let groups = [readings::POSITIONS, readings::flux_densities(None)];
    let (rows, lines) = readings::read_all(&args.scan, &groups)?;
    let (points, readings_t): (Vec<DVec3>, Vec<DVec3>) =
        rows.into_iter().map(|[point, reading]| (point, reading)).unzip();

    progress.show(Stage::uncounted("fitting the scan"));
    let failed = |error| film_failure(&args.layout, &layout, error);
    let sensed = film.sensed_field(&box_of(&points)).map_err(failed)?;
    let fit = fit_scan(sensed.clone(), &points, &readings_t, args.free())
        .map_err(|error| refused(args, &layout, &lines, error))?;
    let scanned = ScannedFilm::new(&film, &sensed, &points, &readings_t, lines, fit).map_err(failed)?;
    #[cfg(feature = "report")]
    if let Some(folder) = figures {
        super::scan_figures::draw(args, &film, &scanned, folder)?;
    }
    progress.end();
    if let Some((format, mut file)) = save {
        let result = table(&film, &scanned);
        table::write(
            &result,
            &FieldAtPoints { source: Source::of(&film), points: result.rows().len() },
            format,
            &mut file,
        )?;
        file.finish()?;
    }
    let result = match args.result.format {
        TextOrJson::Text => text::scan::scan(&film, args, &scanned),
        TextOrJson::Json => json::pretty(&ScanJson::new(&film, &scanned)),
    };
    output.write(|w| w.write_all(result.as_bytes()))?;
    output.finish()?;
    if !quiet {
        tell_outliers(args, &scanned);
        tell_implausible(args, &scanned, &layout);
    }
    Ok(())
}

/// The corners of the box around the points of a scan.
fn box_of(points: &[DVec3]) -> Grid {
    let lower = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let upper = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
    let counts = [0, 1, 2].map(|axis| if lower[axis] < upper[axis] { 2 } else { 1 });
    Grid::new(lower, upper, counts).expect("points of a file are finite")
}

fn refused(args: &ScanArgs, layout: &Layout, lines: &[u64], error: ScanError) -> Failure {
    let path = args.scan.clone();
    let ScanError::Points(errors) = error else {
        return Failure::Points { path, message: error.to_string() };
    };
    let mut faults = FaultList::default();
    for error in errors.0 {
        let (line, cause) = (lines[error.index], no_field(error.cause, layout));
        faults.add(line, format!("line {line}: {cause}"));
    }
    faults.failure(path.display().to_string())
}

/// Strengths of a film that was made, over that of its layout: magnets of half or twice the
/// strength were not ordered.
const PLAUSIBLE_STRENGTHS: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// Residual over the noise of the sensor from which on the film is not as ordered. The deviation of
/// the residuals is right to a per cent for a scan of thousands of readings, and the noise that a
/// datasheet states to a factor of two.
const MOST_RESIDUAL: f64 = 3.0;

/// Says on standard error if the fit is hardly that of this film.
fn tell_implausible(args: &ScanArgs, scanned: &ScannedFilm, layout: &Layout) {
    let scan = args.scan.display();
    let strength = scanned.fit.parameters.strength;
    if !PLAUSIBLE_STRENGTHS.contains(&strength) {
        failure::tell(&format!(
            "{scan}: the fitted strength is {} times that of the layout: the scan is of another film, or its unit is \
             not the one of its columns, or it is far from where it is said to be\n",
            number(strength)
        ));
    }
    let noise_t = layout.sensor.as_ref().map_or(0.0, |sensor| sensor.element.deviation_t().max_element());
    let ratio = scanned.fit.noise_t / noise_t;
    if noise_t > 0.0 && ratio > MOST_RESIDUAL {
        failure::tell(&format!(
            "{scan}: the residual is {} times the noise of the sensor: the film differs from the layout, or the \
             positions from those stated\n",
            number(ratio)
        ));
    }
}

/// The readings with what was simulated.
fn table(film: &Film, scanned: &ScannedFilm) -> Table {
    let column = |name, components, values: &[DVec3]| ColumnQuantity {
        name,
        components,
        values: values.iter().flat_map(DVec3::to_array).collect(),
    };
    let difference: Vec<DVec3> = scanned
        .corrected_t
        .iter()
        .zip(&scanned.simulated_t)
        .map(|(corrected, simulated)| *corrected - *simulated)
        .collect();
    let is_outlier = |index: usize| scanned.fit.outliers.binary_search(&index).is_ok();
    let outliers = (0..scanned.places_mm.len()).map(|index| f64::from(u8::from(is_outlier(index)))).collect();
    let columns = vec![
        column("b_t", &["bx_t", "by_t", "bz_t"], &scanned.corrected_t),
        column("simulated_b_t", &["simulated_bx_t", "simulated_by_t", "simulated_bz_t"], &scanned.simulated_t),
        column("residual_b_t", &["residual_bx_t", "residual_by_t", "residual_bz_t"], &difference),
        ColumnQuantity { name: "outlier", components: &["outlier"], values: outliers },
    ];
    let points = Points::Scattered(scanned.places_mm.clone());
    Table::new(points, columns, Source::of(film).metadata()).expect("a value for each point")
}

/// Names the readings that were left out.
fn tell_outliers(args: &ScanArgs, scanned: &ScannedFilm) {
    let mut faults = FaultList::default();
    for &index in &scanned.fit.outliers {
        let (line, residual) = (scanned.lines[index], scanned.fit.residuals_t[index] * 1e6);
        let DVec3 { x, y, z } = residual;
        faults.add(line, format!("line {line}: left out, because it is off by ({x:.1}, {y:.1}, {z:.1}) uT"));
    }
    if !faults.is_empty() {
        failure::tell(&faults.remarks(&args.scan.display().to_string()));
    }
}
