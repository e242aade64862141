//! A Python script that writes the blocks of a magpylib collection as a table for `import`.

use std::io::{self, Write};

/// The script, with a placeholder for the version.
const SCRIPT: &str = include_str!("magpylib_import.py");

/// Writes the script. With magpylib 5 or 6 and a collection, the script writes the cuboids as CSV
/// with lengths in metres and polarizations in tesla. `version` is the version of the writing
/// program.
///
/// # Accuracy
/// Numbers have the shortest digits that read back to the same number.
///
/// # Errors
/// Errors of the writer.
pub fn script(version: &str, w: &mut dyn Write) -> io::Result<()> {
    w.write_all(SCRIPT.replace("\"{version}\"", &format!("{version:?}")).as_bytes())
}
