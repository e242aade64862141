//! `magsplice completions`: prints the script with which a shell completes arguments.

use clap::CommandFactory;

use crate::args::Args;
use crate::args::files::CompletionsArgs;
use crate::failure::Failure;
use crate::output::destination::print;

pub(crate) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "magsplice", &mut script);
    print(&String::from_utf8_lossy(&script))
}
