//! The browser of the user.

use std::io;
use std::process::{Command, Stdio};
use std::thread;

/// Opens an address in the browser that the system prefers.
pub(super) fn open(url: &str) -> io::Result<()> {
    let words: &[&str] = if cfg!(windows) {
        // The first argument of `start` in quotes is a title.
        &["cmd", "/C", "start", ""]
    } else if cfg!(target_os = "macos") {
        &["open"]
    } else {
        &["xdg-open"]
    };
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut opener = command.spawn()?;
    // A process that nobody waits for stays in the table of processes.
    thread::spawn(move || opener.wait());
    Ok(())
}
