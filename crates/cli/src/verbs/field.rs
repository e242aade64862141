//! `magsplice field`: computes the field at points.

use std::io::{IsTerminal, stdout};
use std::mem;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use magsplice::magnet::{Accuracy, PointError, PointErrorCause, PointErrors, Quantity};
use magsplice::prelude::DVec3;
use magsplice::results::{FieldAtPoints, Metadata, PointQuantity, Points, Source, Table};
use magsplice::{Film, Stage};
use magsplice_export::csv;

use crate::args::accuracy::AccuracyArgs;
use crate::args::formats::TableFormat;
use crate::args::numbers::point_mm;
use crate::args::points::PointsArgs;
use crate::csv_input::table::are_typed;
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::inputs::points::{self, BATCH, PointFile};
use crate::output::destination::{Output, is_standard};
use crate::output::{choice, table};
use crate::progress::ProgressLine;
use crate::remarks;
use crate::session::Session;
use crate::text::number::point;
use crate::words::no_field;

/// Compute the field at points, as a table.
///
/// The points are the grid of the layout's working volume, the points of a CSV file, or the points
/// of --at. Results keep the order of the points. Numbers are written with enough digits to read
/// back to the same number.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice field layouts/published-film.toml --points points.csv -o field.csv")]
pub(crate) struct FieldArgs {
    /// Layout file
    layout: PathBuf,
    #[command(flatten)]
    points: PointsArgs,
    /// A point, in mm, such as 0,0,-4; may be repeated
    #[arg(long, value_name = "X,Y,Z", value_parser = point_mm, allow_hyphen_values = true, conflicts_with = "points")]
    at: Vec<DVec3>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "TABLE")]
    output: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else csv]
    #[arg(long, value_enum)]
    format: Option<TableFormat>,
    /// Quantity to compute
    #[arg(long, value_enum, ignore_case = true, default_value = "b")]
    quantity: QuantityArg,
    /// Handling of points at which the field is unbounded, on exposed edges of tiles; for gradients
    /// also points on shared edges
    ///
    /// Edges parallel to J are bounded.
    #[arg(long, value_enum, ignore_case = true, default_value = "error")]
    unbounded: UnboundedArg,
    #[command(flatten)]
    accuracy: AccuracyArgs,
}

#[derive(Clone, Copy, ValueEnum)]
enum QuantityArg {
    /// Flux density B, in T
    B,
    /// Field strength H, in A/m
    H,
    /// Polarization J, in T
    J,
    /// Gradient of B: nine components, in T/mm
    Gradient,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum UnboundedArg {
    /// List the points and write nothing
    Error,
    /// Write NaN there (null in JSON) and list the points on standard error
    Nan,
}

pub(crate) fn run(args: &FieldArgs, quiet: bool) -> Result<(), Failure> {
    let quantity = PointQuantity::from(args.quantity);
    // No progress line between results on the same terminal, nor between points that a person
    // types.
    let results_on_terminal = args.output.as_deref().is_none_or(is_standard) && stdout().is_terminal();
    let visible = !quiet && !results_on_terminal && !are_typed(args.points.path());
    let has_points = args.points.path().is_some() || !args.at.is_empty();
    let subjects = if has_points { remarks::OF_TILES } else { remarks::OF_FIELDS };
    let session = Session::begin(&args.layout, subjects, quiet, ProgressLine::start(visible))?;
    let accuracy = if quantity.has_accuracy() { args.accuracy.accuracy() } else { Accuracy::Exact };
    let film = session.film()?.with_accuracy(accuracy);
    match args.points.path() {
        Some(path) => at_points(args, &session, &film, path),
        None if args.at.is_empty() => on_grid(args, &session, &film),
        None => at_given(args, &session, &film),
    }
}

/// Bytes for each point of a result that is not written point by point: its point, its field, and
/// the table; up to nine numbers of a gradient twice.
const HELD_BYTES: f64 = 168.0;

/// A working volume that is missing.
const OF_FIELD: &str = " to take points from: add one, or give --points or --at";

/// The field at the points of `--at`.
fn at_given(args: &FieldArgs, session: &Session, film: &Film) -> Result<(), Failure> {
    let mut writer = FieldWriter::open(args, film, Points::Scattered(Vec::new()))?;
    let (values, evaluated) = writer.quantity.values(film.scene(), &args.at);
    writer.add(&args.at, values, evaluated, |error, cause| {
        let p = error.point;
        (0, format!("point --at {},{},{} (mm): {cause}", p.x, p.y, p.z))
    })?;
    tell_faces(session, film, &args.at);
    writer.finish(session, &args.layout)
}

fn at_points(args: &FieldArgs, session: &Session, film: &Film, path: &Path) -> Result<(), Failure> {
    let mut file = PointFile::open(path, args.points.unit.as_ref(), &|remark| session.tell(remark))?;
    let mut writer = FieldWriter::open(args, film, Points::Scattered(Vec::new()))?;
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    let mut done = 0;
    loop {
        let more = file.read(BATCH, &mut points, &mut lines, &mut writer.errors)?;
        let (values, evaluated) = writer.quantity.values(film.scene(), &points);
        writer.add(&points, values, evaluated, |error, cause| {
            let (line, p) = (lines[error.index], error.point);
            (line, format!("line {line}: {} mm: {cause}", point(p)))
        })?;
        if done == 0 {
            tell_faces(session, film, &points);
        }
        done += points.len();
        if writer.format != TableFormat::Csv && done > points::MAX_HELD_POINTS {
            return Err(points::too_many_points(path));
        }
        film.tell(Stage { name: "field", done, of: None, unit: "points" });
        if !more {
            return writer.finish(session, path);
        }
    }
}

/// Remarks on points that are nearly on faces.
fn tell_faces(session: &Session, film: &Film, points_mm: &[DVec3]) {
    if let Some(remark) = film.remark_on_faces(points_mm) {
        session.tell(&remark);
    }
}

fn on_grid(args: &FieldArgs, session: &Session, film: &Film) -> Result<(), Failure> {
    let volume = session.volume(OF_FIELD)?;
    let grid = volume.grid;
    let mut writer = FieldWriter::open(args, film, Points::Grid(grid))?;
    let is_within = matches!(film.scene().accuracy(), Accuracy::Within(_));
    if is_within || writer.format != TableFormat::Csv {
        volume.check_memory(HELD_BYTES).map_err(|error| Failure::at(&args.layout, error))?;
    }
    let fault = |error: &PointError, cause: &str| {
        let p = error.point;
        (0, format!("point {} mm of the working volume: {cause}", point(p)))
    };
    if let (Accuracy::Within(_), PointQuantity::Field(quantity)) = (film.scene().accuracy(), writer.quantity) {
        // The methods that a tolerance allows need the whole grid at once.
        let points: Vec<DVec3> = grid.points().collect();
        let mut field = vec![DVec3::ZERO; points.len()];
        let evaluated = film.with_counted_points(points.len(), |progress| {
            film.scene().field_on_grid_with_progress(quantity, &grid, &mut field, progress)
        });
        writer.add(&points, field.iter().flat_map(DVec3::to_array).collect(), evaluated, fault)?;
        return writer.finish(session, &args.layout);
    }
    for start in (0..grid.len()).step_by(BATCH) {
        film.tell(Stage { name: "field", done: start, of: Some(grid.len()), unit: "points" });
        let points: Vec<DVec3> = (start..grid.len().min(start + BATCH)).map(|i| grid.point(i)).collect();
        let (values, evaluated) = writer.quantity.values(film.scene(), &points);
        writer.add(&points, values, evaluated, fault)?;
    }
    writer.finish(session, &args.layout)
}

/// Writes a field: CSV batch by batch, other formats at the end.
struct FieldWriter<'a> {
    film: &'a Film,
    output: Output,
    format: TableFormat,
    quantity: PointQuantity,
    unbounded: UnboundedArg,
    /// Points and values that are not written yet.
    points: Points,
    values: Vec<f64>,
    metadata: Metadata,
    /// Points and lines without a field that stop the program.
    errors: FaultList,
    /// Points without a field that are written as NaN.
    written_as_nan: FaultList,
}

impl<'a> FieldWriter<'a> {
    /// Opens the output. `points` are all points of the result, or empty if they are not known yet.
    fn open(args: &FieldArgs, film: &'a Film, points: Points) -> Result<FieldWriter<'a>, Failure> {
        let format = choice::choose(args.format, args.output.as_deref(), Some(TableFormat::Csv))?;
        choice::accept(format, args.output.as_deref(), matches!(points, Points::Grid(_)))?;
        let inputs: Vec<&Path> = std::iter::once(&args.layout).chain(&args.points.file).map(PathBuf::as_path).collect();
        let mut writer = FieldWriter {
            film,
            // A later point may have no field, and then nothing may have been printed.
            output: Output::open(args.output.as_deref(), &inputs)?.held_back(),
            format,
            quantity: args.quantity.into(),
            unbounded: args.unbounded,
            points,
            values: Vec::new(),
            metadata: Source::of(film).metadata(),
            errors: FaultList::default(),
            written_as_nan: FaultList::default(),
        };
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
        let columns = self.quantity.columns(mem::take(&mut self.values));
        Table::new(points, vec![columns], mem::take(&mut self.metadata))
    }

    /// Adds the rows of further points if no point before is an error. `fault` gives the line of a
    /// point without a field, which has NaN for a value, and the words for it.
    fn add(
        &mut self,
        points: &[DVec3],
        values: Vec<f64>,
        evaluated: Result<(), PointErrors>,
        fault: impl Fn(&PointError, &str) -> (u64, String),
    ) -> Result<(), Failure> {
        for error in evaluated.err().into_iter().flat_map(|errors| errors.0) {
            let (line, words) = fault(&error, &no_field(error.cause, self.film.layout()));
            let on_edge = matches!(error.cause, PointErrorCause::Unbounded { .. } | PointErrorCause::Unresolved { .. });
            if on_edge && self.unbounded == UnboundedArg::Nan {
                self.written_as_nan.add(line, format!("{words}; written as NaN"));
            } else {
                self.errors.add(line, words);
            }
        }
        if !self.errors.is_empty() {
            return Ok(());
        }
        if let Points::Scattered(known) = &mut self.points {
            known.extend(points);
        }
        self.values.extend(values);
        if self.format == TableFormat::Csv {
            let table = self.take_table();
            self.output.write(|w| csv::rows(&table, w))?;
        }
        Ok(())
    }

    /// Completes the result. `place` is the file that the points are from.
    fn finish(mut self, session: &Session, place: &Path) -> Result<(), Failure> {
        let place = place.display();
        if !self.errors.is_empty() {
            return Err(self.errors.failure(place));
        }
        if self.format != TableFormat::Csv {
            let table = self.take_table();
            let result = FieldAtPoints { source: Source::of(self.film), points: table.rows().len() };
            table::write(&table, &result, self.format, &mut self.output)?;
        }
        self.output.finish()?;
        session.progress.end();
        if !self.written_as_nan.is_empty() {
            session.tell(&self.written_as_nan.remarks(place));
        }
        Ok(())
    }
}

impl From<QuantityArg> for PointQuantity {
    fn from(quantity: QuantityArg) -> PointQuantity {
        match quantity {
            QuantityArg::B => PointQuantity::FLUX_DENSITY,
            QuantityArg::H => PointQuantity::Field(Quantity::FieldStrength),
            QuantityArg::J => PointQuantity::Field(Quantity::Polarization),
            QuantityArg::Gradient => PointQuantity::Gradient,
        }
    }
}
