//! Where results go.

/// Name and version of the program in the history of layouts.
pub(crate) const PROGRAM: &str = concat!("magsplice ", env!("CARGO_PKG_VERSION"));

/// The format that an option or the ending of a file chooses.
pub(crate) mod choice;
/// Standard output, or a file that appears complete or not at all.
pub(crate) mod destination;
/// A file for one figure.
#[cfg(feature = "report")]
pub(crate) mod figure_file;
/// A folder of results that appears complete or not at all.
pub(crate) mod folder;
/// Results as JSON.
pub(crate) mod json;
/// A file for a page to print.
#[cfg(feature = "report")]
pub(crate) mod page_file;
/// Writing tables.
pub(crate) mod table;
