//! `magsplice report`: draws figures and a page, once or whenever a layout is saved.

/// The folder or the page that a report becomes.
mod destination;
/// The drawing.
mod draw;
/// The live page.
mod live;
/// `--watch`: draws anew when a layout is saved.
mod watch;

use std::path::PathBuf;

use clap::ValueEnum;
use magsplice_report::{Print, SvgText};

use crate::args::accuracy::AccuracyArgs;
use crate::failure::Failure;

/// Draw the film and its field: figures, and one page with all of them.
///
/// Draws the figures of Dai 2024 for any layout, as SVG, PNG and CSV: the tiles from above, field
/// vectors in three views, B beside the ideal film on planes, and the decoupling parameters through
/// the working volume and along its axes. The page report.html needs no network and no other file;
/// it has the numbers, a view of the tiles that turns, and maps that show the value under the
/// pointer. The folder appears complete or not at all. An earlier report in it is replaced. With -o
/// PAGE.html only the page is written.
///
/// If the program has the engine of the live page, the folder also has live.html: a page on which
/// tiles are dragged, and every number follows. It needs no network and no other file either. With
/// --live only this page is written.
///
/// Two layouts give one page with the numbers of both films and their difference, and the figures
/// side by side on the same scales.
///
/// With --watch the program keeps running, draws again when a layout is saved, and prints the
/// faults of a broken layout. The page does not reload by itself.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice report layouts/published-film.toml\n  magsplice report film.toml -o film.html\n  magsplice report film.toml --figure field-middle --component z --width 85mm -o b_z.pdf\n  magsplice report film.toml --live\n  magsplice report before.toml after.toml -o comparison"
)]
pub(crate) struct ReportArgs {
    /// Layout file, or two whose films are drawn side by side
    #[arg(required = true, num_args = 1..=2, value_name = "LAYOUT")]
    layouts: Vec<PathBuf>,
    /// Folder to write: new, empty, or with an earlier report, which is replaced; or a file
    /// PAGE.html for the page alone [default: NAME-report for NAME.toml]
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Draw again whenever a layout is saved, until Ctrl-C
    #[arg(long)]
    watch: bool,
    /// Text in the SVG files
    #[arg(long, value_enum, default_value = "text")]
    text: SvgTextArg,
    /// Only this figure as a file -o NAME.pdf, .svg or .png [default: NAME.pdf]: layout, vectors,
    /// field-lowest, field-middle, field-highest, parameters-level, parameters-upright,
    /// parameters-along-axes, resolution, experiment, as far as the layout has them
    #[arg(long, value_name = "NAME", conflicts_with = "watch")]
    figure: Option<String>,
    /// Width of the figure in print, such as 85mm: text has 7 to 9 pt
    #[arg(long, value_name = "LENGTH", value_parser = crate::args::numbers::length_mm, requires = "figure")]
    width: Option<f64>,
    /// Only this component of a figure of maps, its maps below each other
    #[arg(long, value_enum, requires = "figure")]
    component: Option<ComponentArg>,
    /// Only the live page, on which the film is changed and evaluated [default: NAME.html]
    #[arg(long, conflicts_with_all = ["watch", "figure"])]
    live: bool,
    /// Engine of the live page: the WebAssembly module of crates/page-engine, compressed by xz
    /// [default: the module built into the program]
    #[arg(long, value_name = "FILE")]
    engine: Option<PathBuf>,
    #[command(flatten)]
    accuracy: AccuracyArgs,
}

#[derive(Clone, Copy, ValueEnum)]
enum ComponentArg {
    /// B_x or R_x
    X,
    /// B_y or R_y
    Y,
    /// B_z or S_z
    Z,
}

#[derive(Clone, Copy, ValueEnum)]
enum SvgTextArg {
    /// Text that can be searched and edited, in Roboto or a similar font
    Text,
    /// Outlines of Roboto, the same on every machine
    Outlines,
}

impl From<SvgTextArg> for SvgText {
    fn from(text: SvgTextArg) -> SvgText {
        match text {
            SvgTextArg::Text => SvgText::Text,
            SvgTextArg::Outlines => SvgText::Outlines,
        }
    }
}

pub(crate) fn run(args: &ReportArgs, quiet: bool) -> Result<(), Failure> {
    let usual = || match &args.figure {
        Some(name) => PathBuf::from(format!("{name}.pdf")),
        None if args.live => destination::usual_page(&args.layouts),
        None => destination::usual(&args.layouts),
    };
    let output = args.output.clone().unwrap_or_else(usual);
    let engine = live::Engine::open(args.engine.as_deref())?;
    if args.live {
        return live::write(&args.layouts, &output, &engine, quiet);
    }
    let (text, accuracy) = (args.text.into(), args.accuracy.accuracy());
    let drawing = draw::Drawing { output: &output, text, accuracy, engine, quiet };
    if let Some(name) = &args.figure {
        let print = Print { width_mm: args.width, component: args.component.map(|component| component as usize) };
        return drawing.figure(&args.layouts, name, print);
    }
    if args.watch { watch::run(&args.layouts, &drawing) } else { drawing.draw(&args.layouts) }
}
