//! Two films side by side: their numbers with the difference, and their figures on the same scales.

use magsplice::Film;
use magsplice::results::FilmEvaluation;

use crate::drawing::{Drawing, SvgText};
use crate::error::ReportError;
use crate::figure_drafts::drafts;
use crate::page::{Pages, escaped, figure_element, filled, head};
use crate::paired_numbers::{PairedNumber, numbers};
use crate::report::{PAGE_NAME, absent, rendered};
use crate::shared_ranges::SharedRanges;
use crate::survey::{Survey, tiles_to_draw};
use crate::typeset::number;

const PAGE: &str = include_str!("../page/pair.html");
const STYLE: &str = include_str!("../page/pair.css");

/// Prefixes of the files of the two films.
const PREFIXES: [&str; 2] = ["first", "second"];

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
    /// `labels` tell the films apart, for example the paths of their layouts. `evaluations` are
    /// what [`Film::evaluate`] returns for films with an ideal film and a working volume.
    ///
    /// # Errors
    /// As [`Report::new`](crate::Report::new).
    pub fn new(
        films: [&Film; 2],
        labels: [&str; 2],
        evaluations: &[Option<FilmEvaluation>; 2],
        text: SvgText,
    ) -> Result<PairReport, ReportError> {
        let surveys = [Survey::new(films[0])?, Survey::new(films[1])?];
        let ranges = SharedRanges::default();
        let draw = |film: usize| {
            let tiles = tiles_to_draw(films[film].layout());
            drafts(films[film], &tiles, surveys[film].as_ref(), &ranges)
        };
        // The first drawings only find the ranges that both films share. The vectors need two
        // rounds: their arrows fill the window, and the window is shared.
        for index in [0, 1, 0] {
            draw(index)?;
        }
        let second = draw(1)?;
        let first = draw(0)?;
        let figures = [rendered(films[0], first, text)?, rendered(films[1], second, text)?];
        let absent = films.map(absent);
        let numbers = numbers(films, evaluations);
        let Pages { alone, in_folder } =
            Pages::new(|has_files| page(films, labels, &figures, &absent, &numbers, has_files));
        Ok(PairReport { figures, html: alone, html_in_folder: in_folder, absent })
    }

    /// Names and contents of all files: the page, then SVG, PNG and CSV of each figure.
    pub fn files(&self) -> Vec<(String, &[u8])> {
        let mut files = vec![(PAGE_NAME.to_owned(), self.html_in_folder.as_bytes())];
        for (prefix, figures) in PREFIXES.iter().zip(&self.figures) {
            for (name, contents) in figures.iter().flat_map(Drawing::files) {
                files.push((format!("{prefix}-{name}"), contents));
            }
        }
        files
    }
}

fn page(
    films: [&Film; 2],
    labels: [&str; 2],
    figures: &[Vec<Drawing>; 2],
    absent: &[Vec<String>; 2],
    numbers: &[PairedNumber],
    has_files: bool,
) -> String {
    let names = films.map(|film| escaped(&film.layout().name));
    let labels = labels.map(escaped);
    let films = [0, 1].map(|i| {
        let layout = films[i].layout();
        let missing = absent[i].iter().map(|what| format!("<p class=\"absent\">Absent: {}.</p>", escaped(what)));
        let missing: String = missing.collect();
        let tiles = layout.tiles.len();
        format!(
            "<div><h2>{}</h2><p>{}</p><p>{tiles} tiles, SHA-256 of the layout <code>{}</code></p>{missing}</div>\n",
            names[i], labels[i], layout.sha256
        )
    });
    let title = title(&names, &labels);
    filled(PAGE, &|placeholder| match placeholder {
        "head" => head(&title, STYLE),
        "title" => title.clone(),
        "films" => films.concat(),
        "first" => labels[0].clone(),
        "second" => labels[1].clone(),
        "numbers" => numbers.iter().map(row).collect(),
        "figures" => figure_pairs(figures, &labels, has_files),
        _ => unreachable!("{placeholder} is not a placeholder of the page"),
    })
}

/// Both names; with the labels where the names do not tell the films apart.
fn title(names: &[String; 2], labels: &[String; 2]) -> String {
    let [first, second] = [0, 1].map(|film| {
        let (name, label) = (&names[film], &labels[film]);
        if names[0] == names[1] { format!("{name} ({label})") } else { name.clone() }
    });
    format!("{first} and {second}")
}

/// A row of the table: both values, and the second minus the first.
fn row((name, values): &PairedNumber) -> String {
    let text = |value: Option<f64>| value.map_or("none".to_owned(), number);
    let difference = match values {
        [Some(a), Some(b)] => Some(b - a),
        _ => None,
    };
    let cells = [values[0], values[1], difference].map(|value| format!("<td role=\"cell\">{}</td>", text(value)));
    format!("<tr role=\"row\"><th scope=\"row\" role=\"rowheader\">{}</th>{}</tr>\n", escaped(name), cells.concat())
}

/// Figures of the same name beside each other.
fn figure_pairs(figures: &[Vec<Drawing>; 2], labels: &[String; 2], has_files: bool) -> String {
    let mut names: Vec<&str> = Vec::new();
    for figure in figures.iter().flatten() {
        if !names.contains(&figure.name) {
            names.push(figure.name);
        }
    }
    let pair = |name: &&str| {
        let of_film = |((prefix, figures), label): ((&&str, &Vec<Drawing>), &String)| {
            let figure = figures.iter().find(|figure| figure.name == *name);
            figure.map_or_else(
                || format!("<p class=\"absent\">{label} has no such figure.</p>\n"),
                |figure| figure_element(figure, &format!("{prefix}-{}", figure.name), label, has_files),
            )
        };
        let both: String = PREFIXES.iter().zip(figures).zip(labels).map(of_film).collect();
        format!("<div class=\"pair\">\n{both}</div>\n")
    };
    names.iter().map(pair).collect()
}
