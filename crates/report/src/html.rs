//! Parts of the pages.

use magsplice_live_page::html::{escaped, filled};

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
