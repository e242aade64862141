//! The page: figures, numbers, tiles in three dimensions and maps, in one HTML file that needs no other.

use std::fmt::Write;

use magsplice::Film;
use magsplice::layout::NamedTile;
use magsplice::prelude::DVec3;
use serde::Serialize;

use crate::colours::{Directions, Kind, Rgb, table};
use crate::figure::Figure;
use crate::figures::AXES;
use crate::image::data_url;
use crate::report::Numbers;
use crate::survey::Survey;

const PAGE: &str = include_str!("../page/page.html");
const MAP: &str = include_str!("../page/map.html");
const STYLE: &str = include_str!("../page/page.css");
const SCRIPTS: [&str; 2] = [include_str!("../page/map.js"), include_str!("../page/view.js")];

/// At most so many points of the grid are on the page: every second, third, ... of a finer one. Nine numbers each, they make 5 MB.
const MOST_POINTS: usize = 30_000;

/// What the page's scripts draw from.
#[derive(Serialize)]
struct Data<'a> {
    tiles: Vec<TileBox<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    volume: Option<VolumePoints>,
    maps: Vec<Map>,
    colours: Colours,
}

#[derive(Serialize)]
struct TileBox<'a> {
    name: &'a str,
    centre_mm: [f64; 3],
    size_mm: [f64; 3],
    /// The directions of its sides.
    axes: [[f64; 3]; 3],
    /// In the scene's frame.
    polarization_t: [f64; 3],
    colour: String,
}

#[derive(Serialize)]
struct VolumePoints {
    lower_mm: [f64; 3],
    upper_mm: [f64; 3],
    x_mm: Vec<f64>,
    y_mm: Vec<f64>,
    z_mm: Vec<f64>,
}

#[derive(Serialize)]
struct Map {
    group: &'static str,
    name: &'static str,
    unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    difference_of: Option<[&'static str; 2]>,
    /// z fastest, x slowest; null where there is no value. The script makes differences.
    values: Vec<Option<f64>>,
}

/// 256 colours each, six hexadecimal digits a colour.
#[derive(Serialize)]
struct Colours {
    signed: String,
    one_signed: String,
}

pub(crate) fn page(
    film: &Film,
    survey: Option<&Survey>,
    tiles: &[&NamedTile],
    figures: &[Figure],
    absent: &[String],
    numbers: Numbers,
) -> String {
    let layout = film.layout();
    let (volume, maps) = survey.map_or((None, Vec::new()), volume_points);
    let data = Data {
        tiles: tiles.iter().map(|named| tile_box(named)).collect(),
        volume,
        maps,
        colours: Colours { signed: hex(&table(Kind::Signed)), one_signed: hex(&table(Kind::OneSigned)) },
    };
    let data = serde_json::to_string(&data).expect("numbers and strings can always be written as JSON");
    let description = layout.description.as_ref().map_or(String::new(), |text| format!("<p>{}</p>\n", escaped(text)));
    let absent = absent.iter().fold(String::new(), |mut html, what| {
        let _ = writeln!(html, "<p class=\"absent\">Absent: {}.</p>", escaped(what));
        html
    });
    filled(PAGE, &|place| match place {
        "name" => escaped(&layout.name),
        "version" => env!("CARGO_PKG_VERSION").to_owned(),
        "description" => description.clone(),
        "facts" => facts(film, survey, tiles.len()),
        "absent" => absent.clone(),
        "map" => if survey.is_some() { MAP } else { "" }.to_owned(),
        "numbers" => escaped(numbers.text),
        "numbers_json" => in_script(numbers.json),
        "data" => in_script(&data),
        "figures" => figures.iter().map(figure).collect(),
        "style" => STYLE.to_owned(),
        "script" => SCRIPTS.concat(),
        _ => unreachable!("{place} is not a place of the page"),
    })
}

/// Puts text in the places `{{...}}` of a template; what is put in is not looked through again.
fn filled(template: &str, text: &dyn Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut page = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (place, rest) = part.split_once("}}").expect("every place of the template ends");
        page += &text(place);
        page += rest;
    }
    page
}

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
        let (v, every) = (survey.volume, strides(survey.volume.grid.counts()));
        let (l, u, s) = (v.lower_mm, v.upper_mm, v.step_mm);
        let ranges = format!("x {} .. {}, y {} .. {}, z {} .. {} mm", l.x, u.x, l.y, u.y, l.z, u.z);
        let step = if s.x == s.y && s.x == s.z { format!("{}", s.x) } else { format!("{}, {}, {}", s.x, s.y, s.z) };
        let along = AXES.iter().zip(every).filter(|(_, every)| *every > 1);
        let along: Vec<String> = along.map(|(axis, every)| format!("one point of {every} along {axis}")).collect();
        let thinned =
            if along.is_empty() { String::new() } else { format!("; the map on this page shows {}", along.join(", ")) };
        let text = format!("{ranges}, step {step} mm, {} points{thinned}", v.grid.len());
        facts.push(("Working volume", text));
    }
    facts.iter().fold(String::new(), |mut html, (term, text)| {
        let _ = writeln!(html, "<dt>{term}</dt><dd>{text}</dd>");
        html
    })
}

fn figure(figure: &Figure) -> String {
    format!(
        "<figure id=\"{}\"><img alt=\"{}\" src=\"{}\"><figcaption>{}</figcaption></figure>\n",
        figure.name,
        escaped(&figure.caption),
        data_url("image/svg+xml", figure.svg.as_bytes()),
        escaped(&figure.caption)
    )
}

fn tile_box(named: &NamedTile) -> TileBox<'_> {
    let tile = &named.tile;
    let polarization = tile.scene_polarization_t();
    TileBox {
        name: &named.name,
        centre_mm: tile.position().to_array(),
        size_mm: tile.size().to_array(),
        axes: [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| (tile.rotation() * axis).to_array()),
        polarization_t: polarization.to_array(),
        colour: format!("#{}", hex(&[Directions::new().colour(polarization)])),
    }
}

/// How many points of the grid apart those of the page are, along x, y, z.
fn strides(counts: [usize; 3]) -> [usize; 3] {
    let mut strides = [1; 3];
    let kept = |strides: [usize; 3], axis: usize| counts[axis].div_ceil(strides[axis]);
    while (0..3).map(|axis| kept(strides, axis)).product::<usize>() > MOST_POINTS {
        let densest = (0..3).max_by_key(|&axis| kept(strides, axis)).unwrap_or(0);
        strides[densest] += 1;
    }
    strides
}

fn volume_points(survey: &Survey) -> (Option<VolumePoints>, Vec<Map>) {
    let grid = &survey.volume.grid;
    let strides = strides(grid.counts());
    let along = |axis: usize| -> Vec<f64> {
        (0..grid.counts()[axis]).step_by(strides[axis]).map(|i| grid.coordinate(axis, i)).collect()
    };
    let volume = VolumePoints {
        lower_mm: survey.volume.lower_mm.to_array(),
        upper_mm: survey.volume.upper_mm.to_array(),
        x_mm: along(0),
        y_mm: along(1),
        z_mm: along(2),
    };
    let shown: Vec<usize> = (0..grid.len())
        .filter(|&index| grid.indices(index).iter().zip(strides).all(|(i, stride)| i.is_multiple_of(stride)))
        .collect();
    let component = |field: &[DVec3], of: fn(DVec3) -> f64| shown.iter().map(|&i| Some(of(field[i]))).collect();
    let components: [fn(DVec3) -> f64; 4] = [|b| b.x, |b| b.y, |b| b.z, DVec3::length];
    let mut maps = Vec::new();
    for (name, of) in ["B_x", "B_y", "B_z", "|B|"].into_iter().zip(components) {
        let values = component(&survey.field_t, of);
        maps.push(Map { group: "this film", name, unit: "T", difference_of: None, values });
    }
    let Some(against) = &survey.against_ideal else { return (Some(volume), maps) };
    let ideal = ["ideal B_x", "ideal B_y", "ideal B_z"];
    for (name, of) in ideal.into_iter().zip(components) {
        let values = component(&against.field_t, of);
        maps.push(Map { group: "ideal film", name, unit: "T", difference_of: None, values });
    }
    let differences = ["B_x \u{2212} ideal", "B_y \u{2212} ideal", "B_z \u{2212} ideal"];
    for ((name, of), ideal) in differences.into_iter().zip(["B_x", "B_y", "B_z"]).zip(ideal) {
        let values = Vec::new();
        maps.push(Map { group: "difference", name, unit: "T", difference_of: Some([of, ideal]), values });
    }
    let parameters: Vec<_> = against.decoupling.parameters.iter().collect();
    for (name, unit, of) in PARAMETERS {
        let values = shown.iter().map(|&i| parameters[i].as_ref().map(of)).collect();
        maps.push(Map { group: "decoupling", name, unit, difference_of: None, values });
    }
    (Some(volume), maps)
}

type OfParameters = fn(&magsplice::decouple::Parameters) -> f64;

const PARAMETERS: [(&str, &str, OfParameters); 3] =
    [("R_x", "rad", |p| p.r_x), ("R_y", "rad", |p| p.r_y), ("S_z", "ln of T", |p| p.s_z)];

fn hex(colours: &[Rgb]) -> String {
    colours.iter().flatten().fold(String::new(), |mut text, c| {
        let _ = write!(text, "{c:02x}");
        text
    })
}

/// Text of a page.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// JSON that cannot end the element it is in.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_in_is_not_a_place() {
        let text = filled("a {{x}} b {{y}}", &|place| if place == "x" { "{{y}}".to_owned() } else { "1".to_owned() });
        assert_eq!(text, "a {{y}} b 1");
        assert_eq!(in_script("\"</script>\""), "\"\\u003c/script>\"");
    }

    #[test]
    fn a_fine_grid_is_thinned_evenly() {
        assert_eq!(strides([9, 9, 5]), [1, 1, 1]);
        let strides = strides([400, 400, 3]);
        assert_eq!(strides[2], 1);
        assert!(400_usize.div_ceil(strides[0]) * 400_usize.div_ceil(strides[1]) * 3 <= MOST_POINTS);
    }
}
