//! A film as a Python script for magpylib.

use std::fmt::Write as _;
use std::io::{self, Write};

use glam::DVec3;
use magsplice_layout::{Layout, NamedTile};

/// The script, with placeholders `"{...}"` for its data.
const SCRIPT: &str = include_str!("magpylib.py");

/// Writes a script for magpylib 5 and 6. It builds the film as a collection of cuboids. When run,
/// it prints B at the reference point of the working volume and at the points of a CSV file.
///
/// `version` is the version of the writing program.
///
/// # Accuracy
/// Tiles keep the digits of the layout. The script divides lengths by 1000, because magpylib takes
/// metres; this rounds each length once.
///
/// # Errors
/// Errors of the writer.
pub fn script(layout: &Layout, version: &str, w: &mut dyn Write) -> io::Result<()> {
    let reference = layout.volume.map_or("None".to_owned(), |volume| tuple(volume.reference_mm));
    let mut tiles = String::new();
    for tile in &layout.tiles {
        let _ = writeln!(tiles, "    {},", entry(tile));
    }
    let text = SCRIPT
        .replace("\"{version}\"", &literal(version))
        .replace("\"{sha256}\"", &literal(&layout.sha256))
        .replace("\"{reference}\"", &reference)
        .replace("    \"{tiles}\",\n", &tiles)
        // Last, because a name may contain any text, including another placeholder.
        .replacen("\"{layout}\"", &literal(&layout.name), 1);
    w.write_all(text.as_bytes())
}

/// The line of a tile in the list of the script.
fn entry(named: &NamedTile) -> String {
    let (tile, rotation) = (&named.tile, named.tile.rotation());
    let quaternion = format!("({:?}, {:?}, {:?}, {:?})", rotation.x, rotation.y, rotation.z, rotation.w);
    let vectors = [tile.position(), tile.size(), tile.polarization_t()].map(tuple).join(", ");
    format!("({}, {vectors}, {quaternion})", literal(&named.name))
}

/// A tuple in Python, with the shortest digits that read back to the same numbers.
fn tuple(v: DVec3) -> String {
    format!("({:?}, {:?}, {:?})", v.x, v.y, v.z)
}

/// A string literal of Python. Python has all the escapes of JSON.
fn literal(text: &str) -> String {
    serde_json::to_string(text).expect("text always serializes as JSON")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn script_fills_every_placeholder_and_quotes_names() {
        let name = r#"\"\"\"\n{tiles}\nimport os #"#;
        let text = "format = 1\nname = \"film\"\n[[tile]]\nposition_mm = [0.1, 0, 1e-9]\n\
                    size_mm = [1, 2, 3]\npolarization_t = [0, 0, 0.12]\n";
        let mut layout = Layout::parse(text, "test").unwrap();
        // Such a name is invalid in layout files, but possible in memory.
        let unquoted: String = serde_json::from_str(&format!("\"{name}\"")).unwrap();
        layout.name.clone_from(&unquoted);
        layout.tiles[0].name = unquoted;
        let mut script = Vec::new();
        super::script(&layout, "1.2.3", &mut script).unwrap();
        let script = String::from_utf8(script).unwrap();
        assert!(script.contains(&format!("\nLAYOUT = \"{name}\"\n")), "{script}");
        assert!(script.contains("\nREFERENCE_MM = None\n") && script.contains("\nPROGRAM = \"1.2.3\"\n"), "{script}");
        let line = "(0.1, 0.0, 1e-9), (1.0, 2.0, 3.0), (0.0, 0.0, 0.12), (0.0, 0.0, 0.0, 1.0)),\n";
        assert!(script.contains(&format!("    (\"{name}\", {line}")), "{script}");
        assert_eq!(script.matches("import os").count(), script.matches(name).count());
        assert_eq!(script.lines().filter(|l| l.starts_with("import os")).count(), 0);
    }
}
