//! Ctrl-C: temporary files are removed, a search ends with its best film.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Mutex, Once, PoisonError};

/// Exit status after Ctrl-C, the one that shells give.
pub(crate) const INTERRUPTED: u8 = 130;

/// The temporary files and folders that an interruption removes. Those that got their names are
/// gone.
static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
static HANDLER: Once = Once::new();

/// The exit status of an interruption.
static STATUS: AtomicU8 = AtomicU8::new(INTERRUPTED);

/// Whether the next interruption sets [`STOP`] instead of ending the program.
static DEFERRED: AtomicBool = AtomicBool::new(false);
/// Whether a deferred interruption has happened.
static STOP: AtomicBool = AtomicBool::new(false);

/// Defers the next interruption: it only sets the flag that is returned. A second interruption ends
/// the program.
pub(crate) fn defer() -> &'static AtomicBool {
    handle();
    DEFERRED.store(true, Ordering::Relaxed);
    &STOP
}

/// Makes an interruption the usual end of the program, with status 0.
#[cfg(feature = "studio")]
pub(crate) fn expect() {
    STATUS.store(0, Ordering::Relaxed);
    handle();
}

/// Makes a file or folder that an interruption (Ctrl-C, termination, hang-up) removes before the
/// program ends.
pub(crate) fn temporary<T: AsRef<Path>>(make: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    handle();
    // The lock makes an interruption wait until the path to remove is known.
    let mut temporary = TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner);
    let made = make()?;
    temporary.push(made.as_ref().to_owned());
    Ok(made)
}

/// Installs the handler, so that Ctrl-C ends the program with status 130, or 0 after [`expect`].
pub(crate) fn handle() {
    HANDLER.call_once(|| {
        // Without a handler the program still works; an interruption leaves its temporary file.
        let _ = ctrlc::set_handler(|| {
            if DEFERRED.swap(false, Ordering::Relaxed) {
                STOP.store(true, Ordering::Relaxed);
                return;
            }
            // Held until the program ends, so that no other temporary file is made.
            let temporary = TEMPORARY.lock();
            for path in temporary.iter().flat_map(|paths| paths.iter()) {
                let _ = fs::remove_file(path).or_else(|_| fs::remove_dir_all(path));
            }
            std::process::exit(STATUS.load(Ordering::Relaxed).into());
        });
    });
}

/// Does work that an interruption must not divide: it waits for the end.
pub(crate) fn uninterrupted<T>(work: impl FnOnce() -> T) -> T {
    let _held = TEMPORARY.lock();
    work()
}
