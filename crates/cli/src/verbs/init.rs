//! `magsplice init`: a commented layout to start from.

use std::path::Path;

use magsplice::layout::COMMENTED_LAYOUT;

use crate::args::InitArgs;
use crate::failure::{self, Failure};
use crate::output;

pub(crate) fn run(args: &InitArgs, quiet: bool) -> Result<(), Failure> {
    if args.file == Path::new("-") {
        return output::print(COMMENTED_LAYOUT);
    }
    output::create(&args.file, COMMENTED_LAYOUT)?;
    if !quiet {
        let file = args.file.display();
        let look =
            if cfg!(feature = "report") { format!(", `magsplice report {file} -o report`") } else { String::new() };
        failure::tell(&format_args!("wrote {file}; try `magsplice check {file}`, `magsplice decouple {file}`{look}"));
    }
    Ok(())
}
