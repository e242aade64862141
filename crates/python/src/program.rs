//! The program `magsplice`.

use std::ffi::OsString;
use std::io::{self, Write};
use std::thread;

use pyo3::prelude::*;

/// Exit status after a panic, as of a program in Rust.
const PANICKED: u8 = 101;
/// Bytes of the stack: as many as the first thread of a program usually has.
const STACK: usize = 8 << 20;

/// The exit status of the program with these arguments. It runs once in a process, whose signals it
/// handles.
///
/// # Errors
/// If the system refuses a thread.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    let words = [OsString::from("magsplice")].into_iter().chain(arguments);
    // The thread has the name that the message of a panic cites in the program.
    let main = thread::Builder::new().name("main".to_owned()).stack_size(STACK);
    py.detach(|| {
        let status = main.spawn(|| magsplice_cli::run(words))?.join().unwrap_or(PANICKED);
        // A program in Rust does this at its end, and ignores a reader that is gone.
        let _ = io::stdout().flush();
        Ok(status)
    })
}
