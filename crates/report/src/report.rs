//! All figures of a film, and the page.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use magsplice::{Film, FilmError, Stage};
use rayon::prelude::*;

use crate::drafts::{Draft, FIGURE_NAMES, drafts};
use crate::figure::Figure;
use crate::figures::drawn_tiles;
use crate::page::page;
use crate::survey::Survey;
use crate::typeset;

/// Name of the page.
const PAGE_NAME: &str = "report.html";
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
    /// Draws everything the layout allows for. `field_t` is the field of the working volume as [`Film::volume_field_t`] gives it, if it is known already.
    ///
    /// # Errors
    /// If the film cannot be evaluated, see [`FilmError`].
    ///
    /// # Panics
    /// If `field_t` has not one value for each point of the working volume.
    pub fn of(film: &Film, field_t: Option<Vec<DVec3>>, numbers: Numbers) -> Result<Report, ReportError> {
        let survey = Survey::of(film, field_t).map_err(ReportError::Film)?;
        let layout = film.layout();
        let tiles = drawn_tiles(&layout.tiles, layout.volume.as_ref().map_or(DVec3::ZERO, |v| v.reference_mm));
        let options = typeset::options();
        let drafts = drafts(film, &tiles, survey.as_ref())?;
        let (rendered, all) = (AtomicUsize::new(0), drafts.len());
        let tell = |done: usize| film.tell(Stage { name: "rendering", done, of: Some(all), unit: "figures" });
        tell(0);
        let figures = drafts
            .into_par_iter()
            .map(|Draft { name, caption, svg }| {
                let figure = Figure::new(name, caption, &svg, &options);
                tell(rendered.fetch_add(1, Ordering::Relaxed) + 1);
                figure.map_err(|message| ReportError::Drawing { figure: name.to_owned(), message })
            })
            .collect::<Result<Vec<Figure>, ReportError>>()?;
        film.tell(Stage::uncounted("page"));
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

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReportError::Film(error) => error.fmt(f),
            ReportError::Drawing { figure, message } => write!(f, "the figure {figure} cannot be drawn: {message}"),
        }
    }
}

impl std::error::Error for ReportError {}

#[cfg(test)]
mod tests {
    use resvg::usvg::{Group, Node, Rect, Tree};

    use super::*;
    use magsplice::layout::Layout;

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

    /// Whether two texts cover each other by more than the empty space that boxes of letters have.
    fn meet(a: &Rect, b: &Rect) -> bool {
        let across = a.right().min(b.right()) - a.left().max(b.left());
        let along = a.bottom().min(b.bottom()) - a.top().max(b.top());
        across > 1.0 && along > 3.5
    }

    fn turned() -> String {
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
        "format = 1\nname = \"turned\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n[volume]\n\
         x_mm = [-2.0, 2.0]\ny_mm = [-1.0, 1.0]\nz_mm = [-5.0, -3.5]\nstep_mm = 0.25\n"
            .to_owned()
            + &tiles.iter().map(tile).collect::<String>()
    }

    /// No text of any figure is cut off by the sheet's end or covers another; every text has a letter of its font.
    #[test]
    fn texts_have_room() {
        let shipped = ["published-film", "film-40mm", "single-tile"].map(|name| {
            let path = format!("{}/../../layouts/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            std::fs::read_to_string(path).unwrap()
        });
        let options = typeset::options();
        let mut seen = 0;
        for text in shipped.into_iter().chain([turned()]) {
            let layout = Layout::parse(&text, "layout").unwrap();
            let film = Film::new(&layout);
            let survey = Survey::of(&film, None).unwrap();
            let tiles = drawn_tiles(&layout.tiles, DVec3::ZERO);
            for Draft { name, svg, .. } in drafts(&film, &tiles, survey.as_ref()).unwrap() {
                let tree = Tree::from_str(&svg, &options).unwrap();
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

    /// Below the published film B_x falls along x and B_y along y: red is positive, up is more y.
    #[test]
    fn maps_are_the_right_way_round() {
        let path = format!("{}/../../layouts/published-film.toml", env!("CARGO_MANIFEST_DIR"));
        let layout = Layout::read(path.as_ref()).unwrap();
        let film = Film::new(&layout);
        let survey = Survey::of(&film, None).unwrap();
        let drafts = drafts(&film, &[], survey.as_ref()).unwrap();
        let draft = drafts.iter().find(|draft| draft.name == "field-lowest").unwrap();
        let figure = Figure::new(draft.name, String::new(), &draft.svg, &typeset::options()).unwrap();
        let png = resvg::tiny_skia::Pixmap::decode_png(&figure.png).unwrap();
        // In pixels of the SVG, three of the PNG: the first column of maps, 220 wide and high, from (58, 52) on, 238 apart.
        let is_red = |x: u32, y: u32| {
            let pixel = png.pixel(3 * (58 + x), 3 * (52 + y)).unwrap();
            assert!(pixel.red().abs_diff(pixel.blue()) > 60, "{pixel:?}");
            pixel.red() > pixel.blue()
        };
        assert!(is_red(10, 110) && !is_red(210, 110));
        assert!(!is_red(110, 238 + 10) && is_red(110, 238 + 210));
    }

    #[test]
    fn tiles_carry_their_names() {
        let layout = Layout::parse(&turned(), "layout").unwrap();
        let film = Film::new(&layout);
        let tiles = drawn_tiles(&layout.tiles, DVec3::ZERO);
        let drafts = drafts(&film, &tiles, None).unwrap();
        assert_eq!(drafts.len(), 1);
        for name in ["north &lt;&amp;&gt; &apos;ß&apos;", "up", "none", "diagonal"] {
            assert!(drafts[0].svg.contains(&format!("\n{name}\n")), "{name}");
        }
    }
}
