//! `magsplice field`: the field at points.

use std::io::{IsTerminal, stdin, stdout};
use std::mem;
use std::path::{Path, PathBuf};

use magsplice::field::{Accuracy, Cause, PointErrors, Quantity, Scene};
use magsplice::layout::Layout;
use magsplice::prelude::{DMat3, DVec3};
use magsplice::{Film, FilmError, Stage};
use magsplice_export::{ColumnQuantity, Metadata, Points, Table, csv};
use serde::Serialize;

use crate::args::{FieldArgs, QuantityArg};
use crate::failure::Failure;
use crate::formats::{self, TableFormat};
use crate::output::Output;
use crate::points::{Faults, PointFile};
use crate::progress::Progress;
use crate::verbs::decouple::Source;

/// Points evaluated and written at a time. Bounds memory, and is enough work for every thread.
const BATCH: usize = 1 << 16;

pub(crate) fn run(args: &FieldArgs, quiet: bool) -> Result<(), Failure> {
    // Not among results on the same terminal, nor among points that are typed there.
    let results = args.output.as_deref().is_none_or(is_standard) && stdout().is_terminal();
    let points = args.points.as_deref().is_some_and(is_standard) && stdin().is_terminal();
    let progress = Progress::start(!quiet && !results && !points);
    let layout = Layout::read(&args.layout)?;
    let accuracy = match args.quantity {
        QuantityArg::B | QuantityArg::H => args.accuracy.get(),
        // These are so in any case, and the file says it.
        QuantityArg::J | QuantityArg::Gradient => Accuracy::Exact,
    };
    let film = Film::new(&layout).with_accuracy(accuracy);
    match &args.points {
        Some(path) => at_points(args, &film, path, &progress),
        None => on_grid(args, &film, &progress),
    }
}

fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

fn at_points(args: &FieldArgs, film: &Film, path: &Path, progress: &Progress) -> Result<(), Failure> {
    let mut file = PointFile::open(path)?;
    let mut results = Results::begin(args, film, Points::Scattered(Vec::new()))?;
    let mut faults = Faults::default();
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    let mut done = 0;
    loop {
        let more = file.read(BATCH, &mut points, &mut lines, &mut faults)?;
        let errors = results.rows(film.scene(), &points, faults.is_empty())?;
        for error in errors.0 {
            let (line, cause) = (lines[error.index], cause_in_words(error.cause, film.layout()));
            let p = error.point;
            faults.add(line, format!("line {line}: ({}, {}, {}) mm: {cause}", p.x, p.y, p.z));
        }
        done += points.len();
        progress.show(Stage { name: "field", done, of: None, unit: "points" });
        if !more {
            break;
        }
    }
    if faults.is_empty() { results.finish(film) } else { Err(faults.failure(path.display().to_string())) }
}

fn on_grid(args: &FieldArgs, film: &Film, progress: &Progress) -> Result<(), Failure> {
    let missing = |error: FilmError| match error {
        FilmError::Missing(_) => Failure::Points {
            path: args.layout.clone(),
            message: "the layout has no [volume] table to take points from: add one, or give --points".to_owned(),
        },
        error => Failure::Film { layout: args.layout.clone(), error },
    };
    let grid = film.volume().map_err(missing)?.grid;
    let mut results = Results::begin(args, film, Points::Grid(grid))?;
    let mut faults = Faults::default();
    let mut add = |errors: PointErrors| {
        for error in errors.0 {
            let (p, cause) = (error.point, cause_in_words(error.cause, film.layout()));
            faults.add(0, format!("point ({}, {}, {}) mm of the working volume: {cause}", p.x, p.y, p.z));
        }
        faults.is_empty()
    };
    match (film.scene().accuracy(), quantity(args.quantity)) {
        // The cheaper ways see the grid as a whole.
        (Accuracy::Within(_), Some(quantity)) => {
            let points: Vec<DVec3> = grid.points().collect();
            let mut field = vec![DVec3::ZERO; points.len()];
            progress.show(Stage::uncounted("field"));
            let evaluated = film.scene().field_on_grid_into(quantity, &grid, &mut field);
            add(results.add(evaluated, &points, field.iter().flat_map(DVec3::to_array), true)?);
        }
        _ => {
            let mut complete = true;
            for start in (0..grid.len()).step_by(BATCH) {
                progress.show(Stage { name: "field", done: start, of: Some(grid.len()), unit: "points" });
                let points: Vec<DVec3> = (start..grid.len().min(start + BATCH)).map(|i| grid.point(i)).collect();
                complete = add(results.rows(film.scene(), &points, complete)?);
            }
        }
    }
    if faults.is_empty() { results.finish(film) } else { Err(faults.failure(args.layout.display().to_string())) }
}

/// Why there is no field, with the tile's name.
pub(crate) fn cause_in_words(cause: Cause, layout: &Layout) -> String {
    match cause {
        Cause::Unbounded { tile } => {
            format!("the field is unbounded there, on an exposed edge of tile \"{}\"", layout.tiles[tile].name)
        }
        Cause::Unresolved { tile } => format!(
            "the gradient cannot be resolved on an edge that tile \"{}\" shares with others",
            layout.tiles[tile].name
        ),
        other => other.to_string(),
    }
}

/// The field on its way out: rows of CSV batch by batch, other formats as a whole.
struct Results {
    output: Output,
    format: TableFormat,
    quantity: QuantityArg,
    /// The points and values that are not written yet.
    points: Points,
    values: Vec<f64>,
    metadata: Metadata,
}

impl Results {
    /// Opens the output. `points` are those of the table if they are known, else none.
    fn begin(args: &FieldArgs, film: &Film, points: Points) -> Result<Results, Failure> {
        let format = formats::choose(args.format, args.output.as_deref(), Some(TableFormat::Csv))?;
        formats::accept(format, args.output.as_deref(), matches!(points, Points::Grid(_)))?;
        let inputs: Vec<&Path> = std::iter::once(&args.layout).chain(&args.points).map(PathBuf::as_path).collect();
        let output = Output::open(args.output.as_deref(), &inputs)?;
        let (values, metadata) = (Vec::new(), formats::metadata(film));
        let mut results = Results { output, format, quantity: args.quantity, points, values, metadata };
        if format == TableFormat::Csv {
            results.points = Points::Scattered(Vec::new());
            let empty = results.take_table();
            results.output.write(|w| csv::header(&empty, w))?;
        }
        Ok(results)
    }

    /// The points and values that are not written yet, as a table.
    fn take_table(&mut self) -> Table {
        let (name, components) = self.quantity.names();
        let points = mem::replace(&mut self.points, Points::Scattered(Vec::new()));
        let quantity = ColumnQuantity { name, components, values: mem::take(&mut self.values) };
        Table::new(points, vec![quantity], mem::take(&mut self.metadata)).expect("every point has its values")
    }

    /// Evaluates further points and, as long as there is a table to complete, adds their rows.
    fn rows(&mut self, scene: &Scene, points: &[DVec3], complete: bool) -> Result<PointErrors, Failure> {
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
            let report = Report {
                source: Source::of(film),
                points: table.points().len(),
                shape: table.points().shape(),
                columns: &table,
            };
            formats::write(&table, &report, self.format, &mut self.output)?;
        }
        self.output.finish()
    }
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    source: Source<'a>,
    points: usize,
    /// Of the columns as an array: counts along x, y, z on a grid.
    shape: Vec<usize>,
    columns: &'a Table,
}

/// `None` for the gradient.
fn quantity(quantity: QuantityArg) -> Option<Quantity> {
    match quantity {
        QuantityArg::B => Some(Quantity::FluxDensity),
        QuantityArg::H => Some(Quantity::FieldStrength),
        QuantityArg::J => Some(Quantity::Polarization),
        QuantityArg::Gradient => None,
    }
}
