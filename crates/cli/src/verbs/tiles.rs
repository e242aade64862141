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
        return Err(Failure::Format("--kerf-mm goes with --format text or csv: json has no material".to_owned()));
    }
    let list = CutList::new(&layout, args.kerf_mm);
    let said = match args.format {
        TilesFormat::Json => json::pretty(&json::tiles::TilesJson::new(&list)),
        TilesFormat::Text => format!("{}\n{}", text::tiles::tiles(&args.layout, &list), text::tiles::bill(&list)),
        TilesFormat::Csv => list.csv(),
    };
    progress.end();
    print(&said)
}
