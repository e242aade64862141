//! `magsplice compare`: compares the field with the ideal film.

#[cfg(feature = "report")]
use std::path::Path;
use std::path::PathBuf;

use magsplice::ideal::Comparison;
use magsplice::results::remark_about_amplitude;
#[cfg(feature = "report")]
use magsplice_report::ideal_film_figures;

use crate::args::accuracy::AccuracyArgs;
use crate::args::formats::TextOrJson;
use crate::args::points::PointsArgs;
use crate::failure::Failure;
use crate::inputs::points_below_film::GivenPoints;
#[cfg(feature = "report")]
use crate::output::folder::Folder;
use crate::remarks;
use crate::session::Session;
use crate::text::number::{number, point};
use crate::text::units::in_mt;
use crate::text::{header, rows};

/// Compare the field with the ideal film (Eq. 2).
///
/// The points are the grid of the working volume, or the points of a table.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice compare layouts/published-film.toml")]
pub(crate) struct CompareArgs {
    /// Layout file
    layout: PathBuf,
    #[command(flatten)]
    points: PointsArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    format: TextOrJson,
    /// Folder for figures of the ideal film: its polarization (Dai 2024, Fig. 2), and vectors of
    /// its field (Fig. 3)
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FOLDER")]
    figures: Option<PathBuf>,
    #[command(flatten)]
    accuracy: AccuracyArgs,
}

pub(crate) fn run(args: &CompareArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open_with_points(&args.layout, args.points.path(), remarks::OF_COMPARISONS, quiet)?;
    // A layout without an ideal film is refused before the field is computed.
    let purpose = "compares the field with the field of the ideal, sinusoidal film";
    session.require_film(args.points.path().is_none(), "compare", purpose)?;
    #[cfg(feature = "report")]
    if let Some(path) = &args.figures {
        let inputs: Vec<&Path> = [Some(&*args.layout), args.points.path()].into_iter().flatten().collect();
        let mut folder = Folder::open(path, "compare", &inputs)?;
        for figure in ideal_film_figures(&session.film()?)? {
            for (name, contents) in figure.files() {
                folder.write(&name, contents)?;
            }
        }
        folder.finish()?;
    }
    let film = session.film()?.with_accuracy(args.accuracy.accuracy());
    let given = GivenPoints::read(&session, &args.points, false)?;
    let found = match &given {
        Some(given) => film.compare_at(&given.points).map_err(|error| given.failure(error))?,
        None => film.compare().map_err(|error| session.failed(error))?,
    };
    session.print(&args.format.shown(&found, || {
        format!(
            "{}\n{}",
            header::of_points(&film, given.as_ref().map(GivenPoints::summary)),
            comparison(&found.comparison)
        )
    }))
}

/// The difference of the field from Eq. 2.
pub(super) fn comparison(c: &Comparison) -> String {
    let mut text = String::new();
    rows::heading(&mut text, "against the ideal film (Eq. 2)", ["B_x", "B_y", "B_z"]);
    rows::vector(&mut text, "  RMSE, mT", in_mt(c.component_rmse_t));
    let correlation = c.correlation.map(|r| r.map_or("constant".to_owned(), |r| format!("{r:.6}")));
    rows::cells(&mut text, "  correlation", correlation);
    rows::cell(&mut text, "  best-fit amplitude", &number(c.amplitude));
    if let Some(remark) = remark_about_amplitude(c.amplitude) {
        rows::prose(&mut text, remark);
    }
    rows::cell(&mut text, "  relative RMSE as is", &number(c.relative_rmse));
    let scaled = c.scaled_relative_rmse.map_or("none".to_owned(), number);
    rows::cell(&mut text, "  relative RMSE after scaling", &scaled);
    let (worst_mt, w) = (in_mt(c.worst_t), c.worst_at);
    let worst = format!("{worst_mt:>13.6}  at {} mm", point(w));
    rows::cell(&mut text, "  largest difference, mT", &worst);
    text
}
