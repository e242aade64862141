//! Puts the engine named by `MAGSPLICE_PAGE_ENGINE`, if any, where the crate includes it.

use std::path::Path;
use std::{env, fs};

const VARIABLE: &str = "MAGSPLICE_PAGE_ENGINE";

fn main() {
    println!("cargo:rerun-if-env-changed={VARIABLE}");
    println!("cargo:rerun-if-changed=build.rs");
    let folder = env::var_os("OUT_DIR").expect("cargo names the folder");
    let engine = match env::var_os(VARIABLE).filter(|path| !path.is_empty()) {
        Some(path) => {
            println!("cargo:rerun-if-changed={}", path.display());
            fs::read(&path).unwrap_or_else(|error| panic!("{VARIABLE}={}: {error}", path.display()))
        }
        None => Vec::new(),
    };
    assert!(engine.is_empty() || engine.starts_with(b"\xfd7zXZ\0"), "{VARIABLE} must name a file compressed by xz");
    fs::write(Path::new(&folder).join("engine.wasm.xz"), engine).expect("the folder can be written");
}
