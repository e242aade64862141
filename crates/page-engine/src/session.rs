//! A layout that is edited and evaluated.

use std::time::Duration;

use magsplice::Film;
use magsplice::layout::{Layout, PlainLayout};
use magsplice::magnet::overlaps;
use magsplice::prelude::{DVec3, Quantity, Tile};
use magsplice::results::{CheckedExpectation, FilmEvaluation};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What a page asks for.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// Reads a layout; it replaces the one before. The answer is the layout in the plain form.
    Open {
        /// Its text, TOML.
        text: String,
        /// Its name in messages.
        name: String,
    },
    /// Changes tiles. The answer is the pairs of tiles that then overlap.
    Edit {
        /// The changes.
        tiles: Vec<TileEdit>,
    },
    /// Evaluates the film over its working volume.
    Evaluate {
        /// Whether tiles keep their polarization, whatever their recoil permeability: faster, while
        /// a tile is dragged.
        rigid: bool,
    },
    /// B on a plane of constant z, of tiles that keep their polarization whatever their recoil
    /// permeability: a picture. Numbers are those of `Evaluate`.
    Map {
        /// Corners along x and y, in millimetres.
        lower_mm: [f64; 2],
        /// The opposite corner.
        upper_mm: [f64; 2],
        /// The height.
        z_mm: f64,
        /// Number of points along x and y, at least 2 and at most 1000 each.
        counts: [usize; 2],
    },
    /// The film as a layout file.
    Write,
}

/// The new numbers of a tile. What is not given stays.
#[derive(Debug, Deserialize)]
pub struct TileEdit {
    /// Index of the tile.
    pub tile: usize,
    /// Centre.
    pub position_mm: Option<DVec3>,
    /// Sides.
    pub size_mm: Option<DVec3>,
    /// Polarization in its own frame.
    pub polarization_t: Option<DVec3>,
}

/// Most points along an axis of a map: a screen has few more.
const MOST_POINTS: usize = 1000;

/// The layout of a page.
#[derive(Debug, Default)]
pub struct Session {
    layout: Option<Layout>,
}

/// A layout that was read.
#[derive(Serialize)]
struct Opened {
    layout: PlainLayout,
    findings: Vec<String>,
}

/// Two tiles that overlap.
#[derive(Serialize)]
struct OverlappingPair {
    tiles: [usize; 2],
    depth_mm: f64,
}

/// The numbers of a film.
#[derive(Serialize)]
struct Evaluated {
    evaluation: FilmEvaluation,
    /// Outcomes of `[expect]`; those of films as made need samples and are left out.
    expectations: Vec<CheckedExpectation>,
}

/// B on a plane.
#[derive(Serialize)]
struct Mapped {
    /// B in tesla, y fastest; null where it does not exist.
    b_t: Vec<[Option<f64>; 3]>,
}

impl Session {
    /// The answer to a request, both as JSON.
    pub fn answer(&mut self, request: &[u8]) -> String {
        let answered = serde_json::from_slice(request).map_err(|error| error.to_string());
        let answered = answered.and_then(|request| self.evaluated(request));
        match answered {
            Ok(value) => format!("{{\"ok\":{value}}}"),
            Err(error) => format!("{{\"error\":{}}}", Value::from(error)),
        }
    }

    fn evaluated(&mut self, request: Request) -> Result<String, String> {
        match request {
            Request::Open { text, name } => {
                let layout = Layout::parse(&text, &name).map_err(|error| error.to_string())?;
                let findings = layout.findings.iter().map(ToString::to_string).collect();
                let opened = Opened { layout: layout.plain(), findings };
                self.layout = Some(layout);
                json(&opened)
            }
            Request::Edit { tiles } => json(&self.edit(&tiles)?),
            Request::Evaluate { rigid } => json(&self.evaluate(rigid)?),
            Request::Map { lower_mm, upper_mm, z_mm, counts } => {
                if !counts.iter().all(|count| (2..=MOST_POINTS).contains(count)) {
                    return Err(format!("counts = {counts:?}, must be from 2 to {MOST_POINTS}"));
                }
                let at = |axis: usize, index: usize| {
                    let share = index as f64 / (counts[axis] - 1) as f64;
                    lower_mm[axis] + share * (upper_mm[axis] - lower_mm[axis])
                };
                let points: Vec<DVec3> = (0..counts[0])
                    .flat_map(|i| (0..counts[1]).map(move |j| (i, j)))
                    .map(|(i, j)| DVec3::new(at(0, i), at(1, j), z_mm))
                    .collect();
                let mut b_t = vec![DVec3::NAN; points.len()];
                // Points without a field keep NaN.
                let _ =
                    Film::rigid(self.layout()?.clone()).scene().field_into(Quantity::FluxDensity, &points, &mut b_t);
                let shown = |b: DVec3| b.to_array().map(|value| value.is_finite().then_some(value));
                json(&Mapped { b_t: b_t.into_iter().map(shown).collect() })
            }
            Request::Write => json(&self.layout()?.to_toml()),
        }
    }

    fn layout(&self) -> Result<&Layout, String> {
        self.layout.as_ref().ok_or_else(|| "no layout is open".to_owned())
    }

    /// Changes all of the tiles, or none if one cannot exist.
    fn edit(&mut self, edits: &[TileEdit]) -> Result<Vec<OverlappingPair>, String> {
        let layout = self.layout.as_mut().ok_or("no layout is open")?;
        let changed = |edit: &TileEdit| {
            let named = layout.tiles.get(edit.tile).ok_or_else(|| format!("there is no tile {}", edit.tile))?;
            let (tile, given) = (&named.tile, |new: Option<DVec3>, old| new.unwrap_or(old));
            let position = given(edit.position_mm, tile.position());
            let (size, j_t) = (given(edit.size_mm, tile.size()), given(edit.polarization_t, tile.polarization_t()));
            let changed = Tile::new(position, size, j_t).and_then(|new| new.rotated(tile.rotation()));
            changed.map(|changed| (edit.tile, changed)).map_err(|faults| format!("tile \"{}\": {faults}", named.name))
        };
        let changed = edits.iter().map(changed).collect::<Result<Vec<(usize, Tile)>, String>>()?;
        changed.into_iter().for_each(|(tile, changed)| layout.tiles[tile].tile = changed);
        let bare = layout.bare_tiles();
        let pairs = overlaps(&bare).filter(|pair| pair.depth > layout.overlap_mm);
        Ok(pairs.map(|pair| OverlappingPair { tiles: [pair.first, pair.second], depth_mm: pair.depth }).collect())
    }

    fn evaluate(&self, rigid: bool) -> Result<Evaluated, String> {
        let mut layout = self.layout()?.clone();
        layout.expectations.made = None;
        let film = if rigid { Ok(Film::rigid(layout)) } else { Film::new(layout) };
        let film = film.map_err(|error| error.to_string())?;
        let evaluation = film.evaluate().map_err(|error| error.to_string())?;
        let outcomes = film.outcomes(None).into_iter();
        let expectations = outcomes.map(|(expectation, outcome)| {
            let outcome = outcome.map_err(|error| error.to_string());
            CheckedExpectation::new(expectation, outcome, film.layout(), Duration::ZERO)
        });
        Ok(Evaluated { expectations: expectations.collect(), evaluation })
    }
}

fn json(value: &impl Serialize) -> Result<String, String> {
    serde_json::to_string(value).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(session: &mut Session, request: &Value) -> Value {
        serde_json::from_str(&session.answer(request.to_string().as_bytes())).expect("JSON")
    }

    fn opened(name: &str) -> Session {
        let text = std::fs::read_to_string(format!("../../layouts/{name}.toml")).expect("readable");
        let mut session = Session::default();
        let answer = ask(&mut session, &serde_json::json!({ "open": { "text": text, "name": name } }));
        assert_eq!(answer["ok"]["layout"]["tile"].as_array().expect("tiles").len(), 56);
        session
    }

    /// The numbers are those of the library, whatever the way through the buffer.
    #[test]
    fn evaluation_is_that_of_the_library() {
        let mut session = opened("published-film");
        let answer = ask(&mut session, &serde_json::json!({ "evaluate": { "rigid": false } }));
        let layout = Layout::read("../../layouts/published-film.toml").expect("a layout");
        let known = serde_json::to_value(Film::new(layout).expect("a film").evaluate().expect("numbers")).unwrap();
        assert_eq!(answer["ok"]["evaluation"]["displacement_rmse_mm"], known["displacement_rmse_mm"]);
        assert_eq!(answer["ok"]["evaluation"]["comparison"], known["comparison"]);
        let statuses: Vec<&Value> =
            answer["ok"]["expectations"].as_array().expect("a list").iter().map(|of| &of["status"]).collect();
        assert!(statuses.len() > 3, "{answer}");
    }

    /// An impossible tile changes nothing, and overlaps are reported.
    #[test]
    fn edits_are_made_together_or_not_at_all() {
        let mut session = opened("published-film");
        let before = ask(&mut session, &serde_json::json!("write"));
        let size = serde_json::json!([{ "tile": 0, "position_mm": [9, 9, 9] }, { "tile": 1, "size_mm": [1, 1, 0] }]);
        let refused = ask(&mut session, &serde_json::json!({ "edit": { "tiles": size } }));
        assert!(refused["error"].as_str().expect("a message").starts_with("tile \"film-x1-y4\""), "{refused}");
        assert_eq!(ask(&mut session, &serde_json::json!("write")), before);
        let moved = serde_json::json!([{ "tile": 0, "position_mm": [-9.575, -7.0, 0.5] }]);
        let moved = ask(&mut session, &serde_json::json!({ "edit": { "tiles": moved } }));
        assert_eq!(moved, serde_json::json!({ "ok": [] }));
        let onto = serde_json::json!([{ "tile": 0, "position_mm": [-9.575, -2.5, 0.5] }]);
        let onto = ask(&mut session, &serde_json::json!({ "edit": { "tiles": onto } }));
        assert_eq!(onto["ok"][0]["tiles"], serde_json::json!([0, 1]));
        let missing = ask(&mut session, &serde_json::json!({ "edit": { "tiles": [{ "tile": 99 }] } }));
        assert_eq!(missing, serde_json::json!({ "error": "there is no tile 99" }));
    }

    #[test]
    fn hostile_requests_are_errors() {
        let mut session = Session::default();
        let none = ask(&mut session, &serde_json::json!({ "evaluate": { "rigid": true } }));
        assert_eq!(none, serde_json::json!({ "error": "no layout is open" }));
        for request in ["", "{", "null", "\"run\"", "{\"map\":{}}", "\u{0}"] {
            let answer: Value = serde_json::from_str(&session.answer(request.as_bytes())).expect("JSON");
            assert!(answer["error"].is_string(), "{request}: {answer}");
        }
        let mut session = opened("published-film");
        let map = |counts: [usize; 2]| serde_json::json!({ "map": { "lower_mm": [-2, -2], "upper_mm": [2, 2], "z_mm": -3, "counts": counts } });
        assert_eq!(ask(&mut session, &map([2, 3]))["ok"]["b_t"].as_array().expect("values").len(), 6);
        assert!(ask(&mut session, &map([1 << 40, 2]))["error"].is_string());
    }
}
