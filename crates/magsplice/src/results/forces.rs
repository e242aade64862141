//! Forces and torques of the tiles of a film on each other, and an order of laying.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use magsplice_force::{FilmForces, LayingOrder, LeastHolding, Load, OrderSettings};
use serde::Serialize;

use super::source::LayoutSource;
use crate::film::Film;
use crate::film_error::FilmError;
use crate::film_forces::{ForceChange, PER_MM2, SolvedForces};
use crate::stage::Stage;

/// The loads on the tiles of a film.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmLoads {
    /// The layout.
    #[serde(flatten)]
    pub source: LayoutSource,
    /// What recoil changes in the forces. `None` without recoil.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recoil: Option<ForceChange>,
    /// The load on each tile by all others; torques are about its centre.
    pub tiles: Vec<TileLoad>,
    /// Sum of all forces, and of all torques about the origin: zero but for round-off.
    pub sum: LoadN,
    /// An order of laying, if one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<OrderedLoads>,
}

/// A force and a torque.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LoadN {
    /// Force.
    pub force_n: DVec3,
    /// Torque.
    pub torque_n_mm: DVec3,
}

/// A tile with its load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TileLoad {
    /// Name of the tile.
    pub name: String,
    /// The load.
    #[serde(flatten)]
    pub load: LoadN,
    /// Index of the tile.
    #[serde(skip)]
    pub tile: usize,
}

/// An order of laying.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OrderedLoads {
    /// `given`, `least`, or the source of an order that was stated.
    pub source: String,
    /// Largest force on a tile while it is laid.
    pub holding_n: f64,
    /// Step of the largest force, from 1.
    pub hardest_step: usize,
    /// Holding of the order of the layout file.
    pub given_holding_n: f64,
    /// Of the least order: no order has a smaller holding.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound_n: Option<f64>,
    /// Of the least order: the holding of the order that is built backwards, tile by tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greedy_holding_n: Option<f64>,
    /// Of the least order: the seed of the search.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// In the order of laying: the load by the tiles that are already there.
    pub steps: Vec<TileLoad>,
}

/// Which order of laying is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub enum OrderChoice {
    /// The order of the layout.
    Given,
    /// The order with the least holding that a search with this seed finds.
    Least {
        /// Seed of the random numbers.
        seed: u64,
    },
    /// Another order.
    Stated {
        /// Where it is from.
        source: String,
        /// The tile of each step.
        tiles: Vec<usize>,
    },
}

impl Film {
    /// The loads of the tiles on each other, and while they are laid if there is an order.
    /// `turned_error` is the largest relative error of the force of two tiles that are turned
    /// against each other.
    ///
    /// # Errors
    /// As [`Film::pair_forces`]; [`FilmError::Order`] if the order does not have each tile once.
    pub fn forces(&self, turned_error: f64, order: Option<OrderChoice>) -> Result<FilmLoads, FilmError> {
        let SolvedForces { loads: pairs, recoil } = self.pair_forces(turned_error)?;
        let order = order.map(|order| self.ordered(&pairs, order)).transpose()?;
        let tiles = self.tile_loads(0.., &pairs.by_all());
        let mut sum = LoadN::default();
        for (named, TileLoad { load, .. }) in self.layout().tiles.iter().zip(&tiles) {
            sum.force_n += load.force_n;
            sum.torque_n_mm += load.torque_n_mm + named.tile.position().cross(load.force_n);
        }
        Ok(FilmLoads { source: LayoutSource::of(self.layout()), recoil, tiles, sum, order })
    }

    fn ordered(&self, pairs: &FilmForces, choice: OrderChoice) -> Result<OrderedLoads, FilmError> {
        let order = |tiles: Vec<usize>| LayingOrder::new(pairs, tiles).map_err(FilmError::Order);
        let given = order((0..pairs.tile_count()).collect())?;
        let mut least = None;
        let (source, order) = match choice {
            OrderChoice::Given => ("given".to_owned(), given.clone()),
            OrderChoice::Stated { source, tiles } => (source, order(tiles)?),
            OrderChoice::Least { seed } => {
                let settings = OrderSettings { seed, ..OrderSettings::default() };
                let done = AtomicUsize::new(0);
                let counted = || {
                    let done = done.fetch_add(1, Ordering::Relaxed);
                    self.tell(Stage { name: "order of laying", done, of: Some(settings.runs), unit: "runs" });
                };
                let found = LeastHolding::search(pairs, &settings, counted);
                least = Some((found.bound, found.greedy, seed));
                ("least".to_owned(), found.order)
            }
        };
        let (hardest, holding) = order.hardest_step().unwrap_or((0, 0.0));
        Ok(OrderedLoads {
            source,
            holding_n: PER_MM2 * holding,
            hardest_step: hardest + 1,
            given_holding_n: PER_MM2 * given.holding(),
            bound_n: least.map(|(bound, ..)| PER_MM2 * bound),
            greedy_holding_n: least.map(|(_, greedy, _)| PER_MM2 * greedy),
            seed: least.map(|(.., seed)| seed),
            steps: self.tile_loads(order.tiles().iter().copied(), order.loads()),
        })
    }

    fn tile_loads(&self, tiles: impl Iterator<Item = usize>, loads: &[Load]) -> Vec<TileLoad> {
        let load = |(tile, load): (usize, &Load)| TileLoad {
            name: self.layout().tiles[tile].name.clone(),
            load: LoadN { force_n: PER_MM2 * load.force, torque_n_mm: PER_MM2 * load.torque },
            tile,
        };
        tiles.zip(loads).map(load).collect()
    }
}

impl FilmLoads {
    /// The tile with the largest force, and with the largest torque. `None` without tiles.
    pub fn largest(&self) -> Option<[usize; 2]> {
        let largest = |size: &dyn Fn(&LoadN) -> f64| {
            let size = |tile: usize| size(&self.tiles[tile].load);
            (0..self.tiles.len()).reduce(|most, next| if size(next) > size(most) { next } else { most })
        };
        Some([largest(&|load| load.force_n.length())?, largest(&|load| load.torque_n_mm.length())?])
    }
}
