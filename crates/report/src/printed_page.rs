//! A page to print and take to the bench: a figure and tables, in one HTML file that loads no
//! other.

use std::fmt::Write;

use crate::drawing::Drawing;
use crate::raster_image::data_url;
use magsplice_live_page::html::escaped;

const STYLE: &str = include_str!("../page/printed.css");

/// A table of a page.
pub(crate) struct PrintedTable<'a> {
    /// Heading above it.
    pub(crate) heading: &'a str,
    /// Paragraph between heading and table.
    pub(crate) remark: String,
    /// Names of the columns.
    pub(crate) columns: Vec<&'a str>,
    /// Cells of each row.
    pub(crate) rows: Vec<Vec<String>>,
    /// Whether each row begins with an empty box to tick.
    pub(crate) has_boxes: bool,
}

/// A page for printing on A4 as HTML: heading, paragraphs, a figure with its caption, tables, and
/// at the end where it comes from.
pub(crate) fn printed_page(
    title: &str,
    paragraphs: &[String],
    figure: &Drawing,
    tables: &[PrintedTable],
    source: &str,
) -> String {
    let title = escaped(title);
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n\
         <body>\n<h1>{title}</h1>\n"
    );
    for paragraph in paragraphs {
        let _ = writeln!(html, "<p>{}</p>", escaped(paragraph));
    }
    let (caption, image) = (escaped(&figure.caption), data_url("image/svg+xml", figure.outlined.as_bytes()));
    let _ =
        writeln!(html, "<figure><img alt=\"{caption}\" src=\"{image}\"><figcaption>{caption}</figcaption></figure>");
    tables.iter().for_each(|table| table.append(&mut html));
    let _ = writeln!(html, "<footer>{}</footer>\n</body>\n</html>", escaped(source));
    html
}

/// A cell whose names, separated by commas, have no line breaks at their hyphens.
fn in_whole_names(cell: &str) -> String {
    let names: Vec<String> = cell.split(", ").map(|name| format!("<span>{}</span>", escaped(name))).collect();
    if names.len() > 1 { names.join(", ") } else { escaped(cell) }
}

impl PrintedTable<'_> {
    fn append(&self, html: &mut String) {
        let [head_box, row_box] =
            if self.has_boxes { ["<th></th>", "<td><span class=\"box\"></span></td>"] } else { [""; 2] };
        let head: String = self.columns.iter().map(|name| format!("<th>{}</th>", escaped(name))).collect();
        let _ = writeln!(
            html,
            "<h2>{}</h2>\n<p>{}</p>\n<div class=\"wide\"><table>\n<thead><tr>{head_box}{head}</tr></thead>\n<tbody>",
            escaped(self.heading),
            escaped(&self.remark)
        );
        for row in &self.rows {
            let cells: String = row.iter().map(|cell| format!("<td>{}</td>", in_whole_names(cell))).collect();
            let _ = writeln!(html, "<tr>{row_box}{cells}</tr>");
        }
        *html += "</tbody>\n</table></div>\n";
    }
}
