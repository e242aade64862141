//! Cells with their polarization, and the change of each tile.

use glam::DVec3;
use magsplice_magnet::Tile;

use crate::division::Division;
use crate::error::RecoilError;
use crate::material::RecoilTile;

/// Cells with the polarization consistent with their field; or those of two divisions, one after
/// the other, whose polarizations times weights add up to an extrapolated one.
#[derive(Clone, Debug, PartialEq)]
pub struct Magnetization {
    tiles: Vec<RecoilTile>,
    cells: Vec<Tile>,
    owners: Vec<usize>,
    /// Of each cell of the first division.
    fields_t: Vec<DVec3>,
    /// Weight of the first division.
    weight: f64,
}

/// The change of the polarization of one tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileChange {
    /// Mean polarization in the frame of the scene, in tesla.
    pub mean_polarization_t: DVec3,
    /// Lost fraction of the magnitude of J_r: 0.04 for a tile that is 4 % weaker; 0 without J_r.
    pub weakening: f64,
    /// Angle between the mean polarization and J_r in radians; 0 if one of them is 0.
    pub angle: f64,
}

impl Magnetization {
    /// Cells from J_r and the additions of the field, in the frame of the scene.
    pub(crate) fn new(
        tiles: &[RecoilTile],
        division: Division,
        induced_t: &[DVec3],
        fields_t: Vec<DVec3>,
    ) -> Result<Magnetization, RecoilError> {
        let Division { mut cells, owners, .. } = division;
        for ((cell, owner), induced_t) in cells.iter_mut().zip(&owners).zip(induced_t) {
            let polarization_t = cell.polarization_t() + cell.rotation().inverse() * *induced_t;
            *cell = Tile::new(cell.position(), cell.size(), polarization_t)
                .and_then(|new| new.rotated(cell.rotation()))
                .map_err(|source| RecoilError::Cell { tile: *owner, source })?;
        }
        Ok(Magnetization { tiles: tiles.to_vec(), cells, owners, fields_t, weight: 1.0 })
    }

    /// The polarization of this solution times `weight` and of a coarser one times the rest: the
    /// cells of both.
    pub(crate) fn extrapolated_from(&self, coarser: &Magnetization, weight: f64) -> Magnetization {
        let scaled = |cells: &[Tile], weight: f64| -> Vec<Tile> {
            cells.iter().map(|cell| with_polarization(cell, weight * cell.scene_polarization_t())).collect()
        };
        Magnetization {
            cells: [scaled(&self.cells, weight), scaled(&coarser.cells, 1.0 - weight)].concat(),
            owners: [&self.owners[..], &coarser.owners].concat(),
            weight,
            ..self.clone()
        }
    }

    /// The tiles with their polarization J_r.
    pub fn tiles(&self) -> &[RecoilTile] {
        &self.tiles
    }

    /// The cells as tiles with their polarization J, for `magsplice_field::Scene`. The cells of two
    /// divisions overlap: J at a point is the sum over both.
    pub fn cells(&self) -> &[Tile] {
        &self.cells
    }

    /// The index of the tile of each cell.
    pub fn owners(&self) -> &[usize] {
        &self.owners
    }

    /// The mean of mu0 H over each cell of the first division, in the frame of the scene, in tesla.
    pub fn fields_t(&self) -> &[DVec3] {
        &self.fields_t
    }

    /// The change of each tile.
    pub fn tile_changes(&self) -> Vec<TileChange> {
        let mut sums = vec![DVec3::ZERO; self.tiles.len()];
        for (cell, owner) in self.cells.iter().zip(&self.owners) {
            let share = (cell.size() / self.tiles[*owner].tile.size()).element_product();
            sums[*owner] += share * cell.scene_polarization_t();
        }
        self.tiles.iter().zip(sums).map(|(of, mean)| TileChange::new(of.tile.scene_polarization_t(), mean)).collect()
    }

    /// The tiles, each with the mean polarization of its cells.
    pub fn mean_tiles(&self) -> Vec<Tile> {
        let tiles = self.tiles.iter().zip(self.tile_changes());
        tiles.map(|(each, change)| with_polarization(&each.tile, change.mean_polarization_t)).collect()
    }

    /// The cells with the deviation of their polarization from the mean of their tile. Their field
    /// is missing from the field of [`mean_tiles`](Magnetization::mean_tiles).
    pub fn deviations(&self) -> Vec<Tile> {
        let changes = self.tile_changes();
        let cells = self.cells.iter().zip(&self.owners).enumerate();
        cells
            .map(|(index, (cell, owner))| {
                let weight = if index < self.fields_t.len() { self.weight } else { 1.0 - self.weight };
                with_polarization(cell, cell.scene_polarization_t() - weight * changes[*owner].mean_polarization_t)
            })
            .collect()
    }
}

/// A tile with another polarization, in the frame of the scene.
fn with_polarization(tile: &Tile, scene_t: DVec3) -> Tile {
    let own_t = tile.rotation().inverse() * scene_t;
    let new = Tile::new(tile.position(), tile.size(), own_t).and_then(|new| new.rotated(tile.rotation()));
    new.expect("means and differences of valid polarizations")
}

impl TileChange {
    fn new(rigid_t: DVec3, mean_polarization_t: DVec3) -> TileChange {
        let (before, after) = (rigid_t.length(), mean_polarization_t.length());
        let weakening = if before > 0.0 { 1.0 - after / before } else { 0.0 };
        let angle = rigid_t.cross(mean_polarization_t).length().atan2(rigid_t.dot(mean_polarization_t));
        TileChange { mean_polarization_t, weakening, angle }
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use magsplice_magnet::{IronPlanes, Permeability};

    use super::*;

    /// The field of the cells is the sum of the fields of the means and of the deviations.
    #[test]
    fn means_and_deviations_make_the_field() {
        let permeability = Permeability::isotropic(1.2).unwrap();
        let turned = Tile::new(DVec3::new(1.6, 0.2, 0.1), DVec3::new(1.0, 2.0, 0.5), DVec3::new(0.3, 0.9, -0.2));
        let turned = turned.unwrap().rotated(DQuat::from_rotation_z(0.4)).unwrap();
        let tiles = [Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::Z).unwrap(), turned];
        let tiles = tiles.map(|tile| RecoilTile { tile, permeability });
        let solution = Magnetization::solve(&tiles, &IronPlanes::default(), 2, |_| {}).unwrap();
        let points = [DVec3::new(0.3, 0.2, -1.5), DVec3::new(-2.0, 1.0, 0.4)];
        let field_t = |tiles: &[Tile]| {
            let scene = magsplice_field::Scene::new(tiles);
            scene.field_at(magsplice_magnet::Quantity::FluxDensity, &points).unwrap()
        };
        let (all, means) = (field_t(solution.cells()), field_t(&solution.mean_tiles()));
        for ((all, mean), deviation) in all.into_iter().zip(means).zip(field_t(&solution.deviations())) {
            assert!((all - mean - deviation).length() <= 1e-14, "{all} {mean} {deviation}");
            assert!(deviation.length() > 1e-5);
        }
        let changes = solution.tile_changes();
        for (mean, change) in solution.mean_tiles().iter().zip(changes) {
            assert!((mean.scene_polarization_t() - change.mean_polarization_t).length() <= 1e-15);
        }
    }
}
