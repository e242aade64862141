//! `magsplice check`: read, validate, list tiles.

use std::path::Path;

use magsplice::layout::Layout;

use crate::args::CheckArgs;
use crate::failure::{self, Failure};
use crate::output;
use crate::text;

/// Exit status: the highest of 0 (fine), 1 (a finding), 2 (could not be used) over all layouts.
pub(crate) fn run(args: &CheckArgs) -> u8 {
    args.layouts.iter().map(|path| check(path)).max().unwrap_or(0)
}

fn check(path: &Path) -> u8 {
    let layout = match Layout::read(path) {
        Ok(layout) => layout,
        Err(error) => {
            failure::tell(&Failure::from(error));
            return 2;
        }
    };
    let listed = output::print(&text::tiles(path, &layout));
    for finding in &layout.findings {
        failure::tell(&format_args!("{}: {finding}", path.display()));
    }
    match listed {
        Ok(()) | Err(Failure::PipeClosed) => u8::from(!layout.findings.is_empty()),
        Err(failure) => {
            failure::tell(&failure);
            2
        }
    }
}
