//! `magsplice field`: computes the field at points.

use std::io::{IsTerminal, stdout};
use std::mem;
use std::path::{Path, PathBuf};

use magsplice::field::Scene;
use magsplice::layout::Layout;
use magsplice::magnet::{Accuracy, PointError, PointErrorCause, PointErrors, Quantity};
use magsplice::prelude::{DMat3, DVec3};
use magsplice::{Film, Stage};
use magsplice_export::{Metadata, Points, Table, csv};

use crate::args::evaluate::{FieldArgs, QuantityArg, UnboundedArg};
use crate::args::formats::TableFormat;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::points::{self, BATCH, PointFile};
use crate::json::field::FieldJson;
use crate::output::destination::{Output, is_standard};
use crate::output::{choice, table};
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::remarks;
use crate::words::{no_field, no_points};

pub(crate) fn run(args: &FieldArgs, quiet: bool) -> Result<(), Failure> {
    // No progress line between results on the same terminal, nor between points that a person
    // types.
    let results_on_terminal = args.output.as_deref().is_none_or(is_standard) && stdout().is_terminal();
    let visible = !quiet && !results_on_terminal && !points::are_typed(args.points.path());
    let progress = ProgressLine::start(visible);
    let subjects = if args.points.path().is_some() { remarks::OF_TILES } else { remarks::OF_FIELDS };
    let layout = remarks::read_layout(&args.layout, subjects, quiet, &progress)?;
    let accuracy = match args.quantity {
        QuantityArg::B | QuantityArg::H => args.accuracy.accuracy(),
        // These are always exact, and the metadata must say so.
        QuantityArg::J | QuantityArg::Gradient => Accuracy::Exact,
    };
    let show = |stage: Stage| progress.show(stage);
    let film = prepare(&args.layout, &layout, &show, &remarks::teller(quiet, &progress))?.with_accuracy(accuracy);
    match args.points.path() {
        Some(path) => at_points(args, &film, path, &progress, quiet),
        None => on_grid(args, &film, &progress, quiet),
    }
}

fn at_points(args: &FieldArgs, film: &Film, path: &Path, progress: &ProgressLine, quiet: bool) -> Result<(), Failure> {
    let mut file = PointFile::open(path, args.points.unit, &remarks::teller(quiet, progress))?;
    let mut writer = FieldWriter::open(args, film, Points::Scattered(Vec::new()))?;
    let mut faults = PointFaults::new(args.unbounded);
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    let mut done = 0;
    loop {
        let more = file.read(BATCH, &mut points, &mut lines, &mut faults.errors)?;
        writer.evaluate(film.scene(), &points, &mut faults, |error, cause| {
            let (line, p) = (lines[error.index], error.point);
            (line, format!("line {line}: ({}, {}, {}) mm: {cause}", p.x, p.y, p.z))
        })?;
        done += points.len();
        if writer.format != TableFormat::Csv && done > points::MAX_HELD_POINTS {
            return Err(points::too_many_points(path));
        }
        progress.show(Stage { name: "field", done, of: None, unit: "points" });
        if !more {
            break;
        }
    }
    writer.finish(film, faults, path, progress, quiet)
}

fn on_grid(args: &FieldArgs, film: &Film, progress: &ProgressLine, quiet: bool) -> Result<(), Failure> {
    let grid = film.volume().map_err(|error| no_points(&args.layout, error))?.grid;
    let mut writer = FieldWriter::open(args, film, Points::Grid(grid))?;
    let mut faults = PointFaults::new(args.unbounded);
    let fault = |error: &PointError, cause: &str| {
        let p = error.point;
        (0, format!("point ({}, {}, {}) mm of the working volume: {cause}", p.x, p.y, p.z))
    };
    match (film.scene().accuracy(), quantity(args.quantity)) {
        // The methods that a tolerance allows need the whole grid at once.
        (Accuracy::Within(_), Some(quantity)) => {
            let points: Vec<DVec3> = grid.points().collect();
            let mut field = vec![DVec3::ZERO; points.len()];
            let evaluated = film.with_counted_points(points.len(), |progress| {
                film.scene().field_on_grid_with_progress(quantity, &grid, &mut field, progress)
            });
            writer.add(evaluated, &points, field.iter().flat_map(DVec3::to_array), &mut faults, fault)?;
        }
        _ => {
            for start in (0..grid.len()).step_by(BATCH) {
                progress.show(Stage { name: "field", done: start, of: Some(grid.len()), unit: "points" });
                let points: Vec<DVec3> = (start..grid.len().min(start + BATCH)).map(|i| grid.point(i)).collect();
                writer.evaluate(film.scene(), &points, &mut faults, fault)?;
            }
        }
    }
    writer.finish(film, faults, &args.layout, progress, quiet)
}

/// Points and lines without a field: those that stop the program, and those written as NaN.
struct PointFaults {
    unbounded: UnboundedArg,
    errors: FaultList,
    written_as_nan: FaultList,
}

impl PointFaults {
    fn new(unbounded: UnboundedArg) -> PointFaults {
        PointFaults { unbounded, errors: FaultList::default(), written_as_nan: FaultList::default() }
    }

    /// Adds the points without a field. `fault` gives the line of a point and the words for it.
    fn add(&mut self, errors: PointErrors, layout: &Layout, fault: impl Fn(&PointError, &str) -> (u64, String)) {
        for error in errors.0 {
            let (line, words) = fault(&error, &no_field(error.cause, layout));
            let on_edge = matches!(error.cause, PointErrorCause::Unbounded { .. } | PointErrorCause::Unresolved { .. });
            if on_edge && self.unbounded == UnboundedArg::Nan {
                self.written_as_nan.add(line, format!("{words}; written as NaN"));
            } else {
                self.errors.add(line, words);
            }
        }
    }
}

/// Evaluates the field and writes it: CSV batch by batch, other formats at the end.
struct FieldWriter<'a> {
    layout: &'a Layout,
    output: Output,
    format: TableFormat,
    quantity: QuantityArg,
    /// Points and values that are not written yet.
    points: Points,
    values: Vec<f64>,
    metadata: Metadata,
}

impl<'a> FieldWriter<'a> {
    /// Opens the output. `points` are all points of the result, or empty if they are not known yet.
    fn open(args: &FieldArgs, film: &Film<'a>, points: Points) -> Result<FieldWriter<'a>, Failure> {
        let format = choice::choose(args.format, args.output.as_deref(), Some(TableFormat::Csv))?;
        choice::accept(format, args.output.as_deref(), matches!(points, Points::Grid(_)))?;
        let inputs: Vec<&Path> = std::iter::once(&args.layout).chain(&args.points.file).map(PathBuf::as_path).collect();
        // A later point may have no field, and then nothing may have been printed.
        let output = Output::open(args.output.as_deref(), &inputs)?.held_back();
        let (values, metadata) = (Vec::new(), table::film_metadata(film));
        let layout = film.layout();
        let mut writer = FieldWriter { layout, output, format, quantity: args.quantity, points, values, metadata };
        if format == TableFormat::Csv {
            writer.points = Points::Scattered(Vec::new());
            let empty = writer.take_table();
            writer.output.write(|w| csv::header(&empty, w))?;
        }
        Ok(writer)
    }

    /// Takes the points and values that are not written yet, as a table.
    fn take_table(&mut self) -> Table {
        let points = mem::replace(&mut self.points, Points::Scattered(Vec::new()));
        let columns = table::columns(self.quantity, mem::take(&mut self.values));
        Table::new(points, vec![columns], mem::take(&mut self.metadata)).expect("every point has its values")
    }

    /// Evaluates further points, and adds their rows if no point before is an error. Adds points
    /// without a field to `faults`, in the words of `fault`.
    fn evaluate(
        &mut self,
        scene: &Scene,
        points: &[DVec3],
        faults: &mut PointFaults,
        fault: impl Fn(&PointError, &str) -> (u64, String),
    ) -> Result<(), Failure> {
        let Some(quantity) = quantity(self.quantity) else {
            let mut gradient = vec![DMat3::ZERO; points.len()];
            let evaluated = scene.gradient_into(Quantity::FluxDensity, points, &mut gradient);
            // Row by row: the derivatives of one component of B together.
            let values = gradient.iter().flat_map(|g| g.transpose().to_cols_array());
            return self.add(evaluated, points, values, faults, fault);
        };
        let mut field = vec![DVec3::ZERO; points.len()];
        let evaluated = scene.field_into(quantity, points, &mut field);
        self.add(evaluated, points, field.iter().flat_map(DVec3::to_array), faults, fault)
    }

    /// Adds the rows of points that were evaluated, as [`FieldWriter::evaluate`] does.
    fn add(
        &mut self,
        evaluated: Result<(), PointErrors>,
        points: &[DVec3],
        values: impl Iterator<Item = f64>,
        faults: &mut PointFaults,
        fault: impl Fn(&PointError, &str) -> (u64, String),
    ) -> Result<(), Failure> {
        if let Err(errors) = evaluated {
            faults.add(errors, self.layout, fault);
        }
        // Points without a field have NaN for a value.
        if faults.errors.is_empty() {
            if let Points::Scattered(known) = &mut self.points {
                known.extend(points);
            }
            self.values.extend(values);
            if self.format == TableFormat::Csv {
                let table = self.take_table();
                self.output.write(|w| csv::rows(&table, w))?;
            }
        }
        Ok(())
    }

    /// Completes the result. `place` is the file that the points are from.
    fn finish(
        mut self,
        film: &Film,
        faults: PointFaults,
        place: &Path,
        progress: &ProgressLine,
        quiet: bool,
    ) -> Result<(), Failure> {
        if !faults.errors.is_empty() {
            return Err(faults.errors.failure(place.display().to_string()));
        }
        if self.format != TableFormat::Csv {
            let table = self.take_table();
            table::write(&table, &FieldJson::new(film, &table), self.format, &mut self.output)?;
        }
        self.output.finish()?;
        progress.end();
        if !faults.written_as_nan.is_empty() && !quiet {
            failure::tell(&faults.written_as_nan.remarks(&place.display().to_string()));
        }
        Ok(())
    }
}

/// The library's quantity; `None` for the gradient.
fn quantity(quantity: QuantityArg) -> Option<Quantity> {
    match quantity {
        QuantityArg::B => Some(Quantity::FluxDensity),
        QuantityArg::H => Some(Quantity::FieldStrength),
        QuantityArg::J => Some(Quantity::Polarization),
        QuantityArg::Gradient => None,
    }
}
