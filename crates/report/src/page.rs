//! The page of one film: a verdict and the numbers that matter, all numbers in tables, a 3D view of
//! the tiles with maps of the field, and the figures, in one file that loads no other.

use magsplice::Film;
use magsplice::results::IronSummary;
use magsplice_live_page::html::{escaped, filled, in_script};

use crate::drawing::Drawing;
use crate::film_results::FilmResults;
use crate::html::{Pages, contents, figure_element, head};
use crate::number_tables::{entries, number_tables, tables_of_film};
use crate::page_data::{page_data_json, refinement, strides};
use crate::typeset::AXIS_NAMES;
use crate::verdict::summary;

const PAGE: &str = include_str!("../page/page.html");
const VIEWS: &str = include_str!("../page/views.html");
const MAP: &str = include_str!("../page/map.html");
const SCRIPTS: [&str; 6] = [
    include_str!("../page/numbers.js"),
    include_str!("../page/tile_field.js"),
    include_str!("../page/selection.js"),
    include_str!("../page/map.js"),
    include_str!("../page/view.js"),
    include_str!("../page/start.js"),
];

/// File name of the live page beside this one.
pub(crate) const LIVE_PAGE_NAME: &str = "live.html";

/// What the frame in the view means.
const FRAME_HINT: &str = "\nThe blue frame is the working volume, dashed where tiles hide it.";

/// The page of a film.
pub(crate) fn page(of: &FilmResults, figures: &[Drawing]) -> Pages {
    let layout = of.film.layout();
    let description = layout.description.as_ref().map_or(String::new(), |text| format!("<p>{}</p>\n", escaped(text)));
    let tables = number_tables(std::slice::from_ref(of));
    let of_figures = figures.iter().map(|figure| (figure.name.to_owned(), figure.heading().to_owned()));
    let all = entries(&tables).chain([("views".to_owned(), "Views".to_owned())]).chain(of_figures);
    let contents = contents(all.chain([("source".to_owned(), "Source".to_owned())]));
    let (views, data) = (views(of, "", ""), data(of, ""));
    let placed = |placeholder: &str, has_files: bool| match placeholder {
        "head" => head(&escaped(&layout.name), ""),
        "name" => escaped(&layout.name),
        "description" => description.clone(),
        "live" if has_files && of.input.live_page.is_some() => {
            format!("<p><a href=\"{LIVE_PAGE_NAME}\">Change this film</a></p>\n")
        }
        "live" => String::new(),
        "summary" => summary(of, ""),
        "contents" => contents.clone(),
        "numbers" => tables_of_film(&tables),
        "views" => views.clone(),
        "figures" => figures.iter().map(|figure| titled_figure(figure, has_files)).collect(),
        "facts" => facts(of, ""),
        "data" => data.clone(),
        "script" => script(),
        _ => unreachable!("{placeholder} is not a placeholder of the page"),
    };
    Pages::new(|has_files| filled(PAGE, &|placeholder| placed(placeholder, has_files)))
}

/// All scripts.
pub(crate) fn script() -> String {
    SCRIPTS.concat()
}

fn titled_figure(figure: &Drawing, has_files: bool) -> String {
    format!("<h3>{}</h3>\n{}", figure.heading(), figure_element(figure, figure.name, "", has_files))
}

/// The view of the tiles and the map of the working volume. `prefix` begins all ids; `film` tells
/// films apart where there are several.
pub(crate) fn views(of: &FilmResults, prefix: &str, film: &str) -> String {
    let film = if film.is_empty() { String::new() } else { format!(": {film}") };
    let of_view = |placeholder: &str| match placeholder {
        "prefix" => prefix.to_owned(),
        "film" => film.clone(),
        "frame_hint" => if of.survey.is_some() { FRAME_HINT } else { "" }.to_owned(),
        "map" => String::new(),
        _ => unreachable!("{placeholder} is not a placeholder of the views"),
    };
    let map = if of.survey.is_some() { filled(MAP, &of_view) } else { String::new() };
    filled(VIEWS, &|placeholder| if placeholder == "map" { map.clone() } else { of_view(placeholder) })
}

/// The results and the data of the views as script elements.
pub(crate) fn data(of: &FilmResults, prefix: &str) -> String {
    let (json, data) =
        (in_script(&of.input.json), in_script(&page_data_json(&of.tiles, of.survey.as_ref(), of.page_field.as_ref())));
    format!(
        "<script type=\"application/json\" id=\"{prefix}numbers-json\">{json}</script>\n<script type=\"application/json\" \
         id=\"{prefix}data\">{data}</script>\n"
    )
}

/// Where the numbers come from and what they cover.
pub(crate) fn facts(of: &FilmResults, prefix: &str) -> String {
    let (film, drawn): (&Film, usize) = (of.film, of.tiles.len());
    let layout = film.layout();
    let mut facts = vec![
        ("SHA-256 of the layout", format!("<code id=\"{prefix}sha256\">{}</code>", layout.sha256)),
        ("magsplice", env!("CARGO_PKG_VERSION").to_owned()),
        ("Accuracy of the field", escaped(&film.scene().accuracy().to_string())),
        (
            "Tiles",
            match layout.tiles.len() {
                all if all == drawn => all.to_string(),
                all => format!("{all}, of which the {drawn} nearest to the reference point are drawn"),
            },
        ),
    ];
    if let Some(iron) = IronSummary::of(layout) {
        facts.push(("Iron", escaped(&iron.to_string())));
    }
    if let Some(survey) = &of.survey {
        let (v, strides) = (survey.volume, strides(survey.volume.grid.counts()));
        let (l, u, s, r) = (v.lower_mm, v.upper_mm, v.step_mm, v.reference_mm);
        let ranges = format!("x {} .. {}, y {} .. {}, z {} .. {} mm", l.x, u.x, l.y, u.y, l.z, u.z);
        let step = if s.x == s.y && s.x == s.z { format!("{}", s.x) } else { format!("{}, {}, {}", s.x, s.y, s.z) };
        let along = AXIS_NAMES.iter().zip(strides).filter(|(_, stride)| *stride > 1);
        let along: Vec<String> = along.map(|(axis, stride)| format!("one point of {stride} along {axis}")).collect();
        let thinned = if refinement(v.grid.counts())[0] > 1 {
            "; the map on this page also shows the field between them".to_owned()
        } else if along.is_empty() {
            String::new()
        } else {
            format!("; the map on this page shows {}", along.join(", "))
        };
        let text = format!("{ranges}, step {step} mm, {} points{thinned}", v.grid.len());
        facts.push(("Working volume", text));
        facts.push(("Reference point", format!("({}, {}, {}) mm", r.x, r.y, r.z)));
    }
    facts.iter().map(|(term, text)| format!("<dt>{term}</dt><dd>{text}</dd>\n")).collect()
}
