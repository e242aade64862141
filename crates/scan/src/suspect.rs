//! The tile that most likely has another strength than the others, such as a reversed tile.

use glam::{DMat3, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{IronPlanes, PointErrors, Quantity, Tile};
use rayon::prelude::*;

use crate::diagnosis::STRENGTH_ERRORS;
use crate::parameters::FreeParameters;
use crate::scan_columns::{ScanColumns, column};

/// The tile before flat `iron` that with another strength explains most of the difference between
/// `field_t` and the field of `tiles` at `places`, and the error of its strength: -2 for a reversed
/// tile. Strength, offset, rotation and start of the scan explain what they can to first order.
/// Values that are not finite are not used. `None` if no tile explains a difference with a strength
/// that tiles have.
///
/// # Errors
/// For places without a field.
///
/// # Panics
/// If the numbers of places and values differ, or a tile reaches into the iron.
pub fn suspect_strength(
    tiles: &[Tile],
    iron: &IronPlanes,
    places: &[DVec3],
    field_t: &[DVec3],
) -> Result<Option<(usize, f64)>, PointErrors> {
    assert_eq!(places.len(), field_t.len(), "one value per place");
    let (places, field_t): (Vec<DVec3>, Vec<DVec3>) =
        places.iter().zip(field_t).filter(|(_, field_t)| field_t.is_finite()).unzip();
    let scene_of = |tiles: &[Tile]| Scene::new(tiles).with_planes(iron).expect("tiles before the iron");
    let scene = scene_of(tiles);
    let ordered_t = scene.field_at(Quantity::FluxDensity, &places)?;
    let gradient = scene.gradient_at(Quantity::FluxDensity, &places)?;
    let scan = ScanColumns::new(&ordered_t, &gradient, DMat3::IDENTITY, FreeParameters::ALL);
    let difference = scan.unexplained(column(field_t.iter().zip(&ordered_t).map(|(read_t, of_t)| *read_t - *of_t)));
    let explained = |(index, tile): (usize, &Tile)| -> Result<Option<(f64, usize, f64)>, PointErrors> {
        let own_t = scene_of(std::slice::from_ref(tile)).field_at(Quantity::FluxDensity, &places)?;
        let own = scan.unexplained(column(own_t.into_iter()));
        let (product, square) = (own.dot(&difference), own.norm_squared());
        let error = product / square;
        Ok(STRENGTH_ERRORS.contains(&error).then_some((product * error, index, error)))
    };
    let all: Vec<Option<(f64, usize, f64)>> =
        tiles.par_iter().enumerate().map(explained).collect::<Result<_, PointErrors>>()?;
    let best = all.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0));
    Ok(best.map(|(_, tile, error)| (tile, error)))
}
