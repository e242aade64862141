//! `diagnose --figure`: wrong tiles, and how much the scan tells of each.

use magsplice::magnet::PerTileError;
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
    let mut errors = PerTileError::default();
    let is_noise = |estimate: &&Estimate| !estimate.is_significant() && named.components.len() > 1;
    named
        .components
        .iter()
        .filter(|estimate| !is_noise(estimate))
        .for_each(|estimate| errors[estimate.error] = estimate.value);
    match named.candidate.kind {
        ErrorKind::Strength => TileFault::Strength(errors.strength),
        ErrorKind::Turn => TileFault::Turn(DVec3::from(errors.rotation).map(f64::to_degrees)),
        ErrorKind::Direction => TileFault::Direction(errors.direction.map(f64::to_degrees)),
        _ => TileFault::Displacement(DVec3::from(errors.position)),
    }
}
