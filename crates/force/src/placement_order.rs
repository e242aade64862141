//! Placement orders of the tiles of a film, and the force that must hold each tile.
//!
//! Tiles are placed one by one and glued. During placement only the tiles already there act on a
//! tile, and its own images in iron. The holding force of a step is the magnitude of their force on
//! it, and the holding force of an order is the largest of its steps. Tiles already placed are
//! assumed to hold.

use crate::film_forces::FilmForces;
use magsplice_pair::Load;
use thiserror::Error;

/// A placement order, with the load on each tile during its placement.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PlacementOrder {
    tiles: Vec<usize>,
    loads: Vec<Load>,
}

/// The reason why a list of tiles is no placement order.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum OrderError {
    /// The numbers of tiles in the list and in the film differ.
    #[error("the order has {given} tiles, must have each of the {tiles} tiles of the film once")]
    Count {
        /// Number in the list.
        given: usize,
        /// Number in the film.
        tiles: usize,
    },
    /// A number is not the index of a tile.
    #[error("step {step}: tile {tile}, must be a tile of the film")]
    NoTile {
        /// Step, from 0.
        step: usize,
        /// The number.
        tile: usize,
    },
    /// A tile is placed twice.
    #[error("step {step}: tile {tile} is already placed")]
    Twice {
        /// Step of the second placement, from 0.
        step: usize,
        /// The tile.
        tile: usize,
    },
}

impl PlacementOrder {
    /// The order `tiles`: the index of the tile placed at each step.
    ///
    /// # Errors
    /// If a tile is missing or repeated, or an index is not the index of a tile.
    pub fn new(forces: &FilmForces, tiles: Vec<usize>) -> Result<PlacementOrder, OrderError> {
        let count = forces.tile_count();
        if tiles.len() != count {
            return Err(OrderError::Count { given: tiles.len(), tiles: count });
        }
        let mut is_placed = vec![false; count];
        for (step, &tile) in tiles.iter().enumerate() {
            match is_placed.get_mut(tile) {
                None => return Err(OrderError::NoTile { step, tile }),
                Some(true) => return Err(OrderError::Twice { step, tile }),
                Some(placed) => *placed = true,
            }
        }
        let load = |(step, tile): (usize, &usize)| forces.by_some(*tile, tiles[..=step].iter().copied());
        let loads = tiles.iter().enumerate().map(load).collect();
        Ok(PlacementOrder { tiles, loads })
    }

    /// The tile placed at each step.
    pub fn tiles(&self) -> &[usize] {
        &self.tiles
    }

    /// The load on the tile of each step, by the tiles of the steps before.
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// The first step with the largest force, and that force; `None` without tiles.
    pub fn hardest_step(&self) -> Option<(usize, f64)> {
        let forces = self.loads.iter().map(|load| load.force.length()).enumerate();
        forces.reduce(|most, next| if next.1 > most.1 { next } else { most })
    }

    /// The largest force on a tile during its placement.
    pub fn holding(&self) -> f64 {
        self.hardest_step().map_or(0.0, |(_, force)| force)
    }
}
