//! `magsplice field`: the field at points, as CSV.

use std::path::{Path, PathBuf};

use magsplice::field::{Accuracy, Cause, PointErrors, Quantity, Scene};
use magsplice::layout::Layout;
use magsplice::prelude::{DMat3, DVec3};
use magsplice::{Film, FilmError};

use crate::args::{FieldArgs, QuantityArg};
use crate::failure::Failure;
use crate::output::Output;
use crate::points::{Faults, PointFile};
use crate::progress::Progress;

/// Points evaluated and written at a time. Bounds memory, and is enough work for every thread.
const BATCH: usize = 1 << 16;

pub(crate) fn run(args: &FieldArgs, quiet: bool) -> Result<(), Failure> {
    let layout = Layout::read(&args.layout)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.get());
    match &args.points {
        Some(path) => at_points(args, &film, path, quiet),
        None => on_grid(args, &film, quiet),
    }
}

fn at_points(args: &FieldArgs, film: &Film, path: &Path, quiet: bool) -> Result<(), Failure> {
    let mut file = PointFile::open(path)?;
    let mut table = Table::begin(args)?;
    let mut faults = Faults::default();
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    let mut progress = Progress::new(None, args.output.as_deref(), quiet);
    loop {
        let more = file.read(BATCH, &mut points, &mut lines, &mut faults)?;
        let errors = table.rows(film.scene(), &points, faults.is_empty())?;
        for error in errors.0 {
            let (line, cause) = (lines[error.index], cause_in_words(error.cause, film.layout()));
            let p = error.point;
            faults.add(line, format!("line {line}: ({}, {}, {}) mm: {cause}", p.x, p.y, p.z));
        }
        progress.advance(points.len());
        if !more {
            break;
        }
    }
    if faults.is_empty() { table.output.finish() } else { Err(faults.failure(path.display().to_string())) }
}

fn on_grid(args: &FieldArgs, film: &Film, quiet: bool) -> Result<(), Failure> {
    let missing = |error: FilmError| match error {
        FilmError::Missing(_) => Failure::Points {
            path: args.layout.clone(),
            message: "the layout has no [volume] table to take points from: add one, or give --points".to_owned(),
        },
        error => Failure::Film { layout: args.layout.clone(), error },
    };
    let grid = film.volume().map_err(missing)?.grid;
    let mut table = Table::begin(args)?;
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
            let evaluated = film.scene().field_on_grid(quantity, &grid, &mut field);
            let rows = points.iter().zip(field.iter().map(DVec3::to_array));
            add(write_rows(&mut table.output, evaluated, rows, true)?);
        }
        _ => {
            let mut complete = true;
            let mut progress = Progress::new(Some(grid.len()), args.output.as_deref(), quiet);
            for start in (0..grid.len()).step_by(BATCH) {
                let points: Vec<DVec3> = (start..grid.len().min(start + BATCH)).map(|i| grid.point(i)).collect();
                complete = add(table.rows(film.scene(), &points, complete)?);
                progress.advance(points.len());
            }
        }
    }
    if faults.is_empty() { table.output.finish() } else { Err(faults.failure(args.layout.display().to_string())) }
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
        Cause::OutOfRange | Cause::TooExact { .. } => cause.to_string(),
    }
}

struct Table {
    output: Output,
    quantity: QuantityArg,
    field: Vec<DVec3>,
    gradient: Vec<DMat3>,
}

impl Table {
    fn begin(args: &FieldArgs) -> Result<Table, Failure> {
        let inputs: Vec<&Path> = std::iter::once(&args.layout).chain(&args.points).map(PathBuf::as_path).collect();
        let mut output = Output::open(args.output.as_deref(), &inputs)?;
        output.write(|w| writeln!(w, "x_mm,y_mm,z_mm,{}", args.quantity.columns()))?;
        Ok(Table { output, quantity: args.quantity, field: Vec::new(), gradient: Vec::new() })
    }

    /// Evaluates points and, as long as there is a table to complete, writes their rows.
    fn rows(&mut self, scene: &Scene, points: &[DVec3], complete: bool) -> Result<PointErrors, Failure> {
        let Some(quantity) = quantity(self.quantity) else {
            self.gradient.resize(points.len(), DMat3::ZERO);
            let evaluated = scene.flux_density_gradient_into(points, &mut self.gradient);
            // Row by row: the derivatives of one component of B together.
            let rows = points.iter().zip(self.gradient.iter().map(|g| g.transpose().to_cols_array()));
            return write_rows(&mut self.output, evaluated, rows, complete);
        };
        self.field.resize(points.len(), DVec3::ZERO);
        let evaluated = scene.field_into(quantity, points, &mut self.field);
        let rows = points.iter().zip(self.field.iter().map(DVec3::to_array));
        write_rows(&mut self.output, evaluated, rows, complete)
    }
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

fn write_rows<'a, const N: usize>(
    output: &mut Output,
    evaluated: Result<(), PointErrors>,
    mut rows: impl Iterator<Item = (&'a DVec3, [f64; N])>,
    complete: bool,
) -> Result<PointErrors, Failure> {
    if let Err(errors) = evaluated {
        return Ok(errors);
    }
    if complete {
        // Debug prints the shortest digits that read back to the same number, with an exponent where that is shorter.
        output.write(|w| {
            rows.try_for_each(|(p, values)| {
                write!(w, "{:?},{:?},{:?}", p.x, p.y, p.z)?;
                values.iter().try_for_each(|value| write!(w, ",{value:?}"))?;
                writeln!(w)
            })
        })?;
    }
    Ok(PointErrors(Vec::new()))
}
