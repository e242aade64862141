//! Writes the live page of a layout: `live_page LAYOUT MODULE PAGE`, where MODULE is the engine of
//! the page, compressed by xz.

use std::{env, fs};

use magsplice_live_page::{LivePage, PageEngine, live_page};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [layout, module, page] = arguments.as_slice() else { return Err("needs LAYOUT MODULE PAGE".into()) };
    let (text, module) = (fs::read_to_string(layout)?, fs::read(module)?);
    let name = layout.rsplit('/').next().unwrap_or(layout);
    fs::write(page, live_page(&LivePage { name, text: &text, engine: PageEngine::Module(&module) }))?;
    Ok(())
}
