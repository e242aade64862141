//! An interrupted program leaves no temporary file behind.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once};

/// The exit status of a program ended by Ctrl-C, as shells give it.
const INTERRUPTED: i32 = 130;

static TEMPORARY: Mutex<Option<PathBuf>> = Mutex::new(None);
static HANDLER: Once = Once::new();

/// From now on an interruption (Ctrl-C, termination, hang-up) removes this file or folder before the program ends.
pub(crate) fn remove_if_interrupted(path: &Path) {
    if let Ok(mut temporary) = TEMPORARY.lock() {
        *temporary = Some(path.to_owned());
    }
    HANDLER.call_once(|| {
        // Without a handler the program works all the same; only the temporary file would stay.
        let _ = ctrlc::set_handler(|| {
            if let Ok(temporary) = TEMPORARY.lock() {
                let _ = temporary.as_ref().map(|path| fs::remove_file(path).or_else(|_| fs::remove_dir_all(path)));
            }
            std::process::exit(INTERRUPTED);
        });
    });
}

/// Does something that must be done as a whole; an interruption waits for it.
#[cfg(feature = "report")]
pub(crate) fn uninterrupted<T>(work: impl FnOnce() -> T) -> T {
    let _held = TEMPORARY.lock();
    work()
}
