//! The figures of a report in order, as SVG whose text is still text.

use magsplice::layout::NamedTile;
use magsplice::results::EXPERIMENT_STEP_MM;
use magsplice::{Film, FilmRecoil, Stage};

use crate::drawing::FigureDraft;
use crate::error::ReportError;
use crate::figures::distributions::ErrorKind;
use crate::figures::parameter_maps::MappedPlanes;
use crate::figures::{
    along_axes, distributions, experiment, field_maps, layout_from_above, parameter_maps, recoil_map, resolution,
    vectors,
};
use crate::film_results::{FilmResults, FilmSamples};
use crate::shared_ranges::SharedRanges;
use crate::survey::{FieldSlice, Survey};

const FIELD_NAMES: [&str; 3] = ["field-lowest", "field-middle", "field-highest"];

/// The number of figures.
fn figure_count(film: &Film, survey: Option<&Survey>, samples: Option<&FilmSamples>) -> usize {
    // Layout, recoil, vectors, one field map per plane; three figures of the parameters.
    // Two figures of samples.
    let of_tiles = 1 + usize::from(film.recoil().is_some());
    of_tiles
        + survey.map_or(0, |survey| {
            let against_ideal = survey.against_ideal.as_ref().map_or(0, |_| 3);
            1 + survey.heights_mm().len() + against_ideal + samples.map_or(0, |_| 2)
        })
}

/// All figures that the layout allows.
pub(crate) fn drafts(of: &FilmResults, ranges: &SharedRanges) -> Result<Vec<FigureDraft>, ReportError> {
    let mut all = film_drafts(of.film, &of.tiles, of.survey.as_ref(), of.input.samples.as_ref(), ranges)?;
    if let Some(survey) = &of.survey {
        all.extend(sensor_drafts(of.film, survey, ranges)?);
    }
    Ok(all)
}

/// The figures of the tiles, the field and the decoupling parameters.
fn film_drafts(
    film: &Film,
    tiles: &[&NamedTile],
    survey: Option<&Survey>,
    samples: Option<&FilmSamples>,
    ranges: &SharedRanges,
) -> Result<Vec<FigureDraft>, ReportError> {
    let mut drafts = Vec::new();
    let count = figure_count(film, survey, samples);
    let tell = |done: usize| film.tell(Stage { name: "drawing", done, of: Some(count), unit: "figures" });
    tell(0);
    let mut add = |draft: FigureDraft| {
        drafts.push(draft);
        tell(drafts.len());
    };
    add(layout_from_above::draft(film.layout(), tiles, ranges)?);
    // A layout of more tiles than are drawn has too many cells for recoil.
    if let Some(changes) = film.recoil().map(FilmRecoil::tile_changes).filter(|changes| changes.len() == tiles.len()) {
        add(recoil_map::draft(tiles, &changes)?);
    }
    let Some(survey) = survey else { return Ok(drafts) };
    let volume = survey.volume;
    add(vectors::draft(film, tiles, volume, ranges)?);

    let slice = |normal: usize, at_mm: f64| FieldSlice::new(film, volume, normal, at_mm);
    let level: Vec<FieldSlice> =
        survey.heights_mm().into_iter().map(|z_mm| slice(2, z_mm)).collect::<Result<_, _>>()?;
    let [first, .., last] = FIELD_NAMES;
    let names = if level.len() == 2 { vec![first, last] } else { FIELD_NAMES.to_vec() };
    for (name, slice) in names.into_iter().zip(&level) {
        add(field_maps::draft(survey, slice, name, ranges)?);
    }
    let Some(against) = &survey.against_ideal else { return Ok(drafts) };

    add(parameter_maps::draft(against, &level, MappedPlanes::Level, ranges)?);
    let middle = 0.5 * (volume.lower_mm + volume.upper_mm);
    let upright = [slice(1, middle.y)?, slice(0, middle.x)?];
    add(parameter_maps::draft(against, &upright, MappedPlanes::Upright, ranges)?);
    add(along_axes::draft(survey, against, ranges)?);
    if let Some(samples) = samples.filter(|samples| !samples.errors.is_empty()) {
        add(distributions::draft(ErrorKind::Displacement, samples, ranges)?);
        add(distributions::draft(ErrorKind::Uniformity, samples, ranges)?);
    }
    Ok(drafts)
}

/// The figures of the sensor: none if the layout states neither a sensor nor an elastic layer.
fn sensor_drafts(film: &Film, survey: &Survey, ranges: &SharedRanges) -> Result<Vec<FigureDraft>, ReportError> {
    let layout = film.layout();
    if layout.sensor.is_none() && layout.elastomer.is_none() {
        return Ok(Vec::new());
    }
    film.tell(Stage::uncounted("drawing the sensor"));
    let resolution = resolution::draft(film, survey.volume, &survey.heights_mm(), ranges)?;
    let experiment = experiment::draft(&film.experiments(EXPERIMENT_STEP_MM, None, None)?, ranges)?;
    Ok(resolution.into_iter().chain([experiment]).collect())
}

#[cfg(test)]
mod tests {
    use magsplice::layout::Layout;
    use resvg::usvg::{Group, Node, Paint, Rect, Tree};

    use super::*;
    use crate::drawing::SvgText;
    use crate::survey::tiles_to_draw;
    use crate::typeset::OPTIONS;

    /// Appends each text of the group with its bounding box.
    fn texts(group: &Group, found: &mut Vec<(String, Rect)>) {
        for node in group.children() {
            match node {
                Node::Group(group) => texts(group, found),
                Node::Text(text) => {
                    let letters = text.chunks().iter().map(|chunk| chunk.text().trim()).collect::<String>();
                    found.push((letters, text.abs_bounding_box()));
                }
                _ => {}
            }
        }
    }

    /// Whether two texts overlap by more than the empty margin inside a bounding box of text.
    fn meet(a: &Rect, b: &Rect) -> bool {
        let across = a.right().min(b.right()) - a.left().max(b.left());
        let along = a.bottom().min(b.bottom()) - a.top().max(b.top());
        across > 1.0 && along > 3.5
    }

    /// A layout with a rotated tile, an upright and a tilted polarization, and a tile without any.
    fn rotated_tiles() -> String {
        let tiles = [
            ("north <&> 'ß'", [0.0, 0.0, 0.5], [6.0, 2.0, 1.0], [0.1, 0.0, 0.05], 30.0),
            ("up", [-5.0, 4.0, 0.5], [3.0, 3.0, 1.0], [0.0, 0.0, 0.12], 0.0),
            ("none", [-5.0, -4.0, 0.5], [2.0, 3.0, 1.0], [0.0, 0.0, 0.0], 0.0),
            ("diagonal", [5.0, -4.0, 0.5], [3.0, 3.0, 1.0], [0.08, 0.08, -0.05], 45.0),
        ];
        let tile = |(name, position, size, polarization, angle): &(&str, [f64; 3], [f64; 3], [f64; 3], f64)| {
            format!(
                "[[tile]]\nname = \"{name}\"\nposition_mm = {position:?}\nsize_mm = {size:?}\npolarization_t = {polarization:?}\n\
                 rotation = {{ axis = [0.0, 0.0, 1.0], angle_deg = {angle:?} }}\n"
            )
        };
        "format = 1\nname = \"rotated tiles\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n[volume]\n\
         x_mm = [-2.0, 2.0]\ny_mm = [-1.0, 1.0]\nz_mm = [-5.0, -3.5]\nstep_mm = 0.25\n"
            .to_owned()
            + &tiles.iter().map(tile).collect::<String>()
    }

    #[test]
    fn no_text_leaves_its_sheet_or_covers_another() {
        let shipped = ["published-film", "film-40mm", "single-tile"].map(|name| {
            let path = format!("{}/../../layouts/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            std::fs::read_to_string(path).unwrap()
        });
        let mut seen = 0;
        for text in shipped.into_iter().chain([rotated_tiles()]) {
            let layout = Layout::parse(&text, "layout").unwrap();
            let film = Film::new(layout.clone()).unwrap();
            let survey = Survey::new(&film).unwrap();
            let tiles = tiles_to_draw(&layout);
            for FigureDraft { name, svg, .. } in
                film_drafts(&film, &tiles, survey.as_ref(), None, &SharedRanges::default()).unwrap()
            {
                let tree = Tree::from_str(&svg, &OPTIONS).unwrap();
                let mut found = Vec::new();
                texts(tree.root(), &mut found);
                let sheet = tree.size();
                for (i, (text, bounds)) in found.iter().enumerate() {
                    let inside = bounds.left() >= 0.0
                        && bounds.top() >= 0.0
                        && bounds.right() <= sheet.width()
                        && bounds.bottom() <= sheet.height();
                    assert!(inside, "{}, {name}: {text:?} at {bounds:?} leaves the sheet", layout.name);
                    for (other, others) in &found[..i] {
                        let apart = !meet(bounds, others);
                        assert!(
                            apart,
                            "{}, {name}: {text:?} at {bounds:?} covers {other:?} at {others:?}",
                            layout.name
                        );
                    }
                }
                seen += found.len();
            }
        }
        assert!(seen > 500, "{seen} texts");
    }

    /// Appends the bounding box of each arrow, mark and bracket of the group: small shapes in ink.
    fn marks(group: &Group, found: &mut Vec<Rect>) {
        const MOST_PX: f32 = 90.0;
        let ink = |paint: &Paint| matches!(paint, Paint::Color(c) if [c.red, c.green, c.blue] == [30, 30, 30]);
        for node in group.children() {
            match node {
                Node::Group(group) => marks(group, found),
                Node::Path(path) => {
                    let filled = path.fill().is_some_and(|fill| ink(fill.paint()));
                    let drawn = path.stroke().is_some_and(|stroke| ink(stroke.paint()));
                    let bounds = path.abs_bounding_box();
                    if (filled || drawn) && bounds.width().max(bounds.height()) < MOST_PX {
                        found.push(bounds);
                    }
                }
                _ => {}
            }
        }
    }

    #[test]
    fn no_name_of_a_tile_crosses_an_arrow_or_a_bracket() {
        let shipped = ["published-film", "designed-displacement", "designed-tilted", "designed-three-parts"];
        let shipped = shipped.map(|name| {
            let path = format!("{}/../../layouts/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            std::fs::read_to_string(path).unwrap()
        });
        for text in shipped.into_iter().chain([rotated_tiles()]) {
            let layout = Layout::parse(&text, "layout").unwrap();
            let tiles: Vec<&NamedTile> = layout.tiles.iter().collect();
            let draft = layout_from_above::draft(&layout, &tiles, &SharedRanges::default()).unwrap();
            let tree = Tree::from_str(&draft.svg, &OPTIONS).unwrap();
            let (mut names, mut shapes) = (Vec::new(), Vec::new());
            texts(tree.root(), &mut names);
            marks(tree.root(), &mut shapes);
            assert!(names.len() > tiles.len() && shapes.len() > tiles.len() + 4, "{}", layout.name);
            for (name, bounds) in &names {
                let crossed = shapes.iter().find(|shape| {
                    let across = bounds.right().min(shape.right()) - bounds.left().max(shape.left());
                    let along = bounds.bottom().min(shape.bottom()) - bounds.top().max(shape.top());
                    across.min(along) > 2.0
                });
                assert!(crossed.is_none(), "{}: {name} at {bounds:?} crosses {crossed:?}", layout.name);
            }
        }
    }

    /// Below the published film B_x falls along x and B_y along y.
    #[test]
    fn positive_values_are_red_and_y_points_up_in_field_maps() {
        let path = format!("{}/../../layouts/published-film.toml", env!("CARGO_MANIFEST_DIR"));
        let layout = Layout::read(&path).unwrap();
        let film = Film::new(layout.clone()).unwrap();
        let survey = Survey::new(&film).unwrap();
        let drafts = film_drafts(&film, &[], survey.as_ref(), None, &SharedRanges::default()).unwrap();
        let draft = drafts.into_iter().find(|draft| draft.name == "field-lowest").unwrap();
        let figure = draft.rendered(SvgText::Text).unwrap();
        let png = resvg::tiny_skia::Pixmap::decode_png(&figure.png).unwrap();
        // The first column of maps starts at (64, 52) in pixels of the SVG, of which the PNG has
        // 3.125 each. A map is 220 wide and high; the next one is 246 below.
        let is_red = |x: u32, y: u32| {
            let pixel = png.pixel((64 + x) * 25 / 8, (52 + y) * 25 / 8).unwrap();
            assert!(pixel.red().abs_diff(pixel.blue()) > 60, "{pixel:?}");
            pixel.red() > pixel.blue()
        };
        assert!(is_red(10, 110) && !is_red(210, 110));
        assert!(!is_red(110, 246 + 10) && is_red(110, 246 + 210));
    }

    #[test]
    fn figure_of_the_layout_shows_the_names_of_tiles_as_written() {
        let layout = Layout::parse(&rotated_tiles(), "layout").unwrap();
        let film = Film::new(layout.clone()).unwrap();
        let tiles = tiles_to_draw(&layout);
        let drafts = film_drafts(&film, &tiles, None, None, &SharedRanges::default()).unwrap();
        assert_eq!(drafts.len(), 1);
        for name in ["north &lt;&amp;&gt; &apos;ß&apos;", "up", "none", "diagonal"] {
            assert!(drafts[0].svg.contains(&format!("\n{name}\n")), "{name}");
        }
    }
}
