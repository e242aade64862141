//! `magsplice completions`: prints the script with which a shell completes arguments.

use clap::Command;

use crate::failure::Failure;
use crate::output::destination::print;

/// Print a script with which a shell completes arguments.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice completions bash > ~/.local/share/bash-completion/completions/magsplice")]
pub(crate) struct CompletionsArgs {
    /// Shell that reads the script
    shell: clap_complete::Shell,
}

/// `program` is the whole command line.
pub(crate) fn run(args: &CompletionsArgs, mut program: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "magsplice", &mut script);
    print(&String::from_utf8_lossy(&script))
}
