//! A page to print and take to the bench: a figure and tables, in one HTML file that loads no
//! other.

use std::fmt::Write;

use crate::drawing::Drawing;
use crate::page::escaped;
use crate::raster_image::data_url;

const STYLE: &str = include_str!("../page/printed.css");

/// A page for printing on A4.
#[derive(Clone, Debug)]
pub(crate) struct PrintedPage<'a> {
    /// Heading of the page.
    pub(crate) title: &'a str,
    /// Paragraphs below it.
    pub(crate) paragraphs: &'a [String],
    /// The figure, with its caption.
    pub(crate) figure: &'a Drawing,
    /// The tables, in order.
    pub(crate) tables: &'a [PrintedTable],
    /// Where the page comes from, at its end.
    pub(crate) source: &'a str,
}

/// A table of a page.
#[derive(Clone, Debug)]
pub(crate) struct PrintedTable {
    /// Heading above it.
    pub(crate) heading: String,
    /// Paragraph between heading and table; empty for none.
    pub(crate) remark: String,
    /// Names of the columns.
    pub(crate) columns: Vec<String>,
    /// Cells of each row.
    pub(crate) rows: Vec<Vec<String>>,
    /// Whether each row begins with an empty box to tick.
    pub(crate) has_boxes: bool,
}

impl PrintedPage<'_> {
    /// The page as HTML.
    pub(crate) fn html(&self) -> String {
        let title = escaped(self.title);
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n\
             <body>\n<h1>{title}</h1>\n"
        );
        for paragraph in self.paragraphs {
            let _ = writeln!(html, "<p>{}</p>", escaped(paragraph));
        }
        let caption = escaped(&self.figure.caption);
        let _ = writeln!(
            html,
            "<figure><img alt=\"{caption}\" src=\"{}\"><figcaption>{caption}</figcaption></figure>",
            data_url("image/svg+xml", self.figure.outlined.as_bytes())
        );
        self.tables.iter().for_each(|table| table.append(&mut html));
        let _ = writeln!(html, "<footer>{}</footer>\n</body>\n</html>", escaped(self.source));
        html
    }
}

impl PrintedTable {
    fn append(&self, html: &mut String) {
        let _ = writeln!(html, "<h2>{}</h2>", escaped(&self.heading));
        if !self.remark.is_empty() {
            let _ = writeln!(html, "<p>{}</p>", escaped(&self.remark));
        }
        let cells = |element: &str, cells: &[String]| -> String {
            cells.iter().map(|cell| format!("<{element}>{}</{element}>", escaped(cell))).collect()
        };
        let [head_box, row_box] =
            if self.has_boxes { ["<th></th>", "<td><span class=\"box\"></span></td>"] } else { [""; 2] };
        let head = cells("th", &self.columns);
        let _ = writeln!(html, "<div class=\"wide\"><table>\n<thead><tr>{head_box}{head}</tr></thead>\n<tbody>");
        for row in &self.rows {
            let _ = writeln!(html, "<tr>{row_box}{}</tr>", cells("td", row));
        }
        *html += "</tbody>\n</table></div>\n";
    }
}
