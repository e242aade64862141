//! Results as JSON.

use serde::Serialize;

/// A value as JSON with one line per entry.
pub(crate) fn pretty(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(value).expect("results hold numbers and strings only");
    text.push('\n');
    text
}
