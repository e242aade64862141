//! Text inside a page.

/// The template with each placeholder `{{...}}` replaced. Inserted text is not searched for
/// placeholders again.
pub fn filled(template: &str, text: &dyn Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut page = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (placeholder, rest) = part.split_once("}}").expect("the template closes every placeholder");
        page += &text(placeholder);
        page += rest;
    }
    page
}

/// Text with the characters escaped that HTML gives a meaning.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// JSON that cannot close the script element around it.
pub fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inserted_text_is_not_a_placeholder_and_cannot_close_a_script() {
        let text = filled("a {{x}} b {{y}}", &|name| if name == "x" { "{{y}}".to_owned() } else { "1".to_owned() });
        assert_eq!(text, "a {{y}} b 1");
        assert_eq!(in_script("\"</script>\""), "\"\\u003c/script>\"");
    }
}
