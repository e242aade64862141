//! One file per figure.

pub(crate) mod along_axes;
pub(crate) mod field_maps;
pub(crate) mod front;
pub(crate) mod layout_from_above;
mod layout_key;
pub(crate) mod parameter_maps;
pub(crate) mod vectors;

use glam::DVec3;
use magsplice::layout::NamedTile;

/// More tiles than this are not drawn: a viewer would need minutes. Those nearest to where the film is used are.
pub(crate) const MOST_TILES: usize = 20_000;

pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// The tiles to draw: all, or the nearest to a point.
pub(crate) fn drawn_tiles(tiles: &[NamedTile], centre: DVec3) -> Vec<&NamedTile> {
    let mut drawn: Vec<&NamedTile> = tiles.iter().collect();
    if drawn.len() > MOST_TILES {
        let distance = |named: &&NamedTile| named.tile.position().truncate().distance_squared(centre.truncate());
        drawn.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        drawn.truncate(MOST_TILES);
    }
    drawn
}
