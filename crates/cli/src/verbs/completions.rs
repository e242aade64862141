//! `magsplice completions`: what a shell needs to complete arguments.

use clap::CommandFactory;

use crate::args::{Args, CompletionsArgs};
use crate::failure::Failure;
use crate::output;

pub(crate) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "magsplice", &mut script);
    output::print(&String::from_utf8_lossy(&script))
}
