//! `magsplice experiment`: moves the film and tells what its sensor reads.

use std::path::{Path, PathBuf};

use magsplice::layout::Elastomer;
use magsplice::prelude::DVec3;
use magsplice::results::{ColumnQuantity, Rows, Source, Table};
use magsplice::sensor::ExperimentStep;
use magsplice::{Film, Stage};
#[cfg(feature = "report")]
use magsplice_report::{ExperimentCurves, SvgText, experiment_figure};

use crate::args::experiment::ExperimentArgs;
use crate::args::formats::TableFormat;
use crate::failure::{self, Failure};
use crate::json::read::ReadJson;
use crate::output::destination::Output;
#[cfg(feature = "report")]
use crate::output::figure_file;
use crate::output::{choice, table};
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::remarks;
use crate::sensor::made_film;
use crate::text::number::counted;
use crate::words::{film_failure, no_volume};

pub(crate) fn run(args: &ExperimentArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_FIELDS, quiet, &progress)?;
    let film = prepare(&args.layout, &layout, &progress, &remarks::teller(quiet, &progress))?;
    film.volume().map_err(|error| no_volume(&args.layout, error))?;
    if args.seed.is_some() && layout.sensor.as_ref().is_none_or(|sensor| sensor.element.noise_t == DVec3::ZERO) {
        let message = "the layout states no noise for --seed: give noise_ut or part in [sensor]".to_owned();
        return Err(Failure::Points { path: args.layout.clone(), message });
    }
    let format = choice::choose(args.format, args.output.as_deref(), Some(TableFormat::Csv))?;
    if format == TableFormat::Vtk {
        return Err(Failure::Format("steps have no place in VTK: give another --format".to_owned()));
    }
    choice::accept(format, None, false)?;
    let inputs: Vec<&Path> =
        [Some(&args.layout), args.heights.as_ref()].into_iter().flatten().map(PathBuf::as_path).collect();
    let mut output = Output::open(args.output.as_deref(), &inputs)?;
    #[cfg(feature = "report")]
    let figure = figure_file::open(args.figure.as_deref(), &inputs)?;
    let made = made_film::deformed(args, &film)?;
    progress.show(Stage::uncounted("experiments"));
    let experiments = film
        .experiments(args.step, args.seed, made.as_ref())
        .map_err(|error| film_failure(&args.layout, &layout, error))?;
    let steps: Vec<&ExperimentStep> = experiments.iter().flatten().collect();
    let rows = Rows::Numbered { name: "step", first: 1, count: steps.len() };
    let columns = columns(&film, &steps, layout.elastomer.as_ref());
    let result = Table::new(rows, columns, Source::of(&film).metadata()).expect("a value for each step");
    table::write(&result, &ReadJson::new(&film, &result), format, &mut output)?;
    output.finish()?;
    #[cfg(feature = "report")]
    if let Some(file) = figure {
        let [along_x, along_y, along_z] = &experiments;
        let curves = ExperimentCurves { axes: [along_x, along_y, along_z], elastomer: layout.elastomer.as_ref() };
        file.write(experiment_figure(&curves, SvgText::Text))?;
    }
    progress.end();
    if !quiet {
        remark(args, &steps);
    }
    Ok(())
}

/// Names what is wrong with readings on standard error.
fn remark(args: &ExperimentArgs, steps: &[&ExperimentStep]) {
    let layout = args.layout.display();
    let count = |is_so: &dyn Fn(&&&ExperimentStep) -> bool| steps.iter().filter(is_so).count();
    let saturated = count(&|step| step.is_saturated);
    if saturated > 0 {
        let steps = counted(saturated, "step", "steps");
        failure::tell(&format!("{layout}: at {steps} the flux density exceeds the range of the sensor\n"));
    }
    let lost = count(&|step| step.by_field.is_none() && !step.is_saturated);
    if lost > 0 {
        let steps = counted(lost, "step", "steps");
        failure::tell(&format!(
            "{layout}: at {steps} the reading has no position in the field of the layout, or two\n"
        ));
    }
}

fn columns(film: &Film, steps: &[&ExperimentStep], layer: Option<&Elastomer>) -> Vec<ColumnQuantity> {
    let of_each = |value: &dyn Fn(&ExperimentStep) -> Option<DVec3>| -> Vec<f64> {
        steps.iter().flat_map(|step| value(step).unwrap_or(DVec3::NAN).to_array()).collect()
    };
    let mut columns = vec![
        ColumnQuantity {
            name: "film_mm",
            components: &["film_dx_mm", "film_dy_mm", "film_dz_mm"],
            values: of_each(&|step| Some(step.displacement)),
        },
        ColumnQuantity {
            name: "reading_t",
            components: &["bx_t", "by_t", "bz_t"],
            values: of_each(&|step| Some(step.reading_t)),
        },
        ColumnQuantity {
            name: "found_mm",
            components: &["found_dx_mm", "found_dy_mm", "found_dz_mm"],
            values: of_each(&|step| step.by_field),
        },
    ];
    if film.ideal().is_ok() {
        columns.push(ColumnQuantity {
            name: "parameters",
            components: &["r_x_rad", "r_y_rad", "s_z_ln_t"],
            values: of_each(&|step| step.parameters.map(|p| DVec3::new(p.r_x, p.r_y, p.s_z))),
        });
        columns.push(ColumnQuantity {
            name: "closed_form_mm",
            components: &["closed_form_dx_mm", "closed_form_dy_mm", "closed_form_dz_mm"],
            values: of_each(&|step| step.by_closed_form),
        });
    }
    if let Some(layer) = layer {
        let force = |moved: Option<DVec3>| moved.map(|moved| layer.force_n(moved));
        columns.push(ColumnQuantity {
            name: "force_n",
            components: &["fx_n", "fy_n", "fz_n"],
            values: of_each(&|step| force(Some(step.displacement))),
        });
        columns.push(ColumnQuantity {
            name: "found_force_n",
            components: &["found_fx_n", "found_fy_n", "found_fz_n"],
            values: of_each(&|step| force(step.by_field)),
        });
        if film.ideal().is_ok() {
            columns.push(ColumnQuantity {
                name: "closed_form_force_n",
                components: &["closed_form_fx_n", "closed_form_fy_n", "closed_form_fz_n"],
                values: of_each(&|step| force(step.by_closed_form)),
            });
        }
    }
    let saturated = steps.iter().map(|step| f64::from(u8::from(step.is_saturated))).collect();
    columns.push(ColumnQuantity { name: "saturated", components: &["saturated"], values: saturated });
    columns
}
