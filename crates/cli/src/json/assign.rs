//! `assign`: the errors of the film, and the plan.

use magsplice::making::MeasurementErrors;
use magsplice::tolerance::Statistics;
use serde::Serialize;

use crate::laying::assigned_film::AssignedFilm;
use magsplice::results::RecoilSummary;

/// The result of `assign`.
#[derive(Serialize)]
pub(crate) struct AssignJson<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    recoil: Option<RecoilSummary>,
    measured_tiles: usize,
    rms_mm: RmsJson<'a>,
    shims: Vec<ShimJson<'a>>,
    plan: Vec<PlaceJson<'a>>,
}

/// RMS displacement errors over the working volume and its three axes.
#[derive(Serialize)]
struct RmsJson<'a> {
    as_ordered: f64,
    in_order: f64,
    assigned: f64,
    /// Ends of the searches, by the linear model.
    starts: &'a [f64],
    #[serde(skip_serializing_if = "Option::is_none")]
    measurement: Option<MeasurementJson<'a>>,
}

/// Standard deviations of the errors of the measurements, and the RMS with them.
#[derive(Serialize)]
struct MeasurementJson<'a> {
    errors: &'a MeasurementErrors,
    rms: &'a Statistics,
}

#[derive(Serialize)]
struct ShimJson<'a> {
    place: &'a str,
    strength_t: f64,
}

#[derive(Serialize)]
struct PlaceJson<'a> {
    place: &'a str,
    tile: &'a str,
    centre_mm: [f64; 3],
    up: &'a str,
    mark: &'a str,
    mark_deg: f64,
    laid: bool,
}

impl<'a> AssignJson<'a> {
    pub(crate) fn new(film: &'a AssignedFilm) -> AssignJson<'a> {
        let measurement = film.assignment.measurement.as_ref().map(|(errors, rms)| MeasurementJson { errors, rms });
        AssignJson {
            layout: &film.layout.name,
            sha256: &film.layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            recoil: film.recoil.as_ref().map(RecoilSummary::new),
            measured_tiles: film.measured,
            rms_mm: RmsJson {
                as_ordered: film.assignment.ordered_rms_mm,
                in_order: film.assignment.found.in_order_rms_mm,
                assigned: film.assignment.found.rms_mm,
                starts: &film.assignment.found.starts_rms_mm,
                measurement,
            },
            shims: film
                .assignment
                .shims
                .iter()
                .map(|(shim, strength_t)| ShimJson { place: &film.layout.tiles[*shim].name, strength_t: *strength_t })
                .collect(),
            plan: film
                .assignment
                .plan
                .iter()
                .map(|row| PlaceJson {
                    place: &row.place,
                    tile: &row.tile,
                    centre_mm: row.centre_mm.to_array(),
                    up: row.up,
                    mark: row.mark,
                    mark_deg: row.mark_deg,
                    laid: row.is_laid,
                })
                .collect(),
        }
    }
}
