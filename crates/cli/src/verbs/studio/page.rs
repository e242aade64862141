//! The page.

/// The page of a layout, in one piece of HTML.
pub(super) fn page(name: &str, text: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<title>{}</title>\n<pre>{}</pre>\n",
        escaped(name),
        escaped(text)
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
