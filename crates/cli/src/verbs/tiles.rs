//! `magsplice tiles`: lists the tiles of a layout and its bill of materials.

use crate::args::files::TilesArgs;
use crate::args::formats::TextOrJson;
use crate::failure::Failure;
use crate::output::destination::print;
use crate::progress::ProgressLine;
use crate::{json, remarks, text};

pub(crate) fn run(args: &TilesArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_TILES, quiet, &progress)?;
    let said = match args.format {
        TextOrJson::Json => json::pretty(&layout.plain()),
        TextOrJson::Text => format!("{}\n{}", text::tiles::tiles(&args.layout, &layout), text::tiles::bill(&layout)),
    };
    progress.end();
    print(&said)
}
