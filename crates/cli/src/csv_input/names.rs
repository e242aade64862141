//! Names of columns with units: `x_mm`, `x (mm)`, `x[mm]`, `X_mm`, `x/mm`, `x, mm`.

/// The unit in the name of a column that is called `base`, in lower case; empty if the name has no
/// unit. `None` if it is the name of another column.
pub(crate) fn unit_in(name: &str, base: &str) -> Option<String> {
    // Quotes that a reader of CSV leaves, because they do not begin the cell or are single.
    let name = name.trim_matches(['"', '\'', ' ', '\t']).to_lowercase();
    let rest = without(&name, base)?;
    if rest.is_empty() {
        return Some(String::new());
    }
    let unit = rest.trim_start_matches(['_', '/', ' ', ',', ':']).trim();
    let unit = unit.strip_prefix("in ").unwrap_or(unit).trim_start();
    let bracketed = |open, close| unit.strip_prefix(open).and_then(|unit: &str| unit.strip_suffix(close));
    let in_brackets = bracketed('(', ')').or(bracketed('[', ']')).or(bracketed('{', '}')).map(str::trim);
    let unit = in_brackets.or_else(|| (unit.len() < rest.len()).then_some(unit))?;
    (!unit.is_empty()).then(|| unit.to_owned())
}

/// What follows `base`, whose words may be separated by a space or a hyphen instead of `_`.
fn without<'n>(name: &'n str, base: &str) -> Option<&'n str> {
    let (start, rest) = name.split_at_checked(base.len())?;
    let is_same = |(found, wanted): (char, char)| found == wanted || wanted == '_' && matches!(found, ' ' | '-');
    start.chars().zip(base.chars()).all(is_same).then_some(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_in_every_form() {
        for name in ["x_mm", "x (mm)", "x[mm]", "X_mm", " x (mm) ", "x/mm", "x mm", "x_(mm)", "x(mm)", "X [ MM ]"]
            .into_iter()
            .chain(["x / mm", "x, mm", "x: mm", "x in mm", "x {mm}", "\"x (mm)\"", "'x_mm'"])
        {
            assert_eq!(unit_in(name, "x").as_deref(), Some("mm"), "{name}");
        }
        assert_eq!(unit_in("x in", "x").as_deref(), Some("in"));
        assert_eq!(unit_in("Hx/(A/m)", "hx").as_deref(), Some("a/m"));
        assert_eq!(unit_in("Jx (kA/m)", "jx").as_deref(), Some("ka/m"));
        assert_eq!(unit_in("size_x_mm", "size_x").as_deref(), Some("mm"));
        assert_eq!(unit_in("X", "x").as_deref(), Some(""));
        assert_eq!(unit_in("X Pos [mm]", "x_pos").as_deref(), Some("mm"));
        assert_eq!(unit_in("é", "b_x"), None);
        for name in ["", "y", "xmm", "xy_mm", "x_", "x()", "note"] {
            assert_eq!(unit_in(name, "x"), None, "{name}");
        }
    }
}
