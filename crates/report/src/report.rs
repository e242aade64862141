//! All figures of a film, and the page.

use std::fmt;

use glam::DVec3;
use magsplice::layout::NamedTile;
use magsplice::{Film, FilmError};

use crate::figure::Figure;
use crate::figures::{AXES, along_axes, drawn_tiles, field_maps, layout_from_above, parameter_maps, vectors};
use crate::page::page;
use crate::survey::{Slice, Survey};
use crate::typeset;

/// Side of the maps of parameters on planes of equal z, and room of those on upright planes, in pixels.
const LEVEL_PX: [f64; 2] = [220.0, 220.0];
const UPRIGHT_PX: [f64; 2] = [340.0, 200.0];

/// Name of the page.
const PAGE_NAME: &str = "report.html";
/// Names of all figures, whether or not a layout has them.
const FIGURE_NAMES: [&str; 8] = [
    "layout",
    "vectors",
    "field-lowest",
    "field-middle",
    "field-highest",
    "parameters-level",
    "parameters-upright",
    "parameters-along-axes",
];

/// Results as the program prints them elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Numbers<'a> {
    /// For people.
    pub text: &'a str,
    /// For programs: a JSON object.
    pub json: &'a str,
}

/// Figures and page.
pub struct Report {
    /// The figures, in the order of the page.
    pub figures: Vec<Figure>,
    /// The page: one file that needs no other.
    pub html: String,
    /// What the report does not have, and why.
    pub absent: Vec<String>,
}

/// Why there is no report.
#[derive(Debug)]
pub enum ReportError {
    /// The film cannot be evaluated.
    Film(FilmError),
    /// A figure cannot be drawn.
    Drawing {
        /// Its name.
        figure: String,
        /// Why.
        message: String,
    },
}

impl Report {
    /// Draws everything the layout allows for.
    ///
    /// # Errors
    /// If the film cannot be evaluated, see [`FilmError`].
    pub fn of(film: &Film, numbers: Numbers) -> Result<Report, ReportError> {
        let survey = Survey::of(film).map_err(ReportError::Film)?;
        let layout = film.layout();
        let tiles = drawn_tiles(&layout.tiles, layout.volume.as_ref().map_or(DVec3::ZERO, |v| v.reference_mm));
        let figures = figures(film, &tiles, survey.as_ref())?;
        let absent = absent(film);
        let html = page(film, survey.as_ref(), &tiles, &figures, &absent, numbers);
        Ok(Report { figures, html, absent })
    }

    /// Names and contents of all files.
    pub fn files(&self) -> Vec<(String, &[u8])> {
        let mut files = vec![(PAGE_NAME.to_owned(), self.html.as_bytes())];
        for figure in &self.figures {
            files.push((format!("{}.svg", figure.name), figure.svg.as_bytes()));
            files.push((format!("{}.png", figure.name), &figure.png));
        }
        files
    }

    /// Whether some report has a file of this name.
    pub fn is_file_of_one(name: &str) -> bool {
        let figure = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png"));
        name == PAGE_NAME || figure.is_some_and(|figure| FIGURE_NAMES.contains(&figure))
    }
}

fn absent(film: &Film) -> Vec<String> {
    let mut absent = Vec::new();
    if film.volume().is_err() {
        absent.push(
            "no field and no decoupling: the layout has no [volume] table that says where the film is used".to_owned(),
        );
    }
    if film.ideal().is_err() {
        absent.push(
            "no comparison and no decoupling: the layout has no [ideal] table that says what the film stands in for"
                .to_owned(),
        );
    }
    absent
}

fn figures(film: &Film, tiles: &[&NamedTile], survey: Option<&Survey>) -> Result<Vec<Figure>, ReportError> {
    let options = typeset::options();
    let mut figures = Vec::new();
    let mut add = |name: &str, caption: String, drawn: Result<String, String>| {
        debug_assert!(FIGURE_NAMES.contains(&name), "{name}");
        let figure = drawn.and_then(|svg| Figure::new(name, caption, &svg, &options));
        figures.push(figure.map_err(|message| ReportError::Drawing { figure: name.to_owned(), message })?);
        Ok(())
    };
    let layout = film.layout();
    let volume = layout.volume.as_ref();
    let caption = "The tiles from above, their polarization and their names.".to_owned();
    add("layout", caption, layout_from_above::draw(tiles, layout.tiles.len(), volume))?;
    let Some(survey) = survey else { return Ok(figures) };

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
    for (place, (slice, z_mm)) in ["lowest", "middle", "highest"].into_iter().zip(&level) {
        let place = if level.len() == 2 && place == "middle" { "highest" } else { place };
        let what = if survey.against_ideal.is_some() {
            "the spliced film, of the ideal film (Eq. 2) on the same scale, and their difference"
        } else {
            "the film"
        };
        let caption = format!("B of {what}, at z = {z_mm} mm.");
        add(&format!("field-{place}"), caption, field_maps::draw(survey, slice, *z_mm))?;
    }
    let Some(against) = &survey.against_ideal else { return Ok(figures) };

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
    Ok(figures)
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReportError::Film(error) => error.fmt(f),
            ReportError::Drawing { figure, message } => write!(f, "the figure {figure} cannot be drawn: {message}"),
        }
    }
}

impl std::error::Error for ReportError {}
