//! `tolerance`: statistics of samples.

use magsplice::decouple::{Figures, PerAxis, PerParameter};
use magsplice::making::Sorting;
use magsplice::tolerance::{Estimate, Statistics};
use serde::Serialize;

use crate::sampling::sampled_film::SampledFilm;
use magsplice::results::RecoilSummary;

/// The result of `tolerance`.
#[derive(Serialize)]
pub(crate) struct ToleranceJson<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    recoil: Option<RecoilSummary>,
    tiles: usize,
    /// Hash of the tiles, their errors, the volume and the ideal film.
    film: &'a str,
    seed: u64,
    first: u64,
    count: u64,
    /// How tiles are sorted; absent if they are not.
    #[serde(skip_serializing_if = "Option::is_none")]
    sorting: Option<&'a Sorting>,
    uniformity_rmse: PerParameter<Option<StatisticsJson>>,
    displacement_rmse_mm: PerAxis<StatisticsJson>,
    amplitude: StatisticsJson,
    /// The share of the films that keep the bounds of `[expect]`.
    #[serde(rename = "yield")]
    yield_share: Option<ShareJson>,
    /// The share of the films that keep all bounds of `[expect.made]`.
    yield_made: Option<ShareJson>,
}

#[derive(Serialize)]
struct StatisticsJson {
    nominal: f64,
    mean: f64,
    p1: f64,
    p5: f64,
    p50: f64,
    p95: f64,
    p99: f64,
    /// Ends of intervals of 95 % confidence; null where there are too few samples.
    interval_95: IntervalsJson,
}

#[derive(Serialize)]
struct IntervalsJson {
    mean: [f64; 2],
    p1: [f64; 2],
    p5: [f64; 2],
    p50: [f64; 2],
    p95: [f64; 2],
    p99: [f64; 2],
}

#[derive(Serialize)]
struct ShareJson {
    share: f64,
    interval_95: [f64; 2],
}

impl<'a> ToleranceJson<'a> {
    pub(crate) fn new(film: &'a SampledFilm) -> ToleranceJson<'a> {
        let statistics = |figure| Some(StatisticsJson::new(*film.nominal.get(figure)?, film.statistics.get(figure)?));
        let Figures { uniformity_rmse, displacement_rmse_mm, amplitude } =
            Figures::from_fn(statistics).expect("displacements and the amplitude are defined");
        ToleranceJson {
            layout: &film.layout.name,
            sha256: &film.layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            recoil: film.recoil.as_ref().map(RecoilSummary::new),
            tiles: film.layout.tiles.len(),
            film: &film.source.fingerprint,
            seed: film.source.seed,
            first: film.source.first,
            count: film.source.count,
            sorting: film.sorting.as_ref(),
            uniformity_rmse,
            displacement_rmse_mm,
            amplitude,
            yield_share: film.yield_share.map(ShareJson::new),
            yield_made: film.yield_made.map(ShareJson::new),
        }
    }
}

impl ShareJson {
    fn new(share: Estimate) -> ShareJson {
        ShareJson { share: share.value, interval_95: share.interval }
    }
}

impl StatisticsJson {
    fn new(nominal: f64, statistics: &Statistics) -> StatisticsJson {
        let Statistics { mean, p1, p5, p50, p95, p99, .. } = statistics;
        StatisticsJson {
            nominal,
            mean: mean.value,
            p1: p1.value,
            p5: p5.value,
            p50: p50.value,
            p95: p95.value,
            p99: p99.value,
            interval_95: IntervalsJson {
                mean: mean.interval,
                p1: p1.interval,
                p5: p5.interval,
                p50: p50.interval,
                p95: p95.interval,
                p99: p99.interval,
            },
        }
    }
}
