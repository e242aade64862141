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

/// The page as HTML. `tiles` are the ones drawn; `absent` says what the report lacks, and why.
pub(crate) fn page(
    film: &Film,
    survey: Option<&Survey>,
    tiles: &[&NamedTile],
    figures: &[Drawing],
    absent: &[String],
    results: PrintedResults,
) -> String {
    let layout = film.layout();
    let data = page_data_json(tiles, survey);
    let description = layout.description.as_ref().map_or(String::new(), |text| format!("<p>{}</p>\n", escaped(text)));
    let absent: String =
        absent.iter().map(|what| format!("<p class=\"absent\">Absent: {}.</p>\n", escaped(what))).collect();
    filled(PAGE, &|placeholder| match placeholder {
        "head" => head(&escaped(&layout.name), ""),
        "name" => escaped(&layout.name),
        "description" => description.clone(),
        "facts" => facts(film, survey, tiles.len()),
        "absent" => absent.clone(),
        "frame_hint" => if survey.is_some() { FRAME_HINT } else { "" }.to_owned(),
        "map" => if survey.is_some() { MAP } else { "" }.to_owned(),
        "numbers" => escaped(results.text),
        "numbers_json" => in_script(results.json),
        "data" => in_script(&data),
        "figures" => figures.iter().map(figure_element).collect(),
        "script" => SCRIPTS.concat(),
        _ => unreachable!("{placeholder} is not a placeholder of the page"),
    })
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

fn figure_element(figure: &Drawing) -> String {
    format!(
        "<figure id=\"{0}\"><a href=\"{0}.svg\"><img alt=\"{1}\" src=\"{2}\"></a><figcaption>{1} Files beside this \
         page: <a href=\"{0}.svg\">SVG</a>, <a href=\"{0}.png\">PNG</a>, <a href=\"{0}.csv\">CSV of its \
         data</a>.</figcaption></figure>\n",
        figure.name,
        escaped(&figure.caption),
        data_url("image/svg+xml", figure.outlined.as_bytes()),
    )
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
