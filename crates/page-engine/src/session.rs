//! A layout that is edited and evaluated.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use magsplice::Film;
use magsplice::decouple::Figures;
use magsplice::design::{DesignProblem, ProgressUpdate, SearchStage};
use magsplice::layout::{Brief, Goal, Layout, TileForm, Under, edited_text};
use magsplice::magnet::overlaps;
use magsplice::prelude::{DVec3, Tile};
use magsplice::tolerance::{Statistics, statistics};
use serde::Serialize;
use serde_json::Value;

use crate::evaluated::{Evaluated, Mapped};
use crate::keep::text_with_tiles;
use crate::readable_files::ReadableFiles;
use crate::request::{Request, TileEdit};
use crate::state::State;

/// Observes long requests. It receives JSON, and stops the work with [`ControlFlow::Break`].
pub type Observer<'o> = &'o mut (dyn FnMut(&str) -> ControlFlow<()> + Send);

/// The layout of a page.
#[derive(Debug, Default)]
pub struct Session {
    open: Option<OpenLayout>,
    files: ReadableFiles,
}

#[derive(Debug)]
struct OpenLayout {
    name: String,
    text: String,
    files: ReadableFiles,
    /// The layout of the text, with the tiles of later edits.
    layout: Layout,
    /// The film of the layout, if it was evaluated, and whether it is rigid.
    film: Option<(bool, Film)>,
    /// The samples of films as made so far, and their seed.
    made: Option<(u64, Vec<Figures>)>,
}

/// Two tiles that overlap.
#[derive(Serialize)]
struct OverlappingPair {
    tiles: [usize; 2],
    depth_mm: f64,
}

/// Samples of films as made.
#[derive(Serialize)]
struct Made {
    samples: usize,
    /// Statistics of the figures.
    #[serde(flatten)]
    figures: Figures<Statistics>,
    /// Statistics of the displacement RMSE along all axes together, in millimetres.
    displacement_mm: Statistics,
    /// The displacement RMSE along all axes together of each sample, in millimetres.
    displacements_mm: Vec<f64>,
}

/// A film that a search found.
#[derive(Serialize)]
struct Improved {
    state: State,
    /// The error of the goal before and after.
    before: Option<f64>,
    after: Option<f64>,
    /// Whether the search ended by itself.
    is_finished: bool,
}

impl Session {
    /// A session where there are no files: its layouts may refer to baselines.
    pub fn of_module() -> Session {
        Session { open: None, files: ReadableFiles::any() }
    }

    /// Lets later requests read these files beside the layout. A new session reads none.
    pub fn allow(&mut self, files: ReadableFiles) {
        if let Some(open) = &mut self.open {
            open.files = files.clone();
        }
        self.files = files;
    }

    /// The answer to a request, both as JSON.
    pub fn answer(&mut self, request: &[u8]) -> String {
        self.answer_reporting(request, &mut |_| ControlFlow::Continue(()))
    }

    /// The answer to a request, whose work is observed.
    pub fn answer_reporting(&mut self, request: &[u8], observer: Observer) -> String {
        let answered = serde_json::from_slice(request).map_err(|error| error.to_string());
        let answered = answered.and_then(|request| self.evaluated(request, observer));
        match answered {
            Ok(value) => format!("{{\"ok\":{value}}}"),
            Err(error) => format!("{{\"error\":{}}}", Value::from(error)),
        }
    }

    fn evaluated(&mut self, request: Request, observer: Observer) -> Result<String, String> {
        if let Request::Open { text, name } = request {
            let files = self.files.clone();
            let layout = files.layout(&text, &name)?;
            let open = self.open.insert(OpenLayout { name, text, files, layout, film: None, made: None });
            return json(&open.state());
        }
        let open = self.open.as_mut().ok_or("no layout is open")?;
        match request {
            Request::Open { .. } => unreachable!("answered above"),
            Request::Set { edits } => {
                let text = edited_text(&open.text, &edits).map_err(|error| error.to_string())?;
                open.replace(text)?;
                json(&open.state())
            }
            Request::Edit { tiles } => json(&open.edit(&tiles)?),
            Request::Keep => {
                let read = |text: &str| open.files.layout(text, &open.name);
                let text = text_with_tiles(&open.layout, &open.text, open.files.folder(), read)?;
                open.replace(text)?;
                json(&open.state())
            }
            Request::Evaluate { rigid } => json(&Evaluated::of(open.film(rigid)?).map_err(|error| error.to_string())?),
            Request::Map { quantity, axis, z_mm, counts, rigid } => {
                json(&Mapped::of(open.film(rigid)?, quantity, axis, z_mm, counts)?)
            }
            Request::Budget { samples } => {
                json(&open.film(false)?.budget(1, samples.max(1)).map_err(|error| error.to_string())?)
            }
            Request::Made { add, seed } => json(&open.made(add, seed)?),
            Request::Improve { steps } => json(&open.improve(steps, observer)?),
        }
    }
}

impl OpenLayout {
    fn state(&self) -> State {
        State::of(&self.layout, &self.text)
    }

    fn replace(&mut self, text: String) -> Result<(), String> {
        let layout = self.files.layout(&text, &self.name)?;
        (self.text, self.layout, self.film, self.made) = (text, layout, None, None);
        Ok(())
    }

    /// The prepared film.
    fn film(&mut self, rigid: bool) -> Result<&Film, String> {
        let rigid = rigid || !self.layout.has_recoil();
        if self.film.as_ref().is_none_or(|(known, _)| *known != rigid) {
            let mut layout = self.layout.clone();
            layout.expectations.made = None;
            let film =
                if rigid { Film::rigid(layout) } else { Film::new(layout).map_err(|error| error.to_string())? };
            self.film = Some((rigid, film));
        }
        self.film.as_ref().map(|(_, film)| film).ok_or_else(|| "no film".to_owned())
    }

    /// Changes all of the tiles, or none if one cannot exist.
    fn edit(&mut self, edits: &[TileEdit]) -> Result<Vec<OverlappingPair>, String> {
        let layout = &mut self.layout;
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
        (self.film, self.made) = (None, None);
        let bare = self.layout.bare_tiles();
        let pairs = overlaps(&bare).filter(|pair| pair.depth > self.layout.overlap_mm);
        Ok(pairs.map(|pair| OverlappingPair { tiles: [pair.first, pair.second], depth_mm: pair.depth }).collect())
    }

    fn made(&mut self, add: u64, seed: u64) -> Result<Made, String> {
        let known = self.made.take().filter(|(known, _)| *known == seed);
        let mut samples = known.map(|(_, samples)| samples).unwrap_or_default();
        let film = Film::new(self.layout.clone()).map_err(|error| error.to_string())?;
        let sampling = film.sampling().map_err(|error| error.to_string())?;
        let first = samples.len() as u64;
        let sampler = sampling.sampler(seed).map_err(|error| error.to_string())?;
        let added = sampler.errors_of_range(first..first + add.max(1), || {});
        samples.extend(added.map_err(|(sample, error)| format!("sample {sample}: {error}"))?);
        let displacements_mm: Vec<f64> =
            samples.iter().map(|of| DVec3::from(of.displacement_rmse_mm).length()).collect();
        let none = || "a sample has no errors of the displacement".to_owned();
        let made = Made {
            samples: samples.len(),
            figures: statistics(&samples).ok_or_else(none)?,
            displacement_mm: Statistics::new(displacements_mm.iter().copied()).ok_or_else(none)?,
            displacements_mm,
        };
        self.made = Some((seed, samples));
        Ok(made)
    }

    fn improve(&mut self, steps: usize, observer: Observer) -> Result<Improved, String> {
        let mut layout = self.layout.clone();
        // From this film alone: several starts would end at another step on each machine.
        if let Some(brief) = &mut layout.brief {
            brief.starts = 1;
        }
        let problem = DesignProblem::new(&layout).map_err(|error| error.to_string())?;
        let (seen, errors, observer) = (AtomicUsize::new(0), Mutex::new(Vec::new()), Mutex::new(observer));
        let stopped = |update: ProgressUpdate| {
            if let (Some(best), SearchStage::Starts) = (update.best, update.stage) {
                errors.lock().expect("no panic holds it").push(best);
                let told = format!("{{\"best\":{best}}}");
                if (observer.lock().expect("no panic holds it"))(&told).is_break() {
                    return ControlFlow::Break(());
                }
            }
            match seen.fetch_add(1, Ordering::Relaxed) >= steps {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let found = problem.search(&stopped).map_err(|error| error.to_string())?;
        let is_finished = !found.interrupted;
        let errors = errors.into_inner().expect("no panic holds it");
        let [before, after] = [&found.before, &found.after].map(|of| goal_error(&of.figures, layout.brief.as_ref()?));
        // The tiles and the spacing alone: bounds, texts and the history stay the user's.
        let Layout { tiles, .. } = problem.designed_layout(&found, &self.name);
        let spaced = found.spacing_mm.and_then(|spacing_mm| self.layout.with_head_spacing(spacing_mm));
        let improved = Layout { tiles, ..spaced.unwrap_or_else(|| self.layout.clone()) };
        let is_same = improved.tiles == self.layout.tiles;
        if !is_same || improved.head_spacing_mm() != self.layout.head_spacing_mm() {
            let text = improved.to_edited_toml(TileForm::Compact, self.files.folder(), &self.name);
            self.replace(text.map_err(|error| error.to_string())?)?;
        }
        Ok(Improved {
            state: self.state(),
            before: before.or(errors.first().copied()),
            after: after.or(errors.last().copied()),
            is_finished,
        })
    }
}

/// The root of the weighted sum of squares of the errors that a brief counts, of the film as drawn.
/// `None` for other goals.
fn goal_error(figures: &Figures, brief: &Brief) -> Option<f64> {
    let errors = match (brief.under, brief.goal) {
        (Under::Nominal, Goal::Displacement) => figures.displacement_rmse_mm.to_array(),
        (Under::Nominal, Goal::Uniformity) => figures.uniformity_rmse.map(|rmse| rmse.unwrap_or(0.0)).to_array(),
        _ => return None,
    };
    Some(errors.iter().zip(brief.weights).map(|(error, weight)| weight * error * error).sum::<f64>().sqrt())
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
        let mut session = Session::of_module();
        let answer = ask(&mut session, &serde_json::json!({ "open": { "text": text, "name": name } }));
        assert_eq!(answer["ok"]["tiles"].as_array().expect("tiles").len(), 56);
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
        let before = ask(&mut session, &serde_json::json!("keep"));
        let size = serde_json::json!([{ "tile": 0, "position_mm": [9, 9, 9] }, { "tile": 1, "size_mm": [1, 1, 0] }]);
        let refused = ask(&mut session, &serde_json::json!({ "edit": { "tiles": size } }));
        assert!(refused["error"].as_str().expect("a message").starts_with("tile \"film-x1-y4\""), "{refused}");
        assert_eq!(ask(&mut session, &serde_json::json!("keep")), before);
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
        let map = |counts: [usize; 2]| serde_json::json!({ "map": { "quantity": "flux_density", "axis": 2, "z_mm": -3, "counts": counts, "rigid": true } });
        assert_eq!(ask(&mut session, &map([2, 3]))["ok"]["values"].as_array().expect("values").len(), 6);
        assert!(ask(&mut session, &map([1 << 40, 2]))["error"].is_string());
    }

    const COMPACT: &str = r#"format = 1
name = "two pairs" # of squares
[ideal]
wavelength_mm = 10.0
thickness_mm = 1.0
amplitude_t = 0.12
[volume]
x_mm = [-1.0, 1.0]
y_mm = [-1.0, 1.0]
z_mm = [-4.0, -3.0] # below
step_mm = 0.5
[kind.square]
size_mm = [3.3, 3.3, 1.0]
strength_t = 0.12
[[tile]]
name = "a" # the first
kind = "square"
position_mm = [2.5, 2.5, 0.5] # by hand
direction_deg = 45.0
mirror = { axes = ["x", "y"] }
"#;

    fn state_after(session: &mut Session, request: &Value) -> Value {
        let answer = ask(session, request);
        assert!(answer["ok"]["text"].is_string(), "{answer}");
        answer["ok"].clone()
    }

    /// An entry changes in place with its images, beside its comments.
    #[test]
    fn kept_tiles_change_their_own_entries() {
        let mut session = Session::default();
        let state = state_after(&mut session, &serde_json::json!({ "open": { "text": COMPACT, "name": "pairs" } }));
        let j = 0.12 * 0.5_f64.sqrt();
        let moves: Vec<Value> = (0..4)
            .map(|tile| {
                let at = &state["tiles"][tile]["position_mm"];
                let [x, y] = [0, 1].map(|axis| at[axis].as_f64().expect("a number"));
                let j_t = [x.signum() * 0.12 * 0.6, y.signum() * 0.12 * 0.8, 0.0];
                assert!((state["tiles"][tile]["polarization_t"][0].as_f64().unwrap().abs() - j).abs() < 1e-12);
                serde_json::json!({ "tile": tile, "position_mm": [1.1 * x, y, 0.5], "polarization_t": j_t })
            })
            .collect();
        assert_eq!(
            ask(&mut session, &serde_json::json!({ "edit": { "tiles": moves } })),
            serde_json::json!({ "ok": [] })
        );
        let kept = state_after(&mut session, &serde_json::json!("keep"));
        let expected = COMPACT.replace("[2.5, 2.5, 0.5]", "[2.75, 2.5, 0.5]").replace("45.0", "53.1301023542");
        assert_eq!(kept["text"], expected);
        // Without its images no entry gives the tile: all tiles are written.
        let one = serde_json::json!({ "edit": { "tiles": [{ "tile": 0, "position_mm": [3.0, 2.5, 0.5] }] } });
        assert_eq!(ask(&mut session, &one), serde_json::json!({ "ok": [] }));
        let kept = state_after(&mut session, &serde_json::json!("keep"));
        let text = kept["text"].as_str().expect("a text");
        assert_eq!(text.matches("[[tile]]").count(), 4);
        assert!(text.contains("z_mm = [-4.0, -3.0] # below\n"), "{text}");
    }

    /// Overlaps last while a tile is dragged, and are never kept.
    #[test]
    fn overlapping_tiles_are_not_kept() {
        let mut session = Session::default();
        state_after(&mut session, &serde_json::json!({ "open": { "text": COMPACT, "name": "pairs" } }));
        let onto = serde_json::json!({ "edit": { "tiles": [{ "tile": 0, "position_mm": [0.0, 2.5, 0.5] }] } });
        assert!(ask(&mut session, &onto)["ok"][0]["depth_mm"].as_f64().expect("a depth") > 0.7);
        assert!(
            ask(&mut session, &serde_json::json!("keep"))["error"].as_str().expect("a message").contains("overlap")
        );
    }

    #[test]
    fn set_values_break_no_rule() {
        let mut session = Session::default();
        state_after(&mut session, &serde_json::json!({ "open": { "text": COMPACT, "name": "pairs" } }));
        let set =
            |path: &[&str], value: Value| serde_json::json!({ "set": { "edits": [{ "path": path, "value": value }] } });
        let lower = state_after(&mut session, &set(&["volume", "z_mm"], serde_json::json!([-5.0, -4.0])));
        assert_eq!(lower["text"], COMPACT.replace("[-4.0, -3.0]", "[-5.0, -4.0]"));
        let broken = ask(&mut session, &set(&["volume", "z_mm"], serde_json::json!([-3.0, -4.0])));
        assert!(broken["error"].as_str().expect("a message").contains("z_mm"), "{broken}");
        assert_eq!(ask(&mut session, &serde_json::json!("keep"))["ok"]["text"], lower["text"]);
    }

    /// Samples add up: parts give the statistics of all at once.
    #[test]
    fn samples_and_budget_need_errors() {
        let mut session = Session::default();
        state_after(&mut session, &serde_json::json!({ "open": { "text": COMPACT, "name": "pairs" } }));
        let made = |add: u64| serde_json::json!({ "made": { "add": add, "seed": 1 } });
        assert!(ask(&mut session, &made(3))["error"].as_str().expect("a message").contains("[tolerance]"));
        let jig = serde_json::json!({ "set": { "edits": [{ "path": ["tolerance", "preset"], "value": "jig" }] } });
        state_after(&mut session, &jig);
        ask(&mut session, &made(3));
        let parts = ask(&mut session, &made(4));
        state_after(&mut session, &jig);
        assert_eq!(ask(&mut session, &made(7)), parts);
        assert_eq!(parts["ok"]["samples"], 7);
        let budget = ask(&mut session, &serde_json::json!({ "budget": { "samples": 5 } }));
        assert!(budget["ok"]["parts"].as_array().expect("parts").len() > 2, "{budget}");
    }

    /// Steps of a search make the film better, and are observed.
    #[test]
    fn search_goes_on_from_the_film_found() {
        let mut session = opened("published-film");
        let mut seen = Vec::new();
        let request = serde_json::json!({ "improve": { "steps": 3 } }).to_string();
        let answer = session.answer_reporting(request.as_bytes(), &mut |line| {
            seen.push(line.to_owned());
            ControlFlow::Continue(())
        });
        let answer: Value = serde_json::from_str(&answer).expect("JSON");
        assert!(!seen.is_empty());
        let error = |value: &Value| value.as_f64().expect("a number");
        assert!(error(&answer["ok"]["after"]) <= error(&answer["ok"]["before"]), "{answer}");
        let again = ask(&mut session, &serde_json::json!({ "improve": { "steps": 3 } }));
        assert!(error(&again["ok"]["after"]) < error(&answer["ok"]["before"]), "{again}");
    }

    /// A search keeps all of the user's text but the tiles, to its end and on each step of it.
    #[test]
    fn search_changes_tiles_alone() {
        let mut session = opened("published-film");
        let text = std::fs::read_to_string("../../layouts/published-film.toml").expect("readable");
        let tables = &text[..text.find("[[lattice]]").expect("a lattice")];
        let results: Vec<Value> =
            (0..8).map(|_| ask(&mut session, &serde_json::json!({ "improve": { "steps": 5 } }))).collect();
        for answer in &results {
            let found = answer["ok"]["state"]["text"].as_str().expect("a text");
            let comments =
                |text: &str| text.lines().filter(|line| line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>();
            assert_eq!(comments(found), comments(&text));
            assert!(found.contains(tables.lines().last().expect("a line")), "{found}");
            for line in tables.lines().filter(|line| line.contains(" = ")) {
                assert!(found.contains(line), "{line} is not in {found}");
            }
        }
        // To the end: a film that no step improves keeps its text.
        let mut last = results.last().expect("eight").clone();
        for _ in 0..40 {
            let next = ask(&mut session, &serde_json::json!({ "improve": { "steps": 9 } }));
            let found = next["ok"]["state"]["text"].as_str().expect("a text");
            assert_eq!(found.lines().filter(|line| line.starts_with('#')).count(), 10);
            let has_ended = next["ok"]["state"]["text"] == last["ok"]["state"]["text"];
            last = next;
            if has_ended {
                break;
            }
        }
        assert_eq!(last["ok"]["before"], last["ok"]["after"]);
        // The same steps on each machine.
        let mut again = opened("published-film");
        let first = ask(&mut again, &serde_json::json!({ "improve": { "steps": 5 } }));
        assert_eq!(first, results[0]);
    }

    /// A refused change leaves the text as it was.
    #[test]
    fn text_of_unchanged_tiles_stays() {
        let mut session = opened("published-film");
        let text = std::fs::read_to_string("../../layouts/published-film.toml").expect("readable");
        let impossible = serde_json::json!({ "edit": { "tiles": [{ "tile": 0, "size_mm": [-1, 3.3, 1.0] }] } });
        assert!(ask(&mut session, &impossible)["error"].is_string());
        assert_eq!(state_after(&mut session, &serde_json::json!("keep"))["text"], text);
    }

    /// Centres of a lattice are written without round-off.
    #[test]
    fn tiles_of_a_lattice_are_written_with_twelve_digits() {
        let mut session = opened("published-film");
        let edit = serde_json::json!({ "edit": { "tiles": [{ "tile": 0, "size_mm": [0.8, 3.3, 1.0] }] } });
        assert_eq!(ask(&mut session, &edit), serde_json::json!({ "ok": [] }));
        let kept = state_after(&mut session, &serde_json::json!("keep"));
        let text = kept["text"].as_str().expect("a text");
        assert_eq!(text.matches("[[tile]]").count(), 56);
        let lengths = text.lines().filter(|line| line.starts_with("position_mm") || line.starts_with("size_mm"));
        let longest = lengths.flat_map(|line| line.split(['[', ' ', ',', ']'])).map(str::len).max();
        assert!(longest <= Some("position_mm".len()), "{text}");
    }
}
