//! Two films side by side: their verdicts, their numbers with the difference, their views, and
//! their figures on the same scales.

use magsplice::Film;

use crate::drawing::{Drawing, SvgText};
use crate::error::ReportError;
use crate::figure_drafts::drafts;
use crate::film_results::{FilmResults, ReportInput};
use crate::html::{Pages, contents, figure_element, head};
use crate::number_tables::{entries, number_tables, tables_of_pair};
use crate::page::{data, facts, script, views};
use crate::report::{PAGE_NAME, rendered};
use crate::shared_ranges::SharedRanges;
use crate::verdict::summary;
use magsplice_live_page::html::{escaped, filled};

const PAGE: &str = include_str!("../page/pair.html");

/// Prefixes of the files and of the ids of the two films.
const PREFIXES: [&str; 2] = ["first-", "second-"];

/// The figures of two films on the same scales, and a page that shows them side by side.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PairReport {
    /// The figures of each film.
    pub figures: [Vec<Drawing>; 2],
    /// The page by itself: HTML that loads no other file.
    pub html: String,
    /// The page with links to the files of the figures, for a folder with them.
    pub html_in_folder: String,
    /// What the report lacks of each film, and why.
    pub absent: [Vec<String>; 2],
}

impl PairReport {
    /// Draws all figures that the layouts allow, and the page.
    ///
    /// `labels` tell the films apart, for example the paths of their layouts.
    ///
    /// # Errors
    /// As [`Report::new`](crate::Report::new).
    pub fn new(
        films: [&Film; 2],
        labels: [&str; 2],
        inputs: &[ReportInput; 2],
        text: SvgText,
    ) -> Result<PairReport, ReportError> {
        let results = [FilmResults::new(films[0], &inputs[0])?, FilmResults::new(films[1], &inputs[1])?];
        let ranges = SharedRanges::default();
        // The first drawings only find the ranges that both films share. The vectors need two
        // rounds: their arrows fill the window, and the window is shared.
        for index in [0, 1, 0] {
            drafts(&results[index], &ranges)?;
        }
        let second = drafts(&results[1], &ranges)?;
        let first = drafts(&results[0], &ranges)?;
        let figures = [rendered(films[0], first, text)?, rendered(films[1], second, text)?];
        let Pages { alone, in_folder } = pages(&results, &labels.map(escaped), &figures);
        let absent = results.map(|of| of.absent);
        Ok(PairReport { figures, html: alone, html_in_folder: in_folder, absent })
    }

    /// Names and contents of all files: the page, then SVG, PNG and CSV of each figure.
    pub fn files(&self) -> Vec<(String, &[u8])> {
        let mut files = vec![(PAGE_NAME.to_owned(), self.html_in_folder.as_bytes())];
        for (prefix, figures) in PREFIXES.iter().zip(&self.figures) {
            for (name, contents) in figures.iter().flat_map(Drawing::files) {
                files.push((format!("{prefix}{name}"), contents));
            }
        }
        files
    }
}

fn pages(results: &[FilmResults; 2], labels: &[String; 2], figures: &[Vec<Drawing>; 2]) -> Pages {
    let names = results.each_ref().map(|of| escaped(&of.film.layout().name));
    let title = title(&names, labels);
    let each = |part: &dyn Fn(usize) -> String| -> String {
        (0..2).map(|film| format!("<div>\n{}</div>\n", part(film))).collect()
    };
    let summaries = each(&|film| {
        let description = results[film].film.layout().description.as_deref().map_or(String::new(), escaped);
        let (name, label, summary) = (&names[film], &labels[film], summary(&results[film], PREFIXES[film]));
        format!("<h2>{name}</h2>\n<p>{label}</p>\n<p>{description}</p>\n{summary}")
    });
    let facts = each(&|film| {
        format!("<h3>{}</h3>\n<dl class=\"facts\">\n{}</dl>\n", labels[film], facts(&results[film], PREFIXES[film]))
    });
    let tables = number_tables(results);
    let shown: Vec<&Drawing> = figures[0]
        .iter()
        .chain(figures[1].iter().filter(|second| figures[0].iter().all(|first| first.name != second.name)))
        .collect();
    let of_views = (0..2).map(|film| (format!("{}views", PREFIXES[film]), format!("Views: {}", labels[film])));
    let of_figures = shown.iter().map(|figure| (figure.name.to_owned(), figure.heading().to_owned()));
    let all = entries(&tables).chain(of_views).chain(of_figures);
    let contents = contents(all.chain([("source".to_owned(), "Source".to_owned())]));
    let of_both = |part: fn(&FilmResults, &str, &str) -> String| -> String {
        (0..2).map(|film| part(&results[film], PREFIXES[film], &labels[film])).collect()
    };
    let (views, data) = (of_both(views), of_both(|of, prefix, _| data(of, prefix)));
    let placed = |placeholder: &str, has_files: bool| match placeholder {
        "head" => head(&title, ""),
        "title" => title.clone(),
        "films" => summaries.clone(),
        "contents" => contents.clone(),
        "numbers" => tables_of_pair(&tables, labels),
        "views" => views.clone(),
        "figures" => shown.iter().map(|of| figure_pair(of, figures, labels, has_files)).collect(),
        "facts" => facts.clone(),
        "data" => data.clone(),
        "script" => script(),
        _ => unreachable!("{placeholder} is not a placeholder of the page"),
    };
    Pages::new(|has_files| filled(PAGE, &|placeholder| placed(placeholder, has_files)))
}

/// Both names; with the labels where the names do not tell the films apart.
fn title(names: &[String; 2], labels: &[String; 2]) -> String {
    let [first, second] = [0, 1].map(|film| {
        let (name, label) = (&names[film], &labels[film]);
        if names[0] == names[1] { format!("{name} ({label})") } else { name.clone() }
    });
    format!("{first} and {second}")
}

/// The figures with this one's name beside each other.
fn figure_pair(of: &Drawing, figures: &[Vec<Drawing>; 2], labels: &[String; 2], has_files: bool) -> String {
    let of_film = |film: usize| {
        let (label, figure) = (&labels[film], figures[film].iter().find(|figure| figure.name == of.name));
        figure.map_or_else(
            || format!("<p class=\"absent\">{label} has no such figure.</p>\n"),
            |figure| figure_element(figure, &format!("{}{}", PREFIXES[film], of.name), label, has_files),
        )
    };
    let both: String = (0..2).map(of_film).collect();
    format!("<h3 id=\"{}\">{}</h3>\n<div class=\"pair\">\n{both}</div>\n", of.name, of.heading())
}
