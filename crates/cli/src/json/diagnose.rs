//! `diagnose`: the tiles that are wrong, and what the scan cannot tell.

use std::collections::BTreeMap;

use magsplice::magnet::TileError;
use serde::Serialize;

use crate::sensor::diagnosed_film::{DiagnosedFilm, kind};
use magsplice::results::RecoilSummary;

/// The result of `diagnose`.
#[derive(Serialize)]
pub(crate) struct DiagnoseJson<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    recoil: Option<RecoilSummary>,
    tiles: usize,
    readings: usize,
    noise_t: [f64; 3],
    false_alarm: f64,
    /// Whether tiles that are not named have ordinary errors.
    ordinary_errors: bool,
    named: Vec<NamedJson<'a>>,
    /// Whether all significant errors are named.
    complete: bool,
    scan: ScanJson,
    residual_t: f64,
    chi_squared: f64,
    degrees_of_freedom: usize,
    residual_too_large: bool,
    unresolved: Vec<UnresolvedJson<'a>>,
    similar: Vec<SimilarJson<'a>>,
}

#[derive(Serialize)]
struct NamedJson<'a> {
    tile: &'a str,
    kind: &'static str,
    /// Value and standard deviation by component.
    components: BTreeMap<&'static str, [f64; 2]>,
    chi_squared: f64,
    /// Natural logarithm of the probability that chance gives as much for one error.
    ln_probability: f64,
    alternatives: Vec<AlternativeJson<'a>>,
}

#[derive(Serialize)]
struct AlternativeJson<'a> {
    tile: &'a str,
    kind: &'static str,
}

#[derive(Serialize)]
struct ScanJson {
    strength: f64,
    offset_t: [f64; 3],
    rotation_deg: [f64; 3],
    start_mm: [f64; 3],
}

#[derive(Serialize)]
struct UnresolvedJson<'a> {
    tile: &'a str,
    error: &'static str,
    before: f64,
    after: f64,
}

#[derive(Serialize)]
struct SimilarJson<'a> {
    tiles: [&'a str; 2],
    errors: [&'static str; 2],
    correlation: f64,
}

impl<'a> DiagnoseJson<'a> {
    pub(crate) fn new(film: &'a DiagnosedFilm) -> DiagnoseJson<'a> {
        let diagnosis = &film.diagnosis;
        let named = diagnosis.named.iter().map(|named| NamedJson {
            tile: film.name(named.candidate.tile),
            kind: kind(named.candidate.kind),
            components: named
                .components
                .iter()
                .map(|of| (of.error.key(), [of.value, of.deviation].map(|value| of.error.shown(value))))
                .collect(),
            chi_squared: named.chi_squared,
            ln_probability: named.ln_probability,
            alternatives: named
                .alternatives
                .iter()
                .map(|other| AlternativeJson { tile: film.name(other.tile), kind: kind(other.kind) })
                .collect(),
        });
        let unresolved = film.unresolved().into_iter().map(|of| UnresolvedJson {
            tile: film.name(of.tile),
            error: of.error.key(),
            before: of.error.shown(of.before),
            after: of.error.shown(of.after),
        });
        let similar = film.similar().iter().map(|of| SimilarJson {
            tiles: [of.first.0, of.second.0].map(|tile| film.name(tile)),
            errors: [of.first.1, of.second.1].map(TileError::key),
            correlation: of.correlation,
        });
        DiagnoseJson {
            layout: &film.layout.name,
            sha256: &film.layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            recoil: film.recoil.as_ref().map(RecoilSummary::new),
            tiles: film.layout.tiles.len(),
            readings: film.readings,
            noise_t: film.noise_t.to_array(),
            false_alarm: film.false_alarm,
            ordinary_errors: film.has_ordinary,
            named: named.collect(),
            complete: diagnosis.is_complete,
            scan: ScanJson {
                strength: diagnosis.scan.strength,
                offset_t: diagnosis.scan.offset_t.to_array(),
                rotation_deg: diagnosis.scan.rotation_rad.map(f64::to_degrees).to_array(),
                start_mm: diagnosis.scan.start.to_array(),
            },
            residual_t: diagnosis.residual_t(),
            chi_squared: diagnosis.chi_squared,
            degrees_of_freedom: diagnosis.freedom,
            residual_too_large: diagnosis.is_residual_too_large(),
            unresolved: unresolved.collect(),
            similar: similar.collect(),
        }
    }
}
