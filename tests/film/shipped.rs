//! The shipped layouts: their paths, and a round trip of each.

use std::fs;
use std::path::{Path, PathBuf};

use magsplice::prelude::*;

/// The folder of the shipped layouts.
pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../layouts")
}

/// A layout with every key of the format, in addition to the shipped layouts.
pub(crate) const EVERY_KEY: &str = include_str!("every_key.toml");

/// The shipped layout `<name>.toml`.
pub(crate) fn layout(name: &str) -> Layout {
    Layout::read(folder().join(name).with_extension("toml")).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn shipped_layouts_survive_a_round_trip() {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let layout = Layout::read(&path).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(layout.findings, [], "{}", path.display());
        let again = Layout::parse(&layout.to_toml(), "plain form").unwrap_or_else(|e| panic!("{e}"));
        let tiles = |l: &Layout| l.tiles.iter().map(|t| (t.name.clone(), t.tile)).collect::<Vec<_>>();
        assert_eq!(tiles(&again), tiles(&layout), "{}", path.display());
        assert_eq!((again.ideal, again.volume), (layout.ideal, layout.volume));
        assert_eq!(again.expectations, layout.expectations);
        assert!(!layout.expectations.is_empty(), "{}", path.display());
        names.push((path.file_stem().unwrap().to_str().unwrap().to_owned(), layout.tiles.len()));
    }
    names.sort();
    let known = [
        ("film-40mm", 208),
        ("film-80mm", 800),
        ("published-film", 56),
        ("published-film-component", 56),
        ("single-tile", 1),
    ];
    for (name, tiles) in known {
        assert!(names.contains(&(name.to_owned(), tiles)), "{name} with {tiles} tiles among {names:?}");
    }
}
