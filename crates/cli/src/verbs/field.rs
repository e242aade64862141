//! `magsplice field`: computes the field at points.

use std::io::{IsTerminal, stdout};
use std::mem;
use std::path::{Path, PathBuf};

use magsplice::field::Scene;
use magsplice::magnet::{Accuracy, PointErrors, Quantity};
use magsplice::prelude::{DMat3, DVec3};
use magsplice::{Film, Stage};
use magsplice_export::{Metadata, Points, Table, csv};

use crate::args::evaluate::{FieldArgs, QuantityArg};
use crate::args::formats::TableFormat;
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::json::field::FieldJson;
use crate::output::destination::{Output, is_standard};
use crate::output::{choice, table};
use crate::point_file::{self, BATCH, PointFile};
use crate::progress::ProgressLine;
use crate::remarks;
use crate::words::{no_field, no_points};

pub(crate) fn run(args: &FieldArgs, quiet: bool) -> Result<(), Failure> {
    // No progress line between results on the same terminal, nor between points that a person types.
    let results_on_terminal = args.output.as_deref().is_none_or(is_standard) && stdout().is_terminal();
    let visible = !quiet && !results_on_terminal && !point_file::are_typed(args.points.as_deref());
    let progress = ProgressLine::start(visible);
    let subjects = if args.points.is_some() { remarks::OF_TILES } else { remarks::OF_FIELDS };
    let layout = remarks::read_layout(&args.layout, subjects, quiet, &progress)?;
    let accuracy = match args.quantity {
        QuantityArg::B | QuantityArg::H => args.accuracy.accuracy(),
        // These are always exact, and the metadata must say so.
        QuantityArg::J | QuantityArg::Gradient => Accuracy::Exact,
    };
    let film = Film::new(&layout).with_accuracy(accuracy);
    match &args.points {
        Some(path) => at_points(args, &film, path, &progress),
        None => on_grid(args, &film, &progress),
    }
}

fn at_points(args: &FieldArgs, film: &Film, path: &Path, progress: &ProgressLine) -> Result<(), Failure> {
    let mut file = PointFile::open(path)?;
    let mut writer = FieldWriter::open(args, film, Points::Scattered(Vec::new()))?;
    let mut faults = FaultList::default();
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    let mut done = 0;
    loop {
        let more = file.read(BATCH, &mut points, &mut lines, &mut faults)?;
        let errors = writer.evaluate(film.scene(), &points, faults.is_empty())?;
        for error in errors.0 {
            let (line, cause) = (lines[error.index], no_field(error.cause, film.layout()));
            let p = error.point;
            faults.add(line, format!("line {line}: ({}, {}, {}) mm: {cause}", p.x, p.y, p.z));
        }
        done += points.len();
        if writer.format != TableFormat::Csv && done > point_file::MAX_HELD_POINTS {
            return Err(point_file::too_many_points(path));
        }
        progress.show(Stage { name: "field", done, of: None, unit: "points" });
        if !more {
            break;
        }
    }
    if faults.is_empty() { writer.finish(film) } else { Err(faults.failure(path.display().to_string())) }
}

fn on_grid(args: &FieldArgs, film: &Film, progress: &ProgressLine) -> Result<(), Failure> {
    let grid = film.volume().map_err(|error| no_points(&args.layout, error))?.grid;
    let mut writer = FieldWriter::open(args, film, Points::Grid(grid))?;
    let mut faults = FaultList::default();
    let mut add = |errors: PointErrors| {
        for error in errors.0 {
            let (p, cause) = (error.point, no_field(error.cause, film.layout()));
            faults.add(0, format!("point ({}, {}, {}) mm of the working volume: {cause}", p.x, p.y, p.z));
        }
        faults.is_empty()
    };
    match (film.scene().accuracy(), quantity(args.quantity)) {
        // The methods that a tolerance allows need the whole grid at once.
        (Accuracy::Within(_), Some(quantity)) => {
            let points: Vec<DVec3> = grid.points().collect();
            let mut field = vec![DVec3::ZERO; points.len()];
            progress.show(Stage::uncounted("field"));
            let evaluated = film.scene().field_on_grid_into(quantity, &grid, &mut field);
            add(writer.add(evaluated, &points, field.iter().flat_map(DVec3::to_array), true)?);
        }
        _ => {
            let mut complete = true;
            for start in (0..grid.len()).step_by(BATCH) {
                progress.show(Stage { name: "field", done: start, of: Some(grid.len()), unit: "points" });
                let points: Vec<DVec3> = (start..grid.len().min(start + BATCH)).map(|i| grid.point(i)).collect();
                complete = add(writer.evaluate(film.scene(), &points, complete)?);
            }
        }
    }
    if faults.is_empty() { writer.finish(film) } else { Err(faults.failure(args.layout.display().to_string())) }
}

/// Evaluates the field and writes it: CSV batch by batch, other formats at the end.
struct FieldWriter {
    output: Output,
    format: TableFormat,
    quantity: QuantityArg,
    /// Points and values that are not written yet.
    points: Points,
    values: Vec<f64>,
    metadata: Metadata,
}

impl FieldWriter {
    /// Opens the output. `points` are all points of the result, or empty if they are not known yet.
    fn open(args: &FieldArgs, film: &Film, points: Points) -> Result<FieldWriter, Failure> {
        let format = choice::choose(args.format, args.output.as_deref(), Some(TableFormat::Csv))?;
        choice::accept(format, args.output.as_deref(), matches!(points, Points::Grid(_)))?;
        let inputs: Vec<&Path> = std::iter::once(&args.layout).chain(&args.points).map(PathBuf::as_path).collect();
        let output = Output::open(args.output.as_deref(), &inputs)?;
        let (values, metadata) = (Vec::new(), table::film_metadata(film));
        let mut writer = FieldWriter { output, format, quantity: args.quantity, points, values, metadata };
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

    /// Evaluates further points, and adds their rows if all rows before are `complete`. Returns the
    /// points without a field.
    fn evaluate(&mut self, scene: &Scene, points: &[DVec3], complete: bool) -> Result<PointErrors, Failure> {
        let Some(quantity) = quantity(self.quantity) else {
            let mut gradient = vec![DMat3::ZERO; points.len()];
            let evaluated = scene.gradient_into(Quantity::FluxDensity, points, &mut gradient);
            // Row by row: the derivatives of one component of B together.
            return self.add(evaluated, points, gradient.iter().flat_map(|g| g.transpose().to_cols_array()), complete);
        };
        let mut field = vec![DVec3::ZERO; points.len()];
        let evaluated = scene.field_into(quantity, points, &mut field);
        self.add(evaluated, points, field.iter().flat_map(DVec3::to_array), complete)
    }

    /// Adds the rows of points that were evaluated, as [`FieldWriter::evaluate`] does.
    fn add(
        &mut self,
        evaluated: Result<(), PointErrors>,
        points: &[DVec3],
        values: impl Iterator<Item = f64>,
        complete: bool,
    ) -> Result<PointErrors, Failure> {
        if let Err(errors) = evaluated {
            return Ok(errors);
        }
        if complete {
            if let Points::Scattered(known) = &mut self.points {
                known.extend(points);
            }
            self.values.extend(values);
            if self.format == TableFormat::Csv {
                let table = self.take_table();
                self.output.write(|w| csv::rows(&table, w))?;
            }
        }
        Ok(PointErrors(Vec::new()))
    }

    fn finish(mut self, film: &Film) -> Result<(), Failure> {
        if self.format != TableFormat::Csv {
            let table = self.take_table();
            table::write(&table, &FieldJson::new(film, &table), self.format, &mut self.output)?;
        }
        self.output.finish()
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
