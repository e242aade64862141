//! The published film against the `[expect]` table of its layout, unchanged and changed.

use std::fs;

use magsplice::decouple::Figure;
use magsplice::expect::{Baseline, Expectation};
use magsplice::field::InstructionSet;
use magsplice::prelude::*;

use crate::shipped::folder;

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

/// Whether a layout with this text has no findings and meets its expectations.
fn passes(text: &str, baseline: &Baseline) -> bool {
    let Ok(layout) = Layout::parse(text, "changed") else { return false };
    let outcomes = Film::new(layout.clone()).unwrap().outcomes(Some(baseline));
    assert_eq!(outcomes.len(), 6, "all of [expect] is evaluated");
    layout.findings.is_empty() && outcomes.iter().all(|(_, outcome)| outcome.as_ref().is_ok_and(|o| o.is_met()))
}

/// Changes each digit of the tiles and of the volume by one, and each number of the tiles by 1e-10.
#[test]
fn any_changed_digit_of_the_published_film_breaks_its_expectations() {
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
            assert!(!passes(&other, &baseline), "accepted:\n{other}");
            tried += 1;
            // Appends a tenth decimal to a number with a fraction, 1e-10 mm or T.
            let point = text[..at].rfind(['.', ' ', '[']).filter(|&i| text.as_bytes()[i] == b'.');
            let last = !text.as_bytes()[at + 1].is_ascii_digit();
            if let Some(point) = point.filter(|_| last && tiles.contains(&at)) {
                let other = format!("{}{:0>width$}{}", &text[..=at], 1, &text[at + 1..], width = 10 - (at - point));
                assert!(!passes(&other, &baseline), "accepted:\n{other}");
                tried += 1;
            }
        }
    }
    assert!(tried > 60, "{tried}");
}

/// The tolerance `within` = 1e-12 follows from the largest errors found, 2.5e-14 of the sum of the
/// magnitudes of the fields of the single components of the tiles' polarization: two computations
/// with such errors agree within the tolerance at every point of the baseline, for all instruction
/// sets. The bound of `Scene` is four times as large.
#[test]
fn baseline_holds_for_every_instruction_set() {
    const FOUND: f64 = 2.5e-14;
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
    let apart = magnitude.iter().zip(&baseline.field_t).map(|(sum, b)| 2.0 * FOUND * sum / b.length());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart <= within, "{apart:e}");
    // A tenth of the tolerance would be too tight.
    assert!(apart > 0.1 * within, "{apart:e}");
    for set in InstructionSet::available() {
        let scene = Scene::new(&layout.bare_tiles()).with_instruction_set(set).unwrap();
        let mut field = vec![DVec3::ZERO; baseline.points.len()];
        scene.field_into(Quantity::FluxDensity, &baseline.points, &mut field).unwrap();
        let found = baseline.difference(baseline.points.iter().copied(), &field).unwrap();
        assert!(found.relative <= apart, "{set:?}: {found:?}");
    }
}

/// Expectations are evaluated independently of each other.
#[test]
fn expectations_that_fail_to_evaluate_leave_the_others() {
    // The reference is at a zero of B_z, and there is no baseline.
    let text = published().replace("reference_mm = [0.0, 0.0, -5.0]", "reference_mm = [1000.0, 1000.0, 5.0]");
    let layout = Layout::parse(&text, "changed").unwrap();
    let outcomes = Film::new(layout).unwrap().outcomes(None);
    for (expectation, outcome) in outcomes {
        match expectation {
            Expectation::Figure(Figure::Uniformity(_) | Figure::Displacement(_)) => {
                assert!(matches!(outcome, Err(FilmError::NotBelow(_))), "{outcome:?}");
            }
            Expectation::Field => assert_eq!(outcome, Err(FilmError::NoBaseline)),
            Expectation::Figure(Figure::Amplitude) | Expectation::Clearance => assert!(outcome.unwrap().is_met()),
            _ => panic!("{expectation} is not expected of this film"),
        }
    }
}
