//! The figures of a report, as SVG with letters as text.

use magsplice::layout::NamedTile;
use magsplice::{Film, Stage};

use crate::figures::{AXES, along_axes, field_maps, layout_from_above, parameter_maps, vectors};
use crate::report::ReportError;
use crate::survey::{Slice, Survey};
use crate::typeset;

/// Side of the maps of parameters on planes of equal z, and room of those on upright planes, in pixels.
const LEVEL_PX: [f64; 2] = [220.0, 220.0];
const UPRIGHT_PX: [f64; 2] = [340.0, 200.0];

const FIELD_NAMES: [&str; 3] = ["field-lowest", "field-middle", "field-highest"];

/// Names of all figures, whether or not a layout has them.
pub(crate) const FIGURE_NAMES: [&str; 8] = [
    "layout",
    "vectors",
    FIELD_NAMES[0],
    FIELD_NAMES[1],
    FIELD_NAMES[2],
    "parameters-level",
    "parameters-upright",
    "parameters-along-axes",
];

/// A figure before its letters become outlines.
pub(crate) struct Draft {
    pub(crate) name: &'static str,
    pub(crate) caption: String,
    pub(crate) svg: String,
}

/// How many figures there will be.
fn expected(survey: Option<&Survey>) -> usize {
    // Layout, vectors, one for each plane; three of the parameters.
    survey.map_or(1, |survey| 2 + survey.z_planes().len() + survey.against_ideal.as_ref().map_or(0, |_| 3))
}

/// Draws everything the layout allows for.
pub(crate) fn drafts(film: &Film, tiles: &[&NamedTile], survey: Option<&Survey>) -> Result<Vec<Draft>, ReportError> {
    let mut drafts = Vec::new();
    let expected = expected(survey);
    let say = |done: usize| film.tell(Stage { name: "drawing", done, of: Some(expected), unit: "figures" });
    say(0);
    let mut add = |name: &'static str, caption: String, drawn: Result<String, String>| {
        let svg = drawn.map_err(|message| ReportError::Drawing { figure: name.to_owned(), message })?;
        drafts.push(Draft { name, caption, svg });
        say(drafts.len());
        Ok(())
    };
    let layout = film.layout();
    let volume = layout.volume.as_ref();
    let caption = "The tiles from above, their polarization and their names.".to_owned();
    add("layout", caption, layout_from_above::draw(tiles, layout.tiles.len(), volume))?;
    let Some(survey) = survey else { return Ok(drafts) };

    let caption = "The field in three planes. Length and colour of an arrow follow the logarithm of the field's component in the plane; dashed: the \
                   working volume."
        .to_owned();
    add("vectors", caption, vectors::draw(film, tiles, survey.volume))?;

    let volume = survey.volume;
    let slice = |normal: usize, at_mm: f64| Slice::of(film, volume, normal, at_mm).map_err(ReportError::Film);
    let planes = survey.z_planes();
    let mut level = Vec::new();
    for &k in &planes {
        let z_mm = volume.grid.coordinate(2, k);
        level.push((slice(2, z_mm)?, z_mm));
    }
    let [first, .., last] = FIELD_NAMES;
    let names = if level.len() == 2 { vec![first, last] } else { FIELD_NAMES.to_vec() };
    for (name, (slice, z_mm)) in names.into_iter().zip(&level) {
        let what = if survey.against_ideal.is_some() {
            "the spliced film, of the ideal film (Eq. 2) on the same scale, and their difference"
        } else {
            "the film"
        };
        let caption = format!("B of {what}, at z = {z_mm} mm.");
        add(name, caption, field_maps::draw(survey, slice, *z_mm))?;
    }
    let Some(against) = &survey.against_ideal else { return Ok(drafts) };

    let titled =
        |(slice, z_mm): (Slice, f64)| (slice, format!("{} = {} mm", typeset::variable("z"), typeset::number(z_mm)));
    let level: Vec<(Slice, String)> = level.into_iter().map(titled).collect();
    let caption =
        "The decoupling parameters on planes of equal z: R_x should depend on x only, R_y on y, S_z on z.".to_owned();
    add("parameters-level", caption, parameter_maps::draw(against, &level, LEVEL_PX))?;

    let middle = 0.5 * (volume.lower_mm + volume.upper_mm);
    let mut upright = Vec::new();
    for normal in [1, 0] {
        let title = format!("{} = {} mm", typeset::variable(AXES[normal]), typeset::number(middle[normal]));
        upright.push((slice(normal, middle[normal])?, title));
    }
    let caption =
        "The decoupling parameters on the two upright planes through the middle of the working volume.".to_owned();
    add("parameters-upright", caption, parameter_maps::draw(against, &upright, UPRIGHT_PX))?;

    if let Some(drawn) = along_axes::draw(survey) {
        let caption = "Each decoupling parameter along its own axis against the straight line of the ideal film, and its spread over the two other axes, on \
                       which it should not depend."
            .to_owned();
        add("parameters-along-axes", caption, drawn)?;
    }
    Ok(drafts)
}
