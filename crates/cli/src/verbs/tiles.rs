//! `magsplice tiles`: lists the tiles of a layout and its bill of materials.

use magsplice::layout::Layout;

use crate::args::files::TilesArgs;
use crate::args::formats::TextOrJson;
use crate::failure::Failure;
use crate::output::destination::print;
use crate::progress::ProgressLine;
use crate::{json, text};

pub(crate) fn run(args: &TilesArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = Layout::read(&args.layout)?;
    let said = match args.format {
        TextOrJson::Json => json::pretty(&layout.plain()),
        TextOrJson::Text => format!("{}\n{}", text::tiles::tiles(&args.layout, &layout), text::tiles::bill(&layout)),
    };
    progress.end();
    print(&said)
}
