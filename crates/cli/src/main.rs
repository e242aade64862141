//! The program `magsplice`.

use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(magsplice_cli::run(env::args_os()))
}
