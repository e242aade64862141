//! `magsplice check`: read, validate, list tiles.

use std::path::Path;

use magsplice::layout::Layout;

use crate::args::CheckArgs;
use crate::failure::Failure;
use crate::output;
use crate::text;

/// Exit status: the highest of 0 (fine), 1 (a finding), 2 (could not be used) over all layouts.
pub(crate) fn run(args: &CheckArgs) -> u8 {
    args.layouts.iter().map(|path| check(path)).max().unwrap_or(0)
}

fn check(path: &Path) -> u8 {
    let listed = Layout::read(path).map_err(Failure::from).and_then(|layout| {
        output::print(&text::tiles(path, &layout))?;
        Ok(layout.findings)
    });
    match listed {
        Ok(findings) => {
            for finding in &findings {
                eprintln!("magsplice: {}: {finding}", path.display());
            }
            u8::from(!findings.is_empty())
        }
        Err(Failure::PipeClosed) => 0,
        Err(failure) => {
            eprintln!("magsplice: {failure}");
            2
        }
    }
}
