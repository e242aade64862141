//! Forces and torques of the tiles of a film on each other, and a placement order.

use glam::DVec3;
use magsplice_force::{FilmForces, FilmForcesError, LeastHolding, Load, OrderSettings, PlacementOrder};
use magsplice_layout::check_memory;
use magsplice_recoil::{Magnetization, RefinementError};
use serde::Serialize;

use super::source::LayoutSource;
use crate::film::Film;
use crate::film_error::FilmError;
use crate::film_recoil::recoil_tiles;
use crate::stage::Stage;

/// Levels of division of tiles with a recoil permeability: 8 and 27 cells for a compact tile.
const RECOIL_LEVELS: [usize; 2] = [2, 3];

/// Error of the forces at the higher level, relative to the difference between the two levels. In
/// five or six tiles of three films, with permeabilities of 1.05 and 1.2, levels 7 to 10 differ
/// from the higher level by 0.9 to 1.7 times this difference, and the limit probably by up to 2.2
/// times (docs/recoil.md).
const ERROR_OF_DIFFERENCE: f64 = 3.0;

/// From the unit of [`Load`](magsplice_force::Load) with lengths in mm to N, and to N mm.
const PER_MM2: f64 = 1e-6;

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
    /// Sum of all forces, and of all torques about the origin: zero but for round-off, and without
    /// iron.
    pub sum: LoadN,
    /// Whether iron is a part of the layout, which takes up the sum.
    #[serde(skip)]
    pub by_iron: bool,
    /// A placement order, if one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<OrderedLoads>,
}

/// What recoil changes in the forces on tiles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ForceChange {
    /// Number of cells.
    pub cells: usize,
    /// The level of division.
    pub level: usize,
    /// The largest change of the force on a tile by all others.
    pub change_n: f64,
    /// The estimate of the largest error of such a force.
    pub error_n: f64,
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

/// A placement order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OrderedLoads {
    /// `given`, `least`, or the source of an order that was stated.
    pub source: String,
    /// Largest force on a tile while it is placed.
    pub holding_n: f64,
    /// Step of the largest force, from 1.
    pub hardest_step: usize,
    /// Holding force of the order of the layout file.
    pub given_holding_n: f64,
    /// Of the least order: no order has a smaller holding force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound_n: Option<f64>,
    /// Of the least order: the holding force of the order that is built backwards, tile by tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greedy_holding_n: Option<f64>,
    /// Of the least order: the seed of the search.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// In the placement order: the load by the tiles that are already there.
    pub steps: Vec<TileLoad>,
}

/// Which placement order is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub enum OrderChoice {
    /// The order of the layout.
    Given,
    /// The order with the smallest holding force that a search with this seed finds.
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

/// Bytes of the loads of a pair of tiles: two vectors, twice while they are sorted.
const BYTES_PER_PAIR: f64 = 96.0;

impl Film {
    /// The loads of the tiles on each other, and while they are placed if there is an order.
    /// `turned_error` is the largest relative error of the force of two tiles that are turned
    /// against each other.
    ///
    /// # Errors
    /// [`FilmError::Forces`] for too many tiles, and for turned tiles so close that their force
    /// does not converge; [`FilmError::Recoil`] if the polarization of the cells is not known;
    /// [`FilmError::Order`] if the order does not have each tile once.
    pub fn forces(&self, turned_error: f64, order: Option<OrderChoice>) -> Result<FilmLoads, FilmError> {
        let (pairs, recoil) = self.pair_forces(turned_error)?;
        let order = order.map(|order| self.ordered(&pairs, order)).transpose()?;
        let tiles = self.tile_loads(0.., &pairs.by_all());
        let mut sum = LoadN::default();
        for (named, TileLoad { load, .. }) in self.layout().tiles.iter().zip(&tiles) {
            sum.force_n += load.force_n;
            sum.torque_n_mm += load.torque_n_mm + named.tile.position().cross(load.force_n);
        }
        let by_iron = !self.layout().iron.is_empty();
        Ok(FilmLoads { source: LayoutSource::of(self.layout()), recoil, tiles, sum, by_iron, order })
    }

    /// The loads of all pairs of tiles. `turned_error` is the largest relative error of the force
    /// of two tiles that are turned against each other.
    ///
    /// Tiles with a recoil permeability are divided into 27 cells or more, with the polarization
    /// that they have in the whole film, also while the film is placed.
    fn pair_forces(&self, turned_error: f64) -> Result<(FilmForces, Option<ForceChange>), FilmError> {
        let layout = self.layout();
        let tiles = layout.bare_tiles();
        let images = layout.iron.images(&tiles).expect("tiles before the iron, as the layout requires");
        let pairs = tiles.len().min(FilmForces::MOST_TILES) as f64;
        let cause = || format!("the layout has {} tiles, and each acts on all others", tiles.len());
        check_memory(BYTES_PER_PAIR * pairs * pairs, cause, |_| "take fewer tiles".to_owned())
            .map_err(FilmError::Memory)?;
        let films = if layout.has_recoil() { 1 + RECOIL_LEVELS.len() } else { 1 };
        let passes = if images.tiles.is_empty() { films } else { 2 * films };
        let counted = self.counting("forces", Some(passes * tiles.len()), "tiles");
        let failed = |error: FilmForcesError| FilmError::from_forces(error, layout);
        let rigid = FilmForces::new(&tiles, turned_error, &counted).map_err(failed)?;
        let rigid = rigid.with_images(&tiles, &images.tiles, &images.owners, turned_error, &counted).map_err(failed)?;
        if !layout.has_recoil() {
            return Ok((rigid, None));
        }
        let recoil_tiles = recoil_tiles(layout, None);
        let at_level = |level: usize| {
            let stage = Stage { name: "polarization, level", done: level, of: None, unit: "" };
            let solved = Magnetization::solve(&recoil_tiles, &layout.iron, level, |_| self.tell(stage))
                .map_err(|error| FilmError::from_recoil(RefinementError::Recoil(error), layout))?;
            let means = solved.mean_tiles();
            let (both, owners) = ([&means[..], solved.cells()], solved.owners());
            let loads = FilmForces::of_cells(both[0], both[1], owners, turned_error, &counted).map_err(failed)?;
            if layout.iron.is_empty() {
                return Ok((loads, both[1].len()));
            }
            let [of_means, of_cells] = both.map(|of| layout.iron.images(of).expect("cells of tiles before the iron"));
            let images = [&of_means, &of_cells];
            let loads = loads.with_images_of_cells(both, owners, images, turned_error, &counted).map_err(failed)?;
            Ok((loads, both[1].len()))
        };
        let [(coarse, _), (loads, cells)] = [at_level(RECOIL_LEVELS[0])?, at_level(RECOIL_LEVELS[1])?];
        let apart = |other: &FilmForces| {
            let pairs = loads.by_all().into_iter().zip(other.by_all());
            pairs.map(|(load, other)| (load.force - other.force).length()).fold(0.0, f64::max)
        };
        let (change_n, error_n) = (PER_MM2 * apart(&rigid), PER_MM2 * (ERROR_OF_DIFFERENCE * apart(&coarse)));
        let recoil = Some(ForceChange { cells, level: RECOIL_LEVELS[1], change_n, error_n });
        Ok((loads, recoil))
    }

    fn ordered(&self, pairs: &FilmForces, choice: OrderChoice) -> Result<OrderedLoads, FilmError> {
        let order = |tiles: Vec<usize>| PlacementOrder::new(pairs, tiles).map_err(FilmError::Order);
        let given = order((0..pairs.tile_count()).collect())?;
        let mut least = None;
        let (source, order) = match choice {
            OrderChoice::Given => ("given".to_owned(), given.clone()),
            OrderChoice::Stated { source, tiles } => (source, order(tiles)?),
            OrderChoice::Least { seed } => {
                let settings = OrderSettings { seed, ..OrderSettings::default() };
                let counted = self.counting("placement order", Some(settings.runs), "runs");
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

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;

    use super::*;

    fn layout(permeability: f64, second: &str) -> Layout {
        let tile = "size_mm = [1, 1, 1]\npolarization_t = [1, 0, 0]\n";
        let text = format!(
            "format = 1\nname = \"pair\"\n[material]\nrecoil_permeability = {permeability}\n\
             [[tile]]\nname = \"a\"\nposition_mm = [0, 0, 0]\n{tile}[[tile]]\nname = \"b\"\n{second}\n{tile}"
        );
        Layout::parse(&text, "layout").unwrap()
    }

    /// The error contains the force of finer cells.
    #[test]
    fn recoil_weakens_the_force_of_two_cubes() {
        let force = |permeability| {
            let layout = layout(permeability, "position_mm = [1.1, 0, 0]");
            let found = Film::rigid(layout.clone()).pair_forces(1e-9).unwrap();
            let finer = Magnetization::solve(&recoil_tiles(&layout, None), &layout.iron, 6, |_| {}).unwrap();
            let finer = FilmForces::of_cells(&finer.mean_tiles(), finer.cells(), finer.owners(), 1e-9, || {}).unwrap();
            (found.0.by_one(0, 1).force.x, finer.by_one(0, 1).force.x, found.1)
        };
        let (rigid, _, none) = force(1.0);
        assert_eq!(none, None);
        let (with, finer, recoil) = force(1.2);
        let recoil = recoil.unwrap();
        assert!((0.8..0.98).contains(&(with / rigid)), "{with} {rigid}");
        assert!((PER_MM2 * (rigid - with).abs() / recoil.change_n - 1.0).abs() < 1e-9, "{recoil:?}");
        assert!(
            PER_MM2 * (with - finer).abs() < recoil.error_n && recoil.error_n < recoil.change_n,
            "{with} {finer} {recoil:?}"
        );
    }

    #[test]
    fn turned_tiles_that_touch_are_named() {
        let layout = layout(1.0, "position_mm = [1, 0, 0]\nrotation = { axis = [1, 0, 0], angle_deg = 20 }");
        let error = Film::rigid(layout.clone()).pair_forces(1e-13).unwrap_err();
        assert!(error.to_string().starts_with("tiles \"a\" and \"b\": their force has an error of"), "{error}");
    }
}
