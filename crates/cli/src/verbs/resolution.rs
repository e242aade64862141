//! `magsplice resolution`: the displacement resolution of a sensor with noise.

use std::fmt::Write;
use std::path::PathBuf;

use magsplice::FilmError;
use magsplice::prelude::DVec3;
use magsplice::results::{FilmResolution, ResolutionSummary, range_of_setting, twelve_digits};
use magsplice::sensor::Noise;

use crate::args::formats::TableFormat;
use crate::args::readings::noise;
use crate::failure::Failure;
use crate::output::{choice, table};
use crate::remarks;
use crate::session::{OF_SENSORS, Session};
use crate::text::number::{number, point};
use crate::text::units::in_ut;
use crate::text::{header, rows};

/// Compute the displacement resolution of a sensor with noise.
///
/// The noise of the readings is normal. It causes standard deviations of the displacement along x,
/// y and z: by the exact field (the bound of Cramér and Rao; no unbiased estimate from one reading
/// has smaller ones), and, with [ideal], by the closed form of the ideal film (Dai 2024, Eqs. 14
/// and 15). With a head, both are of the weighted sum, and a reading of each sensor gives others,
/// with a known stray field and with one that is fitted. The text has their root mean squares over
/// the volume, and the largest. With -o, a table of every point is written.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice resolution layouts/published-film.toml --noise 5uT\n  \
    magsplice resolution film.toml --noise 5uT,5uT,8uT -o resolution.vti")]
pub(crate) struct ResolutionArgs {
    /// Layout file
    layout: PathBuf,
    /// Standard deviation of a reading of each sensor, such as 5uT, or of its x, y and z:
    /// 5uT,5uT,8uT [default: the noise of [sensor] in the layout]
    #[arg(long, value_name = "NOISE", value_parser = noise)]
    noise: Option<Noise>,
    /// File for a table of all points, complete or not at all
    #[arg(short, long, value_name = "TABLE")]
    output: Option<PathBuf>,
    /// Format of the table [default: by the file's ending]
    #[arg(long, value_enum, requires = "output")]
    format: Option<TableFormat>,
}

pub(crate) fn run(args: &ResolutionArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_FIELDS, quiet)?;
    let film = session.film()?;
    let volume = session.volume(OF_SENSORS)?;
    let file = match &args.output {
        Some(path) => {
            let format = choice::choose(args.format, Some(path), None)?;
            choice::accept(format, Some(path), true)?;
            Some((format, session.output(Some(path), [])?))
        }
        None => None,
    };
    let resolution = film.resolution(args.noise).map_err(|error| match error {
        FilmError::NoNoise => session.no_noise("--noise, such as 5uT"),
        error => session.failed(error),
    })?;
    if let Some((format, mut output)) = file {
        table::write(&resolution.table(), &resolution, format, &mut output)?;
        output.finish()?;
    }
    session.print(&(header::film(&film, volume) + &text(&resolution)))
}

/// The deviations at all points: root mean squares, least and largest.
pub(super) fn text(resolution: &FilmResolution) -> String {
    let DVec3 { x, y, z } = in_ut(resolution.noise.deviation_t);
    let axes = if x == y && y == z { micro(x) } else { format!("{}, {}, {}", micro(x), micro(y), micro(z)) };
    let of = if resolution.by_sensors.is_some() { "the weighted sum" } else { "a reading" };
    let mut text = format!("noise of {of}: {axes} uT (standard deviation)\n");
    if let Some(rate_hz) = resolution.rate_hz {
        let _ = writeln!(text, "readings a second: {rate_hz}; the mean of n has 1/sqrt(n) of the deviations below");
    }
    let saturated = resolution.saturated.iter().filter(|is_saturated| **is_saturated).count();
    if saturated > 0 {
        let (all, larger) = (resolution.points, resolution.larger_range);
        let larger = larger.map(range_of_setting).unwrap_or_default();
        let _ = writeln!(
            text,
            "out of range: the flux density exceeds the range of the sensor at {saturated} of {all} points, which are \
             excluded below{larger}"
        );
    }
    text += "\n";
    rows::heading(&mut text, "standard deviation, mm", ["x", "y", "z"]);
    summary(&mut text, "by the field of the layout", resolution.summary(&resolution.by_field_mm));
    if let Some(closed) = &resolution.by_closed_form_mm {
        summary(&mut text, "by the closed form (Eq. 14)", resolution.summary(closed));
    }
    if let (Some(of), Some([least, tenth])) = (&resolution.by_sensors, resolution.least_singular_values_per_mm()) {
        summary(&mut text, "by all sensors, in a known stray field", resolution.summary(&of.known_stray_mm));
        summary(&mut text, "by all sensors, with the stray field fitted", resolution.summary(&of.fitted_stray_mm));
        text += "least singular value of the readings over their noise, stray field fitted, 1/mm\n";
        rows::cell(&mut text, "  least in the volume", &number(least));
        rows::cell(&mut text, "  tenth percentile", &number(tenth));
    }
    text
}

/// A flux density in microtesla without the rounding of its unit, or with three decimals if it has
/// many.
fn micro(value: f64) -> String {
    let typed = twelve_digits(value).to_string();
    if typed.len() <= 6 { typed } else { format!("{value:.3}") }
}

fn summary(text: &mut String, title: &str, summary: Option<ResolutionSummary>) {
    let _ = writeln!(text, "{title}");
    let Some(ResolutionSummary { rms_mm, least_mm, largest_mm, worst_at_mm }) = summary else {
        let _ = writeln!(text, "  no displacement is resolved");
        return;
    };
    for (name, value) in [("RMS over the volume", rms_mm), ("least", least_mm), ("largest", largest_mm)] {
        rows::cells(text, &format!("  {name}"), value.to_array().map(number));
    }
    let _ = writeln!(text, "  largest in all axes together at {} mm", point(worst_at_mm));
}
