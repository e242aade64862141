//! Rules for names: their length and characters.

use strsim::jaro_winkler;

use crate::faults::TableFaults;
use crate::limits::{MAX_NAME_BYTES, MAX_SHOWN};

/// Requires a name that is not too long and has no characters that end or rearrange a line.
pub(crate) fn check_name(key: &str, name: &str, faults: &mut TableFaults) {
    if name.len() > MAX_NAME_BYTES {
        faults.add(format!("{key} = \"{}\" has {} bytes, must have at most {MAX_NAME_BYTES}", shown(name), name.len()));
    }
    if let Some(forbidden) = name.chars().find(|c| rearranges_text(*c)) {
        faults.add(format!(
            "{key} = \"{}\" has the character U+{:04X}, must have no control characters and line breaks",
            shown(name),
            u32::from(forbidden)
        ));
    }
}

/// The known name most like an unknown one, as a question.
pub(crate) fn did_you_mean<'n>(unknown: &str, known: impl Iterator<Item = &'n str>) -> String {
    let nearest = known.map(|name| (jaro_winkler(unknown, name), name)).max_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map_or(String::new(), |(_, name)| format!(" (did you mean \"{}\"?)", shown(name)))
}

/// Control characters, ends of lines and paragraphs, and marks that reverse the direction of text:
/// what a terminal obeys, or what makes a line read other than it is.
pub fn rearranges_text(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The beginning of a name, with escapes for characters that cannot be printed.
pub(crate) fn shown(name: &str) -> String {
    let start: String = name.chars().take(MAX_SHOWN).flat_map(escaped).collect();
    if name.chars().nth(MAX_SHOWN).is_some() { format!("{start}...") } else { start }
}

/// The character, or its escape if it is forbidden in names.
pub(crate) fn escaped(c: char) -> impl Iterator<Item = char> {
    let escape = rearranges_text(c).then(|| c.escape_default());
    escape.is_none().then_some(c).into_iter().chain(escape.into_iter().flatten())
}
