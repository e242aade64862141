//! An interrupted program leaves no temporary file behind.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once, PoisonError};

/// The exit status of a program ended by Ctrl-C, as shells give it.
const INTERRUPTED: i32 = 130;

static TEMPORARY: Mutex<Option<PathBuf>> = Mutex::new(None);
static HANDLER: Once = Once::new();

/// Whether the next interruption only asks for an end.
static KINDLY: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on the first interruption only says so here; a second one ends the program as ever.
pub(crate) fn asked_kindly() -> &'static AtomicBool {
    handle();
    KINDLY.store(true, Ordering::Relaxed);
    &ASKED
}

/// Makes a file or folder that an interruption (Ctrl-C, termination, hang-up) removes from now on, before the program ends.
pub(crate) fn temporary<T: AsRef<Path>>(make: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    handle();
    // An interruption in between waits until it is known what to remove.
    let mut temporary = TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner);
    let made = make()?;
    *temporary = Some(made.as_ref().to_owned());
    Ok(made)
}

fn handle() {
    HANDLER.call_once(|| {
        // Without a handler the program works all the same; only the temporary file would stay.
        let _ = ctrlc::set_handler(|| {
            if KINDLY.swap(false, Ordering::Relaxed) {
                ASKED.store(true, Ordering::Relaxed);
                return;
            }
            // Held to the end, so that no other is made meanwhile.
            let temporary = TEMPORARY.lock();
            if let Ok(Some(path)) = temporary.as_deref() {
                let _ = fs::remove_file(path).or_else(|_| fs::remove_dir_all(path));
            }
            std::process::exit(INTERRUPTED);
        });
    });
}

/// Does something that must be done as a whole; an interruption waits for it.
pub(crate) fn uninterrupted<T>(work: impl FnOnce() -> T) -> T {
    let _held = TEMPORARY.lock();
    work()
}
