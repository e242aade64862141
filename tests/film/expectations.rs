//! The shipped films against what their layouts expect of them.

use std::fs;
use std::path::{Path, PathBuf};

use magsplice::expect::{Baseline, Expectation};
use magsplice::field::InstructionSet;
use magsplice::prelude::*;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../layouts")
}

fn published() -> String {
    fs::read_to_string(folder().join("published-film.toml")).unwrap()
}

fn baseline() -> Baseline {
    let mut baseline = Baseline::default();
    let mut reader = csv::Reader::from_path(folder().join("published.field.csv")).unwrap();
    for row in reader.records() {
        let row: Vec<f64> = row.unwrap().iter().map(|value| value.parse().unwrap()).collect();
        baseline.points.push(DVec3::from_slice(&row));
        baseline.field_t.push(DVec3::from_slice(&row[3..]));
    }
    baseline
}

/// Whether `check` finds nothing in a layout with this text.
fn passes(text: &str, baseline: &Baseline) -> bool {
    let Ok(layout) = Layout::parse(text, "changed") else { return false };
    let outcomes = Film::new(&layout).outcomes(Some(baseline));
    assert_eq!(outcomes.len(), 6, "all of [expect] is evaluated");
    layout.findings.is_empty() && outcomes.iter().all(|(_, outcome)| outcome.as_ref().is_ok_and(|o| o.is_met()))
}

/// Every digit of the tiles and of the volume, one up, and every number of the tiles 1e-10 more.
#[test]
fn a_change_in_any_digit_of_the_published_film_is_caught() {
    let (text, baseline) = (published(), baseline());
    assert!(passes(&text, &baseline));
    let changed = |from: &str, to: &str| {
        let start = text.find(from).unwrap();
        let end = start + text[start..].find(to).unwrap_or(text.len() - start);
        start..end
    };
    let mut tried = 0;
    let tiles = changed("start_mm", "no such text");
    for range in [changed("[volume]", "reference_mm"), tiles.clone()] {
        for at in range.filter(|&at| text.as_bytes()[at].is_ascii_digit()) {
            let digit = (text.as_bytes()[at] - b'0' + 1) % 10;
            let other = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
            assert!(!passes(&other, &baseline), "not caught:\n{other}");
            tried += 1;
            // The tenth decimal of a number with a fraction: 1e-10 mm or T.
            let point = text[..at].rfind(['.', ' ', '[']).filter(|&i| text.as_bytes()[i] == b'.');
            let last = !text.as_bytes()[at + 1].is_ascii_digit();
            if let Some(point) = point.filter(|_| last && tiles.contains(&at)) {
                let other = format!("{}{:0>width$}{}", &text[..=at], 1, &text[at + 1..], width = 10 - (at - point));
                assert!(!passes(&other, &baseline), "not caught:\n{other}");
                tried += 1;
            }
        }
    }
    assert!(tried > 60, "{tried}");
}

/// Why `within` is 1e-12: two computations that keep the promise of `Scene`, 2e-14 of what the components of the tiles' polarization make
/// alone, cannot be further apart at any point of the baseline, whatever instructions their processors have.
#[test]
fn the_baseline_holds_on_every_processor() {
    const PROMISED: f64 = 2e-14;
    let layout = Layout::parse(&published(), "published").unwrap();
    let within = layout.expectations.field.clone().unwrap().within;
    let baseline = baseline();
    let mut magnitude = vec![0.0; baseline.points.len()];
    for tile in layout.bare_tiles() {
        for axis in DVec3::AXES {
            let component = Tile::new(tile.position(), tile.size(), tile.polarization_t() * axis).unwrap();
            let mut field = vec![DVec3::ZERO; magnitude.len()];
            Scene::new(&[component]).field_into(Quantity::FluxDensity, &baseline.points, &mut field).unwrap();
            magnitude.iter_mut().zip(field).for_each(|(sum, b)| *sum += b.length());
        }
    }
    let apart = magnitude.iter().zip(&baseline.field_t).map(|(sum, b)| 2.0 * PROMISED * sum / b.length());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart <= within, "{apart:e}");
    // And it is not so loose that ten times less would do.
    assert!(apart > 0.1 * within, "{apart:e}");
    for set in InstructionSet::available() {
        let scene = Scene::new(&layout.bare_tiles()).with_instruction_set(set).unwrap();
        let mut field = vec![DVec3::ZERO; baseline.points.len()];
        scene.field_into(Quantity::FluxDensity, &baseline.points, &mut field).unwrap();
        let found = baseline.difference(baseline.points.iter().copied(), &field).unwrap();
        assert!(found.relative <= apart, "{set:?}: {found:?}");
    }
}

/// Each expectation is evaluated by itself.
#[test]
fn what_cannot_be_evaluated_hides_nothing() {
    // The reference at a zero of B_z, and no baseline.
    let text = published().replace("reference_mm = [0.0, 0.0, -5.0]", "reference_mm = [1000.0, 1000.0, 5.0]");
    let layout = Layout::parse(&text, "changed").unwrap();
    let outcomes = Film::new(&layout).outcomes(None);
    for (expectation, outcome) in outcomes {
        match expectation {
            Expectation::UniformityRmse(_) | Expectation::DisplacementRmse(_) => {
                assert!(matches!(outcome, Err(FilmError::NotBelow(_))), "{outcome:?}");
            }
            Expectation::Field => assert_eq!(outcome, Err(FilmError::NoBaseline)),
            Expectation::Amplitude | Expectation::Clearance => assert!(outcome.unwrap().is_met()),
            _ => panic!("{expectation} is not expected of this film"),
        }
    }
}
