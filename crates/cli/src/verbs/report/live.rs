//! `report --live`: one page on which the film is changed and evaluated.

use std::fs;
use std::path::{Path, PathBuf};

use magsplice::layout::Layout;
use magsplice_live_page::{LivePage, MAGIC, PageEngine, built_in_engine, live_page};

use crate::failure::Failure;
use crate::output::destination::Output;
use crate::remarks;
use crate::session::Session;

/// Largest module that is read. Ours has a megabyte.
const MOST_BYTES: u64 = 64 << 20;

/// The engine of the live page, if the program has one.
pub(super) struct Engine(Option<Vec<u8>>);

impl Engine {
    /// The engine of a file, or the one built into the program.
    pub(super) fn open(path: Option<&Path>) -> Result<Engine, Failure> {
        let Some(path) = path else { return Ok(Engine(built_in_engine().map(<[u8]>::to_vec))) };
        let refused = |reason: String| Failure::at(path, reason);
        let size = fs::metadata(path).map_err(|error| refused(error.to_string()))?.len();
        if size > MOST_BYTES {
            return Err(refused(format!("{size} bytes, an engine has at most {MOST_BYTES}")));
        }
        let module = fs::read(path).map_err(|error| refused(error.to_string()))?;
        if !module.starts_with(MAGIC) {
            return Err(refused("is not compressed by xz, as the engine of a live page is".to_owned()));
        }
        Ok(Engine(Some(module)))
    }

    /// The live page of a layout. `None` without an engine, and for a layout without a file.
    pub(super) fn page(&self, layout: &Layout, path: &Path) -> Option<String> {
        let (module, file) = (self.0.as_ref()?, layout.file.as_ref()?);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Some(live_page(&LivePage { name: &name, text: &file.text, engine: PageEngine::Module(module) }))
    }
}

/// Writes the live page of one layout.
pub(super) fn write(layouts: &[PathBuf], output: &Path, engine: &Engine, quiet: bool) -> Result<(), Failure> {
    let [path] = layouts else {
        return Err(Failure::Refused("--live shows one film: give one layout".to_owned()));
    };
    if engine.0.is_none() {
        return Err(Failure::Refused(
            "--live: this program was compiled without the engine of the live page. Give the module with --engine FILE \
             (`.ci/page-engine --build` in the repository makes it), or use `magsplice studio`, which needs none"
                .to_owned(),
        ));
    }
    let session = Session::open(path, remarks::OF_COMPARISONS, quiet)?;
    let file = Output::open(Some(output), &[path])?;
    let page = engine.page(&session.layout, path);
    let page = page.ok_or_else(|| Failure::at(path, "a live page needs the text of a layout"))?;
    file.complete(&page)?;
    session.print(&format!("{}: {}, live\n", output.display(), session.layout.name))
}
