//! Cells whose working point is beyond the knee of the demagnetization curve.

use crate::magnetization::Magnetization;

/// A cell whose field drives it beyond the knee. Its recoil line no longer holds: it loses
/// polarization permanently.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DemagnetizedCell {
    /// Index of the cell.
    pub cell: usize,
    /// Index of the tile.
    pub tile: usize,
    /// mu0 H along the easy axis in tesla; negative against the polarization.
    pub field_t: f64,
}

impl Magnetization {
    /// mu0 H of each cell of the first division along the easy axis of its tile, in tesla; `None`
    /// for tiles without polarization.
    pub fn fields_along_easy_axis_t(&self) -> Vec<Option<f64>> {
        let axes: Vec<_> = self.tiles().iter().map(|each| each.easy_axis()).collect();
        self.owners().iter().zip(self.fields_t()).map(|(owner, h_t)| Some(axes[*owner]?.dot(*h_t))).collect()
    }

    /// The cells beyond the knee, in their order. `knee_t` is mu0 times the magnitude of the field
    /// at the knee, in tesla: the demagnetization curve is straight for fields along the easy axis
    /// above `-knee_t`. Data sheets give it for each grade and temperature.
    ///
    /// The field is the mean over a cell. It is larger at edges of tiles, so a finer level finds
    /// more cells with less volume.
    pub fn beyond_knee(&self, knee_t: f64) -> Vec<DemagnetizedCell> {
        let cells = self.fields_along_easy_axis_t().into_iter().zip(self.owners()).enumerate();
        cells
            .filter_map(|(cell, (field_t, tile))| {
                let field_t = field_t?;
                (field_t < -knee_t).then_some(DemagnetizedCell { cell, tile: *tile, field_t })
            })
            .collect()
    }

    /// The share of the volume of all tiles beyond the knee.
    pub fn share_beyond_knee(&self, knee_t: f64) -> f64 {
        let volume = |cell: usize| self.cells()[cell].size().element_product();
        let total: f64 = (0..self.fields_t().len()).map(volume).sum();
        let beyond: f64 = self.beyond_knee(knee_t).iter().map(|found| volume(found.cell)).sum();
        if beyond > 0.0 { beyond / total } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use magsplice_magnet::{IronPlanes, Permeability, Tile};

    use super::*;
    use crate::material::RecoilTile;

    fn cube(x: f64, polarization_t: DVec3) -> RecoilTile {
        let tile = Tile::new(DVec3::new(x, 0.0, 0.0), DVec3::ONE, polarization_t).unwrap();
        RecoilTile { tile, permeability: Permeability::isotropic(1.05).unwrap() }
    }

    /// A cube has mu0 H = -J / 3 and J = J_r 3 / (mu_r + 2). Another cube, magnetized against it
    /// along the line between them, adds to its demagnetizing field.
    #[test]
    fn knee_is_passed_by_the_right_cells() {
        let alone = Magnetization::solve(&[cube(0.0, DVec3::Z)], &IronPlanes::default(), 1, |_| {}).unwrap();
        let [Some(field_t)] = alone.fields_along_easy_axis_t()[..] else { panic!("one cell") };
        assert!((field_t + 1.0 / 3.05).abs() <= 1e-12, "{field_t}");
        assert!(alone.beyond_knee(0.33).is_empty());
        // A sum of no volumes is -0, which would be printed.
        assert!(alone.share_beyond_knee(0.33).is_sign_positive());
        assert_eq!(alone.beyond_knee(0.32), [DemagnetizedCell { cell: 0, tile: 0, field_t }]);
        assert_eq!(alone.share_beyond_knee(0.32), 1.0);
        let tiles = [cube(5.0, DVec3::ZERO), cube(0.0, DVec3::X), cube(1.0, -DVec3::X)];
        let opposed = Magnetization::solve(&tiles, &IronPlanes::default(), 1, |_| {}).unwrap();
        let found = opposed.beyond_knee(0.35);
        assert_eq!(found.iter().map(|cell| cell.tile).collect::<Vec<_>>(), [1, 2]);
        assert!((opposed.share_beyond_knee(0.35) - 2.0 / 3.0).abs() < 1e-15);
        assert_eq!(opposed.fields_along_easy_axis_t()[0], None);
        assert!(opposed.tile_changes()[1].weakening > alone.tile_changes()[0].weakening);
    }
}
