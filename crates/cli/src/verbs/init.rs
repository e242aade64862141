//! `magsplice init`: writes a commented layout to start from.

use std::path::{Path, PathBuf};

use magsplice::layout::COMMENTED_LAYOUT;

use crate::failure::{self, Failure};
use crate::output::destination;

/// Write a commented layout to start from; never overwrites a file.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice init my-film.toml")]
pub(crate) struct InitArgs {
    /// Layout file to write; - is standard output
    #[arg(default_value = "film.toml", value_name = "LAYOUT")]
    file: PathBuf,
}

pub(crate) fn run(args: &InitArgs, quiet: bool) -> Result<(), Failure> {
    if args.file == Path::new("-") {
        return destination::print(COMMENTED_LAYOUT);
    }
    destination::create(&args.file, COMMENTED_LAYOUT)?;
    if !quiet {
        let file = args.file.display();
        let report =
            if cfg!(feature = "report") { format!(", `magsplice report {file} -o report`") } else { String::new() };
        failure::tell(&format_args!("wrote {file}; try `magsplice check {file}`, `magsplice decouple {file}`{report}"));
    }
    Ok(())
}
