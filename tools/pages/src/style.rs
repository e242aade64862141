//! The style of all pictures in `docs/`: the fonts, ink and numbers of the figures of `magsplice
//! report`, and sizes in millimetres.

use std::fs;
use std::path::Path;

/// Fonts of text, as in the figures of reports.
const FONTS: &str = "Roboto, Arial, Helvetica, sans-serif";
/// Colour of text, as in the figures of reports.
const INK: &str = "#1E1E1E";
const MM_PER_INCH: f64 = 25.4;

/// Applies the style of all pictures to a picture from plotters. Its width and height are
/// `px_per_inch` pixels per inch.
pub(crate) fn restyle(path: &Path, px_per_inch: f64) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", path.display());
    let svg = fs::read_to_string(path).map_err(failed)?;
    fs::write(path, styled(&svg, px_per_inch)).map_err(failed)
}

fn styled(svg: &str, px_per_inch: f64) -> String {
    let mut styled = String::with_capacity(svg.len());
    for (number, line) in svg.lines().enumerate() {
        if number == 0 {
            styled += &in_millimetres(line, px_per_inch);
        } else if line.starts_with("<text") {
            let line = line.replace("\"sans-serif\"", &format!("\"{FONTS}\""));
            styled += &line.replace("fill=\"#000000\"", &format!("fill=\"{INK}\""));
        } else if line.starts_with('<') {
            styled += line;
        } else {
            styled += &tick_label(line);
        }
        styled.push('\n');
    }
    styled
}

/// The first line of an SVG with its width and height in millimetres.
fn in_millimetres(head: &str, px_per_inch: f64) -> String {
    let parts = head.split(' ').map(|part| {
        let (key, value) = part.split_once('=').unwrap_or((part, ""));
        match value.trim_matches('"').parse::<f64>() {
            Ok(px) if ["width", "height"].contains(&key) => {
                format!("{key}=\"{}mm\"", (px / px_per_inch * MM_PER_INCH * 1e3).round() / 1e3)
            }
            _ => part.to_owned(),
        }
    });
    parts.collect::<Vec<String>>().join(" ")
}

/// A number of an axis in journal style: 10⁻⁷ for 1e-7, 10 for 10.0. Other text is unchanged.
fn tick_label(text: &str) -> String {
    const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if text.parse::<f64>().is_err() {
        return text.to_owned();
    }
    match text.split_once('e') {
        Some(("1", "0")) => "1".to_owned(),
        Some(("1", "1")) => "10".to_owned(),
        Some((digits, power)) => {
            let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| SUPERSCRIPTS[digit as usize]);
            let power: String = power.chars().map(raised).collect();
            if digits == "1" { format!("10{power}") } else { format!("{digits} × 10{power}") }
        }
        None => text.strip_suffix(".0").unwrap_or(text).replace('-', "\u{2212}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tick_labels_are_powers_of_ten() {
        let labels = ["1e-16", "1e0", "1e1", "2e-3", "1000.0", "10", "-2", "film-exact"].map(tick_label);
        assert_eq!(labels, ["10⁻¹⁶", "1", "10", "2 × 10⁻³", "1000", "10", "\u{2212}2", "film-exact"]);
    }

    #[test]
    fn every_picture_of_the_docs_has_the_style() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/pictures");
        let mut seen = 0;
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let svg = fs::read_to_string(&path).unwrap();
            let head = svg.lines().next().unwrap();
            assert!(head.contains("mm\" height=\"") && !svg.contains("\"sans-serif\""), "{}", path.display());
            let label = |line: &str| !line.starts_with('<') && line.parse::<f64>().is_ok() && line.contains('e');
            assert!(!svg.lines().any(label), "{}", path.display());
            seen += 1;
        }
        assert!(seen >= 15, "{seen} pictures");
    }
}
