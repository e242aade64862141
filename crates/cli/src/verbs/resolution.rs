//! `magsplice resolution`: the displacements that noise lets a sensor see.

use std::path::Path;

use magsplice::magnet::Quantity;
use magsplice::prelude::{Branch, DVec3, Parameters};
use magsplice::{Film, FilmError, Stage};
use magsplice_export::{ColumnQuantity, Points, Table};

use crate::args::sensor::ResolutionArgs;
use crate::failure::Failure;
use crate::json::field::FieldJson;
use crate::output::destination::{Output, print};
use crate::output::{choice, table};
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_volume};
use crate::{remarks, text};

pub(crate) fn run(args: &ResolutionArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_FIELDS, quiet, &progress)?;
    let film = Film::new(&layout);
    let failed = |error| film_failure(&args.layout, &layout, error);
    let volume = film.volume().map_err(|error| no_volume(&args.layout, error))?;
    let file = match &args.output {
        Some(path) => {
            let format = choice::choose(args.format, Some(path), None)?;
            choice::accept(format, Some(path), true)?;
            Some((format, Output::open(Some(path), &[args.layout.as_path() as &Path])?))
        }
        None => None,
    };
    progress.show(Stage::uncounted("gradient"));
    let points: Vec<DVec3> = volume.grid.points().collect();
    let gradient =
        film.scene().gradient_at(Quantity::FluxDensity, &points).map_err(|errors| failed(FilmError::Points(errors)))?;
    let noise = &args.noise;
    let exact: Vec<DVec3> = gradient.iter().map(|g| noise.of_position(*g).unwrap_or(DVec3::INFINITY)).collect();
    let closed: Option<Vec<DVec3>> = match film.ideal() {
        Ok(ideal) => {
            let branch = Branch::from_axis_field(film.reference_field_t().map_err(failed)?);
            let of = |field_t: &DVec3| {
                let (_, derivatives) = Parameters::with_derivatives(*field_t, branch?)?;
                noise.of_parameters(&derivatives, ideal.wavenumber())
            };
            let field_t = film.volume_field_t().map_err(failed)?;
            Some(field_t.iter().map(|field_t| of(field_t).unwrap_or(DVec3::INFINITY)).collect())
        }
        Err(_) => None,
    };
    progress.end();
    if let Some((format, mut output)) = file {
        let column = |name, components, values: &[DVec3]| ColumnQuantity {
            name,
            components,
            values: values.iter().flat_map(DVec3::to_array).collect(),
        };
        let mut columns = vec![column("deviation_mm", &["deviation_x_mm", "deviation_y_mm", "deviation_z_mm"], &exact)];
        if let Some(closed) = &closed {
            const NAMES: [&str; 3] =
                ["closed_form_deviation_x_mm", "closed_form_deviation_y_mm", "closed_form_deviation_z_mm"];
            columns.push(column("closed_form_deviation_mm", &NAMES, closed));
        }
        let result = Table::new(Points::Grid(volume.grid), columns, table::film_metadata(&film));
        let result = result.expect("a value for each point");
        table::write(&result, &FieldJson::new(&film, &result), format, &mut output)?;
        output.finish()?;
    }
    let header = text::header::film(&film, volume);
    print(&(header + &text::resolution::resolution(noise, &points, &exact, closed.as_deref())))
}
