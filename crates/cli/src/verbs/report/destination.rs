//! The folder or the page that a report becomes.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::output::destination::Output;
use crate::output::folder::Folder;

/// Endings of files that a report does not become.
const FILE_ENDINGS: [&str; 9] = ["csv", "htm", "json", "md", "pdf", "png", "svg", "toml", "txt"];

/// The ending of the page.
const PAGE_ENDING: &str = "html";

/// A folder, or the page alone.
pub(super) enum Destination {
    Folder(Folder),
    Page(Output),
}

/// The folder of a report without a named destination, in the working directory: `NAME-report` for
/// `NAME.toml`, and `A-and-B-report` for two layouts.
pub(super) fn usual(layouts: &[PathBuf]) -> PathBuf {
    let mut name = OsString::new();
    for (index, layout) in layouts.iter().enumerate() {
        name.push(if index == 0 { "" } else { "-and-" });
        name.push(layout.file_stem().unwrap_or_default());
    }
    name.push("-report");
    PathBuf::from(name)
}

/// The live page of a layout without a named destination: `NAME.html` for `NAME.toml`.
pub(super) fn usual_page(layouts: &[PathBuf]) -> PathBuf {
    let stem = layouts.first().and_then(|layout| layout.file_stem()).unwrap_or_default();
    let mut name = OsString::from(stem);
    name.push(".");
    name.push(PAGE_ENDING);
    PathBuf::from(name)
}

impl Destination {
    /// Opens the destination, so that one that cannot be written is refused before any work.
    /// A name with the ending of another kind of file is refused: the folder would pass for one.
    pub(super) fn open(path: &Path, inputs: &[&Path]) -> Result<Destination, Failure> {
        if let Some(ending) = FILE_ENDINGS.iter().find(|ending| has_ending(path, ending)) {
            return Err(Failure::Refused(format!(
                "cannot write {}: a report is a folder of figures with their page, or the page alone as an \
                 .{PAGE_ENDING} file, not a .{ending} file; --figure NAME writes one figure",
                path.display()
            )));
        }
        if has_ending(path, PAGE_ENDING) {
            return Output::open(Some(path), inputs).map(Destination::Page);
        }
        Folder::open(path, "report", inputs).map(Destination::Folder)
    }

    /// Writes the page or all files. Returns the path of the page, and what is beside it in words.
    pub(super) fn write(
        self,
        path: &Path,
        page: &str,
        files: Vec<(String, &[u8])>,
    ) -> Result<(PathBuf, &'static str), Failure> {
        match self {
            Destination::Page(output) => {
                output.complete(page)?;
                Ok((path.to_owned(), ""))
            }
            Destination::Folder(mut folder) => {
                folder.write_all(files)?;
                folder.finish()?;
                Ok((path.join("report.html"), ", each also as SVG, PNG and CSV"))
            }
        }
    }
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|of| of.eq_ignore_ascii_case(ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_folder_has_the_names_of_the_layouts() {
        let name = |layouts: &[&str]| usual(&layouts.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(name(&["films/disc.v2.toml"]), Path::new("disc.v2-report"));
        assert_eq!(name(&["a.toml", "../b.toml"]), Path::new("a-and-b-report"));
        assert_eq!(usual_page(&[PathBuf::from("films/disc.v2.toml")]), Path::new("disc.v2.html"));
    }
}
