//! Whether the sensor of a scan was where it is stated, before errors of tiles are searched.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{Quantity, Tile};
use magsplice_scan::{FreeParameters, ScanError, ScanFit, ScanParameters, fit_determined, fit_scan};

use super::placement::{FittedScan, SensorPlacement, is_across};
use crate::film_error::FilmError;

/// Square of the residual beyond the noise with another placement of the sensor, over the same with
/// errors of tiles, below which the placement is the explanation.
const EXPLAINED: f64 = 0.25;

/// Residual of the film as ordered over the root mean square of the readings above which another
/// placement is tried before errors of tiles. It is believed only if it explains most of the
/// residual.
const MISPLACED: f64 = 0.1;

/// The same above which errors of tiles explain no scan. Errors of all tiles of films made by hand
/// leave a tenth.
const HOPELESS: f64 = 0.2;

/// Share of the squared residual that one tile explains if it is faulty in a film of few tiles.
const ONE_TILE: f64 = 0.5;

/// A scan of the field of a film as ordered. Readings that are not used are NaN.
pub(super) struct PlacedScan<'a> {
    tiles: &'a [Tile],
    ordered: &'a Scene,
    points_mm: &'a [DVec3],
    field_t: &'a [DVec3],
    /// Square of the noise of a component.
    noise_squared: f64,
    /// Where the middle of the scan is likely.
    centre_mm: Option<DVec3>,
}

impl<'a> PlacedScan<'a> {
    /// `ordered` is the scene of the tiles.
    pub(super) fn new(
        tiles: &'a [Tile],
        ordered: &'a Scene,
        points_mm: &'a [DVec3],
        field_t: &'a [DVec3],
        noise_t: DVec3,
        centre_mm: Option<DVec3>,
    ) -> PlacedScan<'a> {
        PlacedScan { tiles, ordered, points_mm, field_t, noise_squared: noise_t.length_squared() / 3.0, centre_mm }
    }

    /// The parameters of the film as ordered, of which `free` are fitted; those of a perfect scan
    /// where faulty tiles do not let them be fitted.
    ///
    /// # Errors
    /// [`FilmError::Misplaced`] for a scan that another placement of the sensor explains,
    /// [`FilmError::Scan`] for a scan of another film, and [`FilmError::Points`] for points without
    /// a field.
    pub(super) fn start(&self, free: FreeParameters) -> Result<ScanParameters, FilmError> {
        let fit = match free {
            FreeParameters::NONE => None,
            FreeParameters::ALL => self.determined()?,
            _ => in_stated_units(fit_scan(self.ordered, self.points_mm, self.field_t, free, self.centre_mm))?,
        };
        if let Some(fit) = fit.as_ref().filter(|fit| self.is_otherwise(fit)) {
            let determined = self.determined()?;
            return Err(FilmError::Misplaced(Box::new(self.placement(determined.as_ref().unwrap_or(fit)))));
        }
        let start = fit.map_or(ScanParameters::PERFECT, |fit| fit.parameters);
        let medians =
            self.medians(&start).or_else(|error| match self.determined()?.filter(|fit| self.is_otherwise(fit)) {
                Some(fit) => Err(FilmError::Misplaced(Box::new(self.placement(&fit)))),
                None => Err(error),
            });
        let [residual_t, reading_t] = medians?;
        let placement = (residual_t > MISPLACED * reading_t).then(|| self.explaining(residual_t)).transpose()?;
        match placement.flatten() {
            Some(placement) => Err(FilmError::Misplaced(Box::new(placement))),
            None if residual_t > HOPELESS * reading_t && !self.is_of_one_tile(&start)? => {
                Err(FilmError::Scan(ScanError::Misfit { residual_t, reading_t }))
            }
            None => Ok(start),
        }
    }

    /// Whether the sensor had other axes, those of a rotation too, or was on the other side of the
    /// film, or the film has a strength that this film hardly has.
    fn is_otherwise(&self, fit: &ScanFit) -> bool {
        let placement = FittedScan::new(&fit.parameters, fit.offset_t());
        !fit.has_stated_axes()
            || placement.rotated_axes().is_some()
            || placement.implausible_strength().is_some()
            || self.is_across(fit)
    }

    fn is_across(&self, fit: &ScanFit) -> bool {
        let places_mm: Vec<DVec3> = self.points_mm.iter().map(|point| fit.place(*point)).collect();
        is_across(self.tiles, self.centre_mm, &places_mm)
    }

    fn placement(&self, fit: &ScanFit) -> SensorPlacement {
        SensorPlacement::new(fit, self.is_across(fit))
    }

    /// The fit as a scan states it, with the strength held where errors of tiles look like it.
    fn determined(&self) -> Result<Option<ScanFit>, FilmError> {
        let fit = fit_determined(self.ordered, self.points_mm, self.field_t, self.centre_mm);
        in_stated_units(fit.map(|(fit, _)| fit))
    }

    /// The placement of the sensor that explains the scan, if it leaves much less than a residual.
    ///
    /// # Errors
    /// [`FilmError::Scan`] for positions or readings in another unit.
    pub(super) fn explaining(&self, residual_t: f64) -> Result<Option<SensorPlacement>, FilmError> {
        let excess = |residual_t: f64| residual_t.powi(2) - self.noise_squared;
        let explains = |fit: &ScanFit| excess(fit.noise_t) < EXPLAINED * excess(residual_t);
        Ok(self.determined()?.filter(explains).map(|fit| self.placement(&fit)))
    }

    /// Whether another strength of one tile, such as a reversed one, explains half of the residual.
    fn is_of_one_tile(&self, start: &ScanParameters) -> Result<bool, FilmError> {
        let places: Vec<DVec3> = self.points_mm.iter().map(|point| *point + start.start).collect();
        let read_t = |scene: &Scene| -> Result<Vec<DVec3>, FilmError> {
            let field_t = scene.field_at(Quantity::FluxDensity, &places).map_err(FilmError::Points)?;
            let of = field_t.into_iter().map(|b| start.reading_t(b) - start.offset_t);
            Ok(of.zip(self.field_t).map(|(of, read)| if read.is_finite() { of } else { DVec3::ZERO }).collect())
        };
        let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
        let ordered_t = read_t(self.ordered)?;
        let residual = |(read, of): (&DVec3, &DVec3)| {
            if read.is_finite() { *read - start.offset_t - *of } else { DVec3::ZERO }
        };
        let residuals_t: Vec<DVec3> = self.field_t.iter().zip(&ordered_t).map(residual).collect();
        let all = dot(&residuals_t, &residuals_t);
        for tile in self.tiles {
            let of_tile = read_t(&Scene::new(std::slice::from_ref(tile)))?;
            if dot(&residuals_t, &of_tile).powi(2) > ONE_TILE * all * dot(&of_tile, &of_tile) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Residual and reading of one component, in tesla, from the medians of their squares, in which
    /// a few wild readings do not count.
    fn medians(&self, start: &ScanParameters) -> Result<[f64; 2], FilmError> {
        let places: Vec<DVec3> = self.points_mm.iter().map(|point| *point + start.start).collect();
        let ordered_t = self.ordered.field_at(Quantity::FluxDensity, &places).map_err(FilmError::Points)?;
        let used = self.field_t.iter().zip(ordered_t).filter(|(read_t, _)| read_t.is_finite());
        let (mut residuals, mut readings): (Vec<f64>, Vec<f64>) = used
            .map(|(read_t, of_t)| {
                let residual = *read_t - start.reading_t(of_t);
                (residual.length_squared() / 3.0, (*read_t - start.offset_t).length_squared() / 3.0)
            })
            .unzip();
        Ok([&mut residuals, &mut readings].map(|squares| {
            squares.sort_by(f64::total_cmp);
            squares.get(squares.len() / 2).map_or(0.0, |square| square.sqrt())
        }))
    }
}

/// A fit, if there is one.
///
/// # Errors
/// [`FilmError::Scan`] for positions or readings in another unit.
fn in_stated_units(fit: Result<ScanFit, ScanError>) -> Result<Option<ScanFit>, FilmError> {
    match fit {
        Err(error @ (ScanError::Unit { .. } | ScanError::ReadingUnit { .. })) => Err(FilmError::Scan(error)),
        fit => Ok(fit.ok()),
    }
}
