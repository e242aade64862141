//! Orders in which the tiles of a film are laid, and the force with which each tile must be held.
//!
//! Tiles are laid one by one, each at its place, where it is glued. While it is being laid, only
//! the tiles that are already there act on it. Its holding is the magnitude of that force. The
//! holding of an order is the largest of its steps. The film that is laid already is assumed to
//! hold.

use std::error::Error;
use std::fmt;

use crate::film_forces::FilmForces;
use magsplice_pair::Load;

/// An order of laying, with the load on each tile while it is being laid.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LayingOrder {
    tiles: Vec<usize>,
    loads: Vec<Load>,
}

/// Why a list of tiles is no order of laying.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OrderError {
    /// The list has another number of tiles than the film.
    Count {
        /// Number in the list.
        given: usize,
        /// Number in the film.
        tiles: usize,
    },
    /// A number is not the index of a tile.
    NoTile {
        /// Step, from 0.
        step: usize,
        /// The number.
        tile: usize,
    },
    /// A tile is laid twice.
    Twice {
        /// Step at which it is laid again, from 0.
        step: usize,
        /// The tile.
        tile: usize,
    },
}

impl LayingOrder {
    /// The order `tiles`: the index of the tile that is laid at each step.
    ///
    /// # Errors
    /// If not each tile occurs once.
    pub fn new(forces: &FilmForces, tiles: Vec<usize>) -> Result<LayingOrder, OrderError> {
        let count = forces.tile_count();
        if tiles.len() != count {
            return Err(OrderError::Count { given: tiles.len(), tiles: count });
        }
        let mut is_laid = vec![false; count];
        for (step, &tile) in tiles.iter().enumerate() {
            match is_laid.get_mut(tile) {
                None => return Err(OrderError::NoTile { step, tile }),
                Some(true) => return Err(OrderError::Twice { step, tile }),
                Some(laid) => *laid = true,
            }
        }
        let load = |(step, tile): (usize, &usize)| forces.by_some(*tile, tiles[..step].iter().copied());
        let loads = tiles.iter().enumerate().map(load).collect();
        Ok(LayingOrder { tiles, loads })
    }

    /// The tile that is laid at each step.
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

    /// The largest force on a tile while it is being laid.
    pub fn holding(&self) -> f64 {
        self.hardest_step().map_or(0.0, |(_, force)| force)
    }
}

impl fmt::Display for OrderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OrderError::Count { given, tiles } => {
                write!(f, "the order has {given} tiles, must have each of the {tiles} tiles of the film once")
            }
            OrderError::NoTile { step, tile } => write!(f, "step {step}: tile {tile}, must be a tile of the film"),
            OrderError::Twice { step, tile } => write!(f, "step {step}: tile {tile} is already placed"),
        }
    }
}

impl Error for OrderError {}
