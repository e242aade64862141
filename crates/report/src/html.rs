//! Parts of the pages.

use crate::drawing::Drawing;
use crate::raster_image::data_url;

const HEAD: &str = include_str!("../page/head.html");
const STYLE: &str = include_str!("../page/page.css");

/// A page as HTML that loads no other file.
#[derive(Clone, Debug)]
pub(crate) struct Pages {
    /// For a file by itself.
    pub(crate) alone: String,
    /// For a folder with the files of the figures, to which it links.
    pub(crate) in_folder: String,
}

impl Pages {
    /// Both forms of a page. `write` is told whether there are files beside it.
    pub(crate) fn new(write: impl Fn(bool) -> String) -> Pages {
        Pages { alone: write(false), in_folder: write(true) }
    }
}

/// The elements of the head of a page with this title. `more_style` is CSS that this page alone
/// needs.
pub(crate) fn head(title: &str, more_style: &str) -> String {
    filled(HEAD, &|placeholder| match placeholder {
        "title" => title.to_owned(),
        "version" => env!("CARGO_PKG_VERSION").to_owned(),
        "style" => [STYLE, more_style].concat(),
        _ => unreachable!("{placeholder} is not a placeholder of the head"),
    })
}

/// The template with each placeholder `{{...}}` replaced. Inserted text is not searched for
/// placeholders again.
pub(crate) fn filled(template: &str, text: &dyn Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut page = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (placeholder, rest) = part.split_once("}}").expect("the template closes every placeholder");
        page += &text(placeholder);
        page += rest;
    }
    page
}

/// The list of links at the top of a page, from ids and headings.
pub(crate) fn contents(entries: impl Iterator<Item = (String, String)>) -> String {
    entries.map(|(id, heading)| format!("<li><a href=\"#{id}\">{heading}</a></li>\n")).collect()
}

/// A figure with its caption. `file` is the name of its files, to which it links if they are beside
/// the page; `film` tells films apart where there are several.
///
/// A tap opens the picture over the whole page, without a script: it is the target of a link.
pub(crate) fn figure_element(figure: &Drawing, file: &str, film: &str, has_files: bool) -> String {
    let caption = escaped(&figure.caption);
    let [alt, strong] = match film {
        "" => ["".to_owned(), "".to_owned()],
        film => [format!("{film}: "), format!("<strong>{film}</strong> ")],
    };
    let links = if has_files {
        let link = |ending: &str, text: &str| format!("<a href=\"{file}.{ending}\">{text}</a>");
        let [svg, png, csv] = [("svg", "SVG"), ("png", "PNG"), ("csv", "CSV of its data")].map(|(e, t)| link(e, t));
        format!(" Files beside this page: {svg}, {png}, {csv}.")
    } else {
        String::new()
    };
    format!(
        "<figure id=\"{file}\"><div class=\"picture\" id=\"{file}-large\"><a class=\"close\" href=\"#{file}\">Close</a><a \
         class=\"open\" href=\"#{file}-large\" title=\"Enlarge\"><img alt=\"{alt}{caption}\" \
         src=\"{}\"></a></div><figcaption>{strong}{caption}{links}</figcaption></figure>\n",
        data_url("image/svg+xml", figure.outlined.as_bytes())
    )
}

/// Text with the characters escaped that HTML gives a meaning.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// JSON that cannot close the script element around it.
pub(crate) fn in_script(json: &str) -> String {
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
