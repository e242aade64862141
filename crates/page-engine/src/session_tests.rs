//! Tests of a session by its requests alone.

use std::ops::ControlFlow;

use magsplice::Film;
use magsplice::layout::Layout;
use serde_json::Value;

use crate::session::Session;

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
    assert_eq!(ask(&mut session, &serde_json::json!({ "edit": { "tiles": moves } })), serde_json::json!({ "ok": [] }));
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
    assert!(ask(&mut session, &serde_json::json!("keep"))["error"].as_str().expect("a message").contains("overlap"));
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
