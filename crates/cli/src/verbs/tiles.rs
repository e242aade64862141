//! `magsplice tiles`: lists the tiles of a layout and its bill of materials.

#[cfg(feature = "report")]
use magsplice_report::{SvgText, layout_figure};

use crate::args::files::TilesArgs;
use crate::args::formats::TilesFormat;
use crate::cut_list::CutList;
use crate::failure::Failure;
#[cfg(feature = "report")]
use crate::output::destination::Output;
use crate::output::destination::print;
#[cfg(feature = "report")]
use crate::printed;
use crate::progress::ProgressLine;
use crate::{json, remarks, text};

pub(crate) fn run(args: &TilesArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_TILES, quiet, &progress)?;
    if args.kerf_mm.is_some() && args.format == TilesFormat::Json {
        return Err(Failure::Format("--kerf-mm goes with --format text or csv: json has no material".to_owned()));
    }
    #[cfg(feature = "report")]
    let page = args.page.as_deref().map(|page| Output::open(Some(page), &[&args.layout])).transpose()?;
    let list = CutList::new(&layout, args.kerf_mm);
    #[cfg(feature = "report")]
    if let Some(mut page) = page {
        let figure = layout_figure(&layout, SvgText::Outlines).map_err(|error| Failure::Format(error.to_string()))?;
        page.write(|writer| writer.write_all(printed::bill_page(&list, &figure).as_bytes()))?;
        page.finish()?;
    }
    let said = match args.format {
        TilesFormat::Json => json::pretty(&json::tiles::TilesJson::new(&list)),
        TilesFormat::Text => format!("{}\n{}", text::tiles::tiles(&args.layout, &list), text::tiles::bill(&list)),
        TilesFormat::Csv => list.csv(),
    };
    progress.end();
    print(&said)
}
