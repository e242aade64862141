//! `magsplice tiles`: lists the tiles of a layout and its bill of materials.

use crate::args::files::TilesArgs;
use crate::args::formats::TilesFormat;
use crate::cut_list::CutList;
use crate::failure::Failure;
use crate::output::destination::print;
use crate::progress::ProgressLine;
use crate::{json, remarks, text};

pub(crate) fn run(args: &TilesArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_TILES, quiet, &progress)?;
    if args.kerf_mm.is_some() && args.format == TilesFormat::Json {
        return Err(Failure::Format("--kerf-mm goes with --format text or csv: json is the layout itself".to_owned()));
    }
    let said = match args.format {
        TilesFormat::Json => json::pretty(&layout.plain()),
        TilesFormat::Text => {
            let list = CutList::new(&layout, args.kerf_mm);
            format!("{}\n{}", text::tiles::tiles(&args.layout, &layout), text::tiles::bill(&list))
        }
        TilesFormat::Csv => CutList::new(&layout, args.kerf_mm).csv(),
    };
    progress.end();
    print(&said)
}
