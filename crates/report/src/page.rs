//! The HTML page: figures, printed results, a 3D view of the tiles and maps of the field, in one
//! file that loads no other.

use magsplice::Film;
use magsplice::layout::NamedTile;

use crate::drawing::Drawing;
use crate::page_data::{page_data_json, strides};
use crate::raster_image::data_url;
use crate::survey::Survey;
use crate::typeset::AXIS_NAMES;

const PAGE: &str = include_str!("../page/page.html");
const MAP: &str = include_str!("../page/map.html");
const HEAD: &str = include_str!("../page/head.html");
const STYLE: &str = include_str!("../page/page.css");
const SCRIPTS: [&str; 6] = [
    include_str!("../page/numbers.js"),
    include_str!("../page/tile_field.js"),
    include_str!("../page/selection.js"),
    include_str!("../page/map.js"),
    include_str!("../page/view.js"),
    include_str!("../page/start.js"),
];

/// What the frame in the view means.
const FRAME_HINT: &str = "\nThe blue frame is the working volume, dashed where tiles hide it.";

/// The results of a film as the program prints them, which the page repeats.
#[derive(Clone, Copy, Debug)]
pub struct PrintedResults<'a> {
    /// The text for readers, shown on the page.
    pub text: &'a str,
    /// The same results as a JSON object, contained in the page for programs.
    pub json: &'a str,
}

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

/// The page of a film. `tiles` are the ones drawn; `absent` says what the report lacks, and why.
pub(crate) fn page(
    film: &Film,
    survey: Option<&Survey>,
    tiles: &[&NamedTile],
    figures: &[Drawing],
    absent: &[String],
    results: PrintedResults,
) -> Pages {
    let layout = film.layout();
    let data = in_script(&page_data_json(tiles, survey));
    let description = layout.description.as_ref().map_or(String::new(), |text| format!("<p>{}</p>\n", escaped(text)));
    let absent: String =
        absent.iter().map(|what| format!("<p class=\"absent\">Absent: {}.</p>\n", escaped(what))).collect();
    let placed = |placeholder: &str, has_files: bool| match placeholder {
        "head" => head(&escaped(&layout.name), ""),
        "name" => escaped(&layout.name),
        "description" => description.clone(),
        "facts" => facts(film, survey, tiles.len()),
        "absent" => absent.clone(),
        "frame_hint" => if survey.is_some() { FRAME_HINT } else { "" }.to_owned(),
        "map" => if survey.is_some() { MAP } else { "" }.to_owned(),
        "numbers" => escaped(results.text),
        "numbers_json" => in_script(results.json),
        "data" => data.clone(),
        "figures" => figures.iter().map(|figure| figure_element(figure, figure.name, "", has_files)).collect(),
        "script" => SCRIPTS.concat(),
        _ => unreachable!("{placeholder} is not a placeholder of the page"),
    };
    Pages::new(|has_files| filled(PAGE, &|placeholder| placed(placeholder, has_files)))
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

/// The list at the top of the page: where the numbers come from and what they cover.
fn facts(film: &Film, survey: Option<&Survey>, drawn: usize) -> String {
    let layout = film.layout();
    let mut facts = vec![
        ("SHA-256 of the layout", format!("<code id=\"sha256\">{}</code>", layout.sha256)),
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
    if let Some(survey) = survey {
        let (v, strides) = (survey.volume, strides(survey.volume.grid.counts()));
        let (l, u, s) = (v.lower_mm, v.upper_mm, v.step_mm);
        let ranges = format!("x {} .. {}, y {} .. {}, z {} .. {} mm", l.x, u.x, l.y, u.y, l.z, u.z);
        let step = if s.x == s.y && s.x == s.z { format!("{}", s.x) } else { format!("{}, {}, {}", s.x, s.y, s.z) };
        let along = AXIS_NAMES.iter().zip(strides).filter(|(_, stride)| *stride > 1);
        let along: Vec<String> = along.map(|(axis, stride)| format!("one point of {stride} along {axis}")).collect();
        let thinned =
            if along.is_empty() { String::new() } else { format!("; the map on this page shows {}", along.join(", ")) };
        let text = format!("{ranges}, step {step} mm, {} points{thinned}", v.grid.len());
        facts.push(("Working volume", text));
    }
    facts.iter().map(|(term, text)| format!("<dt>{term}</dt><dd>{text}</dd>\n")).collect()
}

/// A figure with its caption. `file` is the name of its files, to which it links if they are beside
/// the page; `film` tells films apart where there are several.
pub(crate) fn figure_element(figure: &Drawing, file: &str, film: &str, has_files: bool) -> String {
    let caption = escaped(&figure.caption);
    let [alt, strong] = if film.is_empty() {
        [String::new(), String::new()]
    } else {
        [format!("{film}: "), format!("<strong>{film}</strong> ")]
    };
    let image =
        format!("<img alt=\"{alt}{caption}\" src=\"{}\">", data_url("image/svg+xml", figure.outlined.as_bytes()));
    let [image, links] = if has_files {
        let link = |ending: &str, text: &str| format!("<a href=\"{file}.{ending}\">{text}</a>");
        let [svg, png, csv] = [("svg", "SVG"), ("png", "PNG"), ("csv", "CSV of its data")].map(|(e, t)| link(e, t));
        [link("svg", &image), format!(" Files beside this page: {svg}, {png}, {csv}.")]
    } else {
        [image, String::new()]
    };
    format!("<figure id=\"{file}\">{image}<figcaption>{strong}{caption}{links}</figcaption></figure>\n")
}

/// Text with the characters escaped that HTML gives a meaning.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// JSON that cannot close the script element around it.
fn in_script(json: &str) -> String {
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
