//! `diagnose --figure`: wrong tiles, and how much the scan tells of each.

use magsplice::making::{ErrorKind, Estimate, NamedError};
use magsplice::prelude::DVec3;
use magsplice_report::{DiagnosedTile, Figure, ReportError, TileFault, diagnosis_figure};

use crate::sensor::diagnosed_film::DiagnosedFilm;

pub(super) fn draw(film: &DiagnosedFilm) -> Result<Figure, ReportError> {
    let tiles: Vec<DiagnosedTile> = film
        .layout
        .tiles
        .iter()
        .enumerate()
        .map(|(index, tile)| DiagnosedTile {
            tile,
            faults: film.diagnosis.named.iter().filter(|of| of.candidate.tile == index).map(fault).collect(),
            untold: film.untold_of(index),
        })
        .collect();
    diagnosis_figure(&tiles)
}

fn fault(named: &NamedError) -> TileFault {
    let first = named.candidate.kind.components().start;
    let mut values = [0.0; 3];
    let is_noise = |estimate: &&Estimate| !estimate.is_significant() && named.components.len() > 1;
    named
        .components
        .iter()
        .filter(|estimate| !is_noise(estimate))
        .for_each(|estimate| values[estimate.error - first] = estimate.value);
    match named.candidate.kind {
        ErrorKind::Strength => TileFault::Strength(values[0]),
        ErrorKind::Turn => TileFault::Turn(DVec3::from(values).map(f64::to_degrees)),
        ErrorKind::Direction => TileFault::Direction([values[0], values[1]].map(f64::to_degrees)),
        _ => TileFault::Displacement(DVec3::from(values)),
    }
}
