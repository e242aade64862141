//! `magsplice resolution`: the displacements that noise lets a sensor see.

use std::path::Path;

use magsplice::prelude::DVec3;
use magsplice::results::{ColumnQuantity, FieldAtPoints, Points, Source, Table};

use crate::args::sensor::ResolutionArgs;
use crate::failure::Failure;
use crate::output::destination::{Output, print};
use crate::output::{choice, table};
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::sensor::film_resolution::FilmResolution;
use crate::words::{film_failure, no_volume};
use crate::{remarks, text};

pub(crate) fn run(args: &ResolutionArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_FIELDS, quiet, &progress)?;
    let film = prepare(&args.layout, &layout, &progress, &remarks::teller(quiet, &progress))?;
    let volume = film.volume().map_err(|error| no_volume(&args.layout, error))?;
    let file = match &args.output {
        Some(path) => {
            let format = choice::choose(args.format, Some(path), None)?;
            choice::accept(format, Some(path), true)?;
            Some((format, Output::open(Some(path), &[args.layout.as_path() as &Path])?))
        }
        None => None,
    };
    let found = FilmResolution::new(&film, volume, args.noise);
    let Some(resolution) = found.map_err(|error| film_failure(&args.layout, &layout, error))? else {
        let message = "the layout has no noise: give --noise, such as 5uT, or noise_ut or part in [sensor]".to_owned();
        return Err(Failure::Points { path: args.layout.clone(), message });
    };
    progress.end();
    if let Some((format, mut output)) = file {
        let column = |name, components, values: &[DVec3]| ColumnQuantity {
            name,
            components,
            values: values.iter().flat_map(DVec3::to_array).collect(),
        };
        const NAMES: [&str; 3] = ["deviation_x_mm", "deviation_y_mm", "deviation_z_mm"];
        let mut columns = vec![column("deviation_mm", &NAMES, &resolution.by_field_mm)];
        if let Some(closed_form_mm) = &resolution.by_closed_form_mm {
            const NAMES: [&str; 3] =
                ["closed_form_deviation_x_mm", "closed_form_deviation_y_mm", "closed_form_deviation_z_mm"];
            columns.push(column("closed_form_deviation_mm", &NAMES, closed_form_mm));
        }
        let result = Table::new(Points::Grid(volume.grid), columns, Source::of(&film).metadata());
        let result = result.expect("a value for each point");
        table::write(
            &result,
            &FieldAtPoints { source: Source::of(&film), points: result.rows().len() },
            format,
            &mut output,
        )?;
        output.finish()?;
    }
    print(&(text::header::film(&film, volume) + &text::resolution::resolution(&resolution)))
}
