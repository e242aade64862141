//! Displacement errors as linear functions of J and of the sides of each tile.

use glam::DVec3;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Axis, Tile, TileError};
use rayon::prelude::*;

use super::displacement::{Displacement, OMITTED, displacement_errors_mm};
use super::tile_response::TileResponse;
use crate::evaluation_grid::{EvaluationGrid, SampleError};
use crate::low_rank::{LowRank, dot};
use crate::real_film::RealFilm;
use crate::sampler::{exact_field_t, with_remainder_t};

/// Change of J, as a fraction of it, for which few coordinates suffice: the spread of magnets from
/// a shop.
const USUAL_CHANGE: f64 = 0.03;

/// Change of a side for which few coordinates suffice, in millimetres.
const USUAL_SIZE_MM: f64 = 0.02;

/// The displacement errors of a film as linear functions of J and the sides of each tile, in its
/// frame.
///
/// A few coordinates c represent displacement errors. Their root mean square over all points and
/// axes is |c| over the root of the number of errors. The coordinates leave out 1e-4 of the errors
/// of a film whose tiles are wrong by 3 % of J and 0.02 mm in size.
///
/// # Units
/// Millimetres, and tesla.
#[derive(Clone, Debug)]
pub struct TileChanges {
    film: RealFilm,
    points: Vec<DVec3>,
    /// The part of the field that the mean polarizations leave out, at each point; empty without
    /// recoil.
    remainder_t: Vec<DVec3>,
    ideal: IdealFilm,
    basis: Vec<Vec<f64>>,
    nominal: Vec<f64>,
    /// For each tile: by J along its x, y, z, then by its sides.
    by_tile: Vec<[Vec<f64>; 6]>,
}

impl TileChanges {
    /// The model of a film in a working volume. The tolerance of the film is ignored.
    ///
    /// # Errors
    /// If the parameters or the derivatives do not exist at a point of the volume.
    pub fn new(film: &RealFilm, volume: &EvaluationGrid, ideal: &IdealFilm) -> Result<TileChanges, SampleError> {
        let points: Vec<DVec3> = volume.grid.points().chain([volume.reference]).collect();
        let remainder_t = match film.weakening() {
            Some(weakening) => exact_field_t(weakening.remainder(), &points)?,
            None => Vec::new(),
        };
        let tiles = film.tiles();
        let scene = film.scene(tiles).map_err(SampleError::Tile)?;
        let film_t = with_remainder_t(&scene, &points, &remainder_t)?;
        let in_film = film.in_film(tiles).map_err(SampleError::Tile)?;
        let nominal = displacement_errors_mm(&points, &film_t, ideal)?;
        let displacement = Displacement::new(&points, &film_t, ideal)?;
        let of_tile = |(number, tile): (usize, &Tile)| -> Result<Vec<Vec<f64>>, SampleError> {
            let response = TileResponse::in_film(film, number, &in_film[number], &points)?;
            let [j_scale, size_scale] = scales(tile);
            let column = |component: usize| {
                let mut changes_t = vec![DVec3::ZERO; points.len()];
                if component < 3 {
                    let own_t = DVec3::AXES[component];
                    let in_film_t = film.weakening().map_or(own_t, |weakening| weakening.change_t(number, own_t));
                    response.add_polarization_change(in_film_t, &mut changes_t);
                } else {
                    let error = TileError::Size(Axis::ALL[component - 3]);
                    response.add_derivative(error, tile.position(), &mut changes_t);
                }
                let scale = if component < 3 { j_scale } else { size_scale };
                displacement.changes_mm(&changes_t).into_iter().map(|change| scale * change).collect()
            };
            Ok((0..6).map(column).collect())
        };
        let columns = tiles.par_iter().enumerate().map(of_tile).collect::<Result<Vec<_>, _>>()?;
        let reduced = LowRank::new(std::iter::once(nominal).chain(columns.into_iter().flatten()).collect(), OMITTED);
        let mut coordinates = reduced.coordinates.into_iter();
        let nominal = coordinates.next().unwrap_or_default();
        let by_tile = tiles
            .iter()
            .map(|tile| {
                let scales = scales(tile);
                std::array::from_fn(|component| {
                    let scale = scales[component / 3];
                    let of_component = coordinates.next().unwrap_or_default();
                    of_component.into_iter().map(|value| if scale > 0.0 { value / scale } else { 0.0 }).collect()
                })
            })
            .collect();
        let film = film.clone();
        Ok(TileChanges { film, points, remainder_t, ideal: *ideal, basis: reduced.basis, nominal, by_tile })
    }

    /// Coordinates of the displacement errors of the film itself.
    pub fn nominal(&self) -> &[f64] {
        &self.nominal
    }

    /// Coordinates of the change of the displacement errors by J of a tile in its own frame, in
    /// tesla, and by its sides, in millimetres.
    pub fn change(&self, tile: usize, polarization_t: DVec3, size_mm: DVec3) -> Vec<f64> {
        let factors = [polarization_t, size_mm].into_iter().flat_map(|vector| vector.to_array());
        let mut sum = vec![0.0; self.nominal.len()];
        for (factor, column) in factors.zip(&self.by_tile[tile]) {
            sum.iter_mut().zip(column).for_each(|(sum, value)| *sum += factor * value);
        }
        sum
    }

    /// Coordinates of the displacement errors of other tiles, by the exact field.
    ///
    /// # Errors
    /// If the parameters do not exist at a point of the volume.
    pub fn exact(&self, tiles: &[Tile]) -> Result<Vec<f64>, SampleError> {
        let errors_mm = self.exact_errors_mm(tiles)?;
        Ok(self.basis.iter().map(|column| dot(column, &errors_mm)).collect())
    }

    /// The root mean square over all points and axes of the displacement errors of other tiles, by
    /// the exact field, in mm. Nothing is left out.
    ///
    /// # Errors
    /// If the parameters do not exist at a point of the volume.
    pub fn exact_rms_mm(&self, tiles: &[Tile]) -> Result<f64, SampleError> {
        Ok(self.rms_mm(&self.exact_errors_mm(tiles)?))
    }

    fn exact_errors_mm(&self, tiles: &[Tile]) -> Result<Vec<f64>, SampleError> {
        let scene = self.film.scene(tiles).map_err(SampleError::Tile)?;
        let film_t = with_remainder_t(&scene, &self.points, &self.remainder_t)?;
        displacement_errors_mm(&self.points, &film_t, &self.ideal)
    }

    /// The root mean square over all points and axes of displacement errors with these coordinates,
    /// in mm.
    pub fn rms_mm(&self, coordinates: &[f64]) -> f64 {
        let errors = 3 * (self.points.len() - 1);
        (dot(coordinates, coordinates) / errors as f64).sqrt()
    }
}

/// Usual changes of a component of J and of a side.
fn scales(tile: &Tile) -> [f64; 2] {
    [USUAL_CHANGE * tile.polarization_t().length(), USUAL_SIZE_MM]
}

#[cfg(test)]
mod tests {
    use magsplice_layout::{FilmTolerance, Layout};
    use magsplice_magnet::{IronPlane, IronPlanes};

    use super::*;

    /// Alone, and before a back plate 1 mm above the film.
    #[test]
    fn changes_are_those_of_the_exact_field() {
        let plate = IronPlane::new(2.0 * DVec3::Z, -DVec3::Z, 100.0).unwrap();
        for iron in [IronPlanes::default(), IronPlanes::new(vec![plate]).unwrap()] {
            check_changes(&iron);
        }
    }

    /// The remainder falls as the square of the changes: to a sixteenth for a quarter of them.
    fn check_changes(iron: &IronPlanes) {
        let layout = Layout::read("../../layouts/designed-stock.toml").unwrap_or_else(|e| panic!("{e}"));
        let volume = layout.volume.unwrap();
        let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
        let tiles = layout.bare_tiles();
        let film = RealFilm::new(&tiles, &FilmTolerance::default()).with_iron(iron.clone());
        let model = TileChanges::new(&film, &volume, &layout.ideal.unwrap()).unwrap();
        assert!(model.nominal().len() < 80, "{}", model.nominal().len());
        let nominal = model.rms_mm(&model.exact(&tiles).unwrap());
        assert!((nominal - model.rms_mm(model.nominal())).abs() < 1e-9, "{nominal}");
        // The coordinates leave out 1e-4 of the errors.
        assert!((model.exact_rms_mm(&tiles).unwrap() / nominal - 1.0).abs() < 1e-4, "{nominal}");
        let omitted = |scale: f64| {
            let (mut changed, mut linear) = (tiles.clone(), model.nominal().to_vec());
            for (number, tile) in tiles.iter().enumerate() {
                let wave = |n: usize| scale * ((3 * number + n) as f64).sin();
                let j_t = tile.polarization_t().length() * DVec3::new(wave(1), wave(2), wave(3));
                let size_mm = DVec3::new(wave(4), wave(5), wave(6));
                changed[number] =
                    Tile::new(tile.position(), tile.size() + size_mm, tile.polarization_t() + j_t).unwrap();
                linear.iter_mut().zip(model.change(number, j_t, size_mm)).for_each(|(sum, change)| *sum += change);
            }
            let exact = model.exact(&changed).unwrap();
            let difference: Vec<f64> = exact.iter().zip(&linear).map(|(a, b)| a - b).collect();
            (model.rms_mm(&difference), model.rms_mm(&exact))
        };
        let ((much, change), (little, _)) = (omitted(0.01), omitted(0.0025));
        assert!(much < 0.03 * change && (14.0..18.0).contains(&(much / little)), "{much} of {change}, {little}");
    }
}
