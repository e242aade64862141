//! `budget`: where the displacement error comes from.

use magsplice::tolerance::Estimate;
use serde::Serialize;

use crate::sampling::film_budget::BudgetedFilm;
use magsplice::results::RecoilSummary;

/// The result of `budget`. Mean squares are in mm^2; they add up.
#[derive(Serialize)]
pub(crate) struct BudgetJson<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    recoil: Option<RecoilSummary>,
    tiles: usize,
    seed: u64,
    samples: u64,
    /// Whether the parts are to first order, or by samples of each cause alone.
    first_order: bool,
    parts: Vec<PartJson>,
    /// The mean square of the splicing pattern without end; null if it is not known.
    endless_pattern_mm2: Option<AxesJson<f64>>,
    total_mm2: AxesJson<f64>,
    /// The same by exact samples.
    sampled_mm2: AxesJson<f64>,
    /// The expected mean square of exact samples over that to first order.
    mean_square_ratio: AxesJson<Option<RatioJson>>,
    worth_halving: Vec<ImprovementJson>,
    tiles_worth_halving: Vec<ImprovementJson>,
}

#[derive(Serialize)]
struct AxesJson<T> {
    x: T,
    y: T,
    z: T,
}

impl<T> From<[T; 3]> for AxesJson<T> {
    fn from([x, y, z]: [T; 3]) -> AxesJson<T> {
        AxesJson { x, y, z }
    }
}

#[derive(Serialize)]
struct PartJson {
    name: String,
    mean_square_mm2: AxesJson<f64>,
    /// Shares of the totals.
    share: AxesJson<f64>,
}

#[derive(Serialize)]
struct RatioJson {
    ratio: f64,
    interval_95: [f64; 2],
}

#[derive(Serialize)]
struct ImprovementJson {
    name: String,
    saved_mm2: AxesJson<f64>,
}

impl<'a> BudgetJson<'a> {
    pub(crate) fn new(film: &'a BudgetedFilm) -> BudgetJson<'a> {
        let totals = film.found.totals_mm2();
        let part = |part: magsplice::BudgetPart| PartJson {
            share: [0, 1, 2].map(|axis| part.mean_squares_mm2[axis] / totals[axis]).into(),
            name: part.name,
            mean_square_mm2: part.mean_squares_mm2.into(),
        };
        let ratio = |ratio: Estimate| RatioJson { ratio: ratio.value, interval_95: ratio.interval };
        let improvement = |name: String, saved: [f64; 3]| ImprovementJson { name, saved_mm2: saved.into() };
        let layout = &film.found.layout;
        BudgetJson {
            layout: &layout.name,
            sha256: &layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            recoil: film.recoil.as_ref().map(RecoilSummary::new),
            tiles: layout.tiles.len(),
            seed: film.seed,
            samples: film.samples,
            first_order: film.found.is_first_order,
            endless_pattern_mm2: film.found.endless_pattern_mm2().map(AxesJson::from),
            parts: film.found.parts().into_iter().map(part).collect(),
            total_mm2: totals.into(),
            sampled_mm2: film.found.sampled_mm2().into(),
            mean_square_ratio: film.found.check.axes.map(|axis| axis.mean_square_ratio.map(ratio)).into(),
            worth_halving: film
                .found
                .budget
                .causes
                .iter()
                .map(|item| improvement(film.found.cause(item.cause), item.saved_mm2))
                .collect(),
            tiles_worth_halving: film
                .found
                .budget
                .tiles
                .iter()
                .map(|item| improvement(layout.tiles[item.tile].name.clone(), item.saved_mm2))
                .collect(),
        }
    }
}
