//! `forces`: loads on tiles, and an order of laying.

use magsplice::ForceChange;
use magsplice::prelude::DVec3;
use serde::Serialize;

use crate::film_loads::{FilmLoads, LoadN, OrderSource, OrderedLoads};

/// The result of `forces`. Forces are in N, torques in N mm about the centre of the tile.
#[derive(Serialize)]
pub(crate) struct ForcesJson<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    /// Absent without recoil.
    #[serde(skip_serializing_if = "Option::is_none")]
    recoil: Option<ForceChangeJson>,
    tiles: Vec<TileJson<'a>>,
    /// Zero but for round-off; the torque is about the origin.
    sum: LoadJson,
    /// Absent without `--order`.
    #[serde(skip_serializing_if = "Option::is_none")]
    order: Option<OrderJson<'a>>,
}

/// What recoil changes in the forces, and the estimate of their error.
#[derive(Serialize)]
struct ForceChangeJson {
    cells: usize,
    level: usize,
    change_n: f64,
    error_n: f64,
}

#[derive(Serialize)]
struct LoadJson {
    force_n: [f64; 3],
    torque_n_mm: [f64; 3],
}

#[derive(Serialize)]
struct TileJson<'a> {
    name: &'a str,
    #[serde(flatten)]
    load: LoadJson,
}

#[derive(Serialize)]
struct OrderJson<'a> {
    /// `given`, `least`, or the path of a file.
    source: &'a str,
    holding_n: f64,
    /// Step of the largest force, from 1.
    hardest_step: usize,
    /// Holding of the order of the layout file.
    given_holding_n: f64,
    /// Of `least`: no order has a smaller holding.
    #[serde(skip_serializing_if = "Option::is_none")]
    bound_n: Option<f64>,
    /// Of `least`: the holding of the order that is built backwards, tile by tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    greedy_holding_n: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    /// In the order of laying: the load by the tiles that are already there.
    steps: Vec<TileJson<'a>>,
}

impl From<&LoadN> for LoadJson {
    fn from(load: &LoadN) -> LoadJson {
        let array = |vector: DVec3| vector.to_array();
        LoadJson { force_n: array(load.force_n), torque_n_mm: array(load.torque_n_mm) }
    }
}

impl<'a> ForcesJson<'a> {
    pub(crate) fn new(loads: &'a FilmLoads<'a>) -> ForcesJson<'a> {
        let layout = loads.layout;
        let tile = |index: usize, load: &LoadN| TileJson { name: &layout.tiles[index].name, load: load.into() };
        let order = |order: &'a OrderedLoads| {
            let (source, bound_n, greedy_holding_n, seed) = match &order.source {
                OrderSource::Given => ("given", None, None, None),
                OrderSource::File(path) => (path.as_str(), None, None, None),
                OrderSource::Least { bound_n, greedy_n, seed } => {
                    ("least", Some(*bound_n), Some(*greedy_n), Some(*seed))
                }
            };
            OrderJson {
                source,
                holding_n: order.holding_n,
                hardest_step: order.hardest + 1,
                given_holding_n: order.given_holding_n,
                bound_n,
                greedy_holding_n,
                seed,
                steps: order.steps.iter().map(|(index, load)| tile(*index, load)).collect(),
            }
        };
        ForcesJson {
            layout: &layout.name,
            sha256: &layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            recoil: loads.recoil.map(|ForceChange { cells, level, change, error }| ForceChangeJson {
                cells,
                level,
                change_n: change,
                error_n: error,
            }),
            tiles: loads.tiles.iter().enumerate().map(|(index, load)| tile(index, load)).collect(),
            sum: (&loads.sum).into(),
            order: loads.order.as_ref().map(order),
        }
    }
}
