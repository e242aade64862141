//! `diagnose --figure`: wrong tiles, and how much the scan tells of each.

use magsplice::magnet::PerTileError;
use magsplice::prelude::DVec3;
use magsplice::scan::{ErrorKind, FittedError, NamedError};
use magsplice_report::{DiagnosedTile, Drawing, DrawnFault, ReportError, diagnosis_figure};

use crate::sensor::diagnosed_film::DiagnosedFilm;

pub(super) fn draw(film: &DiagnosedFilm) -> Result<Drawing, ReportError> {
    let tiles: Vec<DiagnosedTile> = film
        .layout
        .tiles
        .iter()
        .enumerate()
        .map(|(index, tile)| DiagnosedTile {
            tile,
            faults: film.diagnosis.named.iter().filter(|of| of.candidate.tile == index).map(fault).collect(),
            unresolved: film.unresolved_of(index),
        })
        .collect();
    diagnosis_figure(&tiles)
}

fn fault(named: &NamedError) -> DrawnFault {
    let mut errors = PerTileError::default();
    let is_noise = |estimate: &&FittedError| !estimate.is_significant() && named.components.len() > 1;
    named
        .components
        .iter()
        .filter(|estimate| !is_noise(estimate))
        .for_each(|estimate| errors[estimate.error] = estimate.value);
    match named.candidate.kind {
        ErrorKind::Strength => DrawnFault::Strength(errors.strength),
        ErrorKind::Turn => DrawnFault::Turn(DVec3::from(errors.rotation).map(f64::to_degrees)),
        ErrorKind::Direction => DrawnFault::Direction(errors.direction.map(f64::to_degrees)),
        _ => DrawnFault::Displacement(DVec3::from(errors.position)),
    }
}
