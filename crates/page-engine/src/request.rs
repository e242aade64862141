//! What a page asks for.

use magsplice::layout::TextEdit;
use magsplice::prelude::DVec3;
use serde::Deserialize;

/// A request of a page.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// Reads a layout; it replaces the one before. The answer is its state: text, tiles, volume.
    Open {
        /// Its text, TOML.
        text: String,
        /// Its name in messages.
        name: String,
    },
    /// Sets values in the text, whose comments stay. The answer is the new state. The layout stays
    /// as it was if the result breaks a rule.
    Set {
        /// The values.
        edits: Vec<TextEdit>,
    },
    /// Changes tiles until the next request that reads the text. The answer is the pairs of tiles
    /// that then overlap.
    Edit {
        /// The changes.
        tiles: Vec<TileEdit>,
    },
    /// Writes the changed tiles into the text. The answer is the new state.
    Keep,
    /// Evaluates the film over its working volume.
    Evaluate {
        /// Whether tiles keep their polarization, whatever their recoil permeability: faster, while
        /// a tile is dragged.
        rigid: bool,
    },
    /// A quantity on a plane of constant z over the working volume.
    Map {
        /// The quantity.
        quantity: MapQuantity,
        /// 0 for x, 1 for y, 2 for z.
        axis: usize,
        /// The height.
        z_mm: f64,
        /// Number of points along x and y, at least 2 and at most 200 each.
        counts: [usize; 2],
        /// As in `Evaluate`.
        rigid: bool,
    },
    /// The causes of the displacement error of films as made.
    Budget {
        /// Number of exact samples that check the first order.
        samples: u64,
    },
    /// Further samples of films as made. The answer is the statistics of all samples so far.
    Made {
        /// Number of samples to add.
        add: u64,
        /// Seed of the random numbers.
        seed: u64,
    },
    /// Steps of the search for a better film, by the table `[design]`. The answer is the film
    /// found, which becomes the layout.
    Improve {
        /// Largest number of steps.
        steps: usize,
    },
}

/// A quantity of a map.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum MapQuantity {
    /// B in tesla.
    FluxDensity,
    /// The displacement that the parameters show, minus the true one, in millimetres.
    DisplacementError,
    /// The standard deviation of the displacement by one reading, in millimetres.
    Resolution,
}

/// The new numbers of a tile. What is not given stays.
#[derive(Debug, Deserialize)]
pub struct TileEdit {
    /// Index of the tile.
    pub tile: usize,
    /// Centre.
    pub position_mm: Option<DVec3>,
    /// Sides.
    pub size_mm: Option<DVec3>,
    /// Polarization in its own frame.
    pub polarization_t: Option<DVec3>,
}
