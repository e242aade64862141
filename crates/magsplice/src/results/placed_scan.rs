//! Whether the sensor of a scan was where it is stated, before errors of tiles are searched.

use std::cell::OnceCell;

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{IronPlanes, Quantity, Tile};
use magsplice_scan::{
    FilmTurn, FreeParameters, ScanError, ScanFit, ScanParameters, film_turn, fit_determined, fit_scan, suspect_strength,
};

use super::placement::{FittedScan, SensorPlacement, is_across};
use crate::film_error::FilmError;

/// Square of the residual beyond the noise with another placement of the sensor, over the same with
/// errors of tiles, below which the placement is the explanation.
const EXPLAINED: f64 = 0.25;

/// Residual of the film as ordered over the root mean square of the readings above which another
/// placement is tried before errors of tiles. It is believed only if it explains most of the
/// residual.
const MISPLACED: f64 = 0.1;

/// The same above which errors of tiles explain no scan, if none are expected. Errors of all tiles
/// of films made by hand leave a tenth, 3 mm below.
const HOPELESS: f64 = 0.2;

/// Largest number of tiles of another strength that are searched before the sensor is placed. More
/// of them are searched beside all other errors.
const MOST_SUSPECTS: usize = 3;

/// A scan of the field of a film. Readings that are not used are NaN.
pub(super) struct PlacedScan<'a> {
    tiles: &'a [Tile],
    iron: &'a IronPlanes,
    /// The film as ordered, but for tiles of another strength that the scan shows by themselves.
    film: Scene,
    points_mm: &'a [DVec3],
    field_t: &'a [DVec3],
    /// Square of the noise of a component.
    noise_squared: f64,
    /// Where the middle of the scan is likely.
    centre_mm: Option<DVec3>,
    /// Whether errors of tiles are expected. Some leave large residuals, which another placement
    /// explains in part: it is then believed only where the diagnosis is rejected.
    expects_errors: bool,
    /// The fit of this film, once it is needed.
    determined: OnceCell<Option<ScanFit>>,
}

/// Tiles as ordered but for their strength, before the iron of the layout.
fn scene(tiles: &[Tile], iron: &IronPlanes) -> Scene {
    Scene::new(tiles).with_planes(iron).expect("tiles before the iron, as the layout requires")
}

impl<'a> PlacedScan<'a> {
    /// The scan of a film that has these tiles as ordered, before iron.
    ///
    /// # Errors
    /// [`FilmError::Scan`] for positions or readings in another unit, and [`FilmError::Points`] for
    /// points without a field.
    pub(super) fn new(
        (tiles, iron): (&'a [Tile], &'a IronPlanes),
        points_mm: &'a [DVec3],
        field_t: &'a [DVec3],
        noise_t: DVec3,
        centre_mm: Option<DVec3>,
        expects_errors: bool,
    ) -> Result<PlacedScan<'a>, FilmError> {
        let (film, noise_squared) = (scene(tiles, iron), noise_t.length_squared() / 3.0);
        let determined = OnceCell::new();
        let ordered =
            PlacedScan { tiles, iron, film, points_mm, field_t, noise_squared, centre_mm, expects_errors, determined };
        ordered.with_suspects()
    }

    /// The scan with tiles of another strength, each of which explains most of what the placement
    /// of the sensor leaves. Without them the placement would explain a part of their field.
    fn with_suspects(mut self) -> Result<PlacedScan<'a>, FilmError> {
        let mut tiles = self.tiles.to_vec();
        let mut excess = self.excess()?;
        for _ in 0..MOST_SUSPECTS {
            if excess.is_none() {
                break;
            }
            let suspect =
                suspect_strength(&tiles, self.iron, self.points_mm, self.field_t).map_err(FilmError::Points)?;
            let Some((index, error)) = suspect else { break };
            let of = tiles[index];
            let changed = Tile::new(of.position(), of.size(), (1.0 + error) * of.polarization_t());
            let Ok(changed) = changed.and_then(|changed| changed.rotated(of.rotation())) else { break };
            tiles[index] = changed;
            let changed = scene(&tiles, self.iron);
            let before = (std::mem::replace(&mut self.film, changed), std::mem::take(&mut self.determined));
            let left = self.excess()?;
            if left.unwrap_or(0.0) > EXPLAINED * excess.unwrap_or(f64::INFINITY) {
                (self.film, self.determined) = before;
                break;
            }
            excess = left;
        }
        Ok(self)
    }

    /// Square of the residual beyond the noise with the placement that fits best; `None` if it is
    /// noise or a small part of the readings, or if the stated placement is not possible.
    fn excess(&self) -> Result<Option<f64>, FilmError> {
        let Ok([residual_t, reading_t]) = self.medians(&ScanParameters::PERFECT) else { return Ok(None) };
        if residual_t <= MISPLACED * reading_t {
            return Ok(None);
        }
        let fitted_t = self.determined()?.map_or(residual_t, |fit| fit.noise_t.min(residual_t));
        let excess = fitted_t.powi(2) - self.noise_squared;
        Ok((fitted_t > MISPLACED * reading_t && excess > 0.0).then_some(excess))
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
            _ => in_stated_units(fit_scan(&self.film, self.points_mm, self.field_t, free, self.centre_mm))?,
        };
        if let Some(fit) = fit.as_ref().filter(|fit| self.is_otherwise(fit)) {
            let determined = self.determined()?;
            return Err(self.misplaced(determined.as_ref().unwrap_or(fit))?);
        }
        let start = fit.map_or(ScanParameters::PERFECT, |fit| fit.parameters);
        let medians =
            self.medians(&start).or_else(|error| match self.determined()?.filter(|fit| self.is_otherwise(fit)) {
                Some(fit) => Err(self.misplaced(&fit)?),
                None => Err(error),
            });
        let [residual_t, reading_t] = medians?;
        let other = (residual_t > MISPLACED * reading_t).then(|| self.explaining_fit(residual_t)).transpose()?;
        match other.flatten().filter(|fit| !self.expects_errors || self.is_otherwise(fit)) {
            Some(fit) => Err(self.misplaced(&fit)?),
            None if residual_t > HOPELESS * reading_t && !self.expects_errors => {
                self.refuse_turned()?;
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

    /// The error of a scan that another placement of the sensor explains, or else a turn of the
    /// film, which looks like another placement.
    fn misplaced(&self, fit: &ScanFit) -> Result<FilmError, FilmError> {
        self.refuse_turned()?;
        Ok(FilmError::Misplaced(Box::new(self.placement(fit))))
    }

    /// # Errors
    /// [`FilmError::Scan`] if a turn of the film against the positions explains the scan.
    pub(super) fn refuse_turned(&self) -> Result<(), FilmError> {
        let [_, reading_t] = self.medians(&ScanParameters::PERFECT)?;
        let residual_t = self.determined()?.map_or(HOPELESS * reading_t, |fit| fit.noise_t);
        match self.turn().filter(|turn| turn.explains(residual_t)) {
            Some(turn) => Err(FilmError::Scan(ScanError::Turned(turn))),
            None => Ok(()),
        }
    }

    /// The turn of the film against the positions that explains the scan best.
    pub(super) fn turn(&self) -> Option<FilmTurn> {
        film_turn(&self.film, self.points_mm, self.field_t)
    }

    fn placement(&self, fit: &ScanFit) -> SensorPlacement {
        SensorPlacement::new(fit, self.noise_squared.sqrt(), self.is_across(fit))
    }

    /// The fit as a scan states it, with the strength held where errors of tiles look like it.
    fn determined(&self) -> Result<Option<ScanFit>, FilmError> {
        if let Some(fit) = self.determined.get() {
            return Ok(fit.clone());
        }
        let fit = fit_determined(&self.film, self.points_mm, self.field_t, self.centre_mm);
        let fit = in_stated_units(fit.map(|(fit, _)| fit))?;
        Ok(self.determined.get_or_init(|| fit).clone())
    }

    /// The placement of the sensor that explains the scan, if it leaves much less than a residual.
    ///
    /// # Errors
    /// [`FilmError::Scan`] for positions or readings in another unit.
    pub(super) fn explaining(&self, residual_t: f64) -> Result<Option<SensorPlacement>, FilmError> {
        Ok(self.explaining_fit(residual_t)?.map(|fit| self.placement(&fit)))
    }

    fn explaining_fit(&self, residual_t: f64) -> Result<Option<ScanFit>, FilmError> {
        let excess = |residual_t: f64| residual_t.powi(2) - self.noise_squared;
        let explains = |fit: &ScanFit| excess(fit.noise_t) < EXPLAINED * excess(residual_t);
        Ok(self.determined()?.filter(explains))
    }

    /// Residual and reading of one component, in tesla, from the medians of their squares, in which
    /// a few wild readings do not count.
    fn medians(&self, start: &ScanParameters) -> Result<[f64; 2], FilmError> {
        let places: Vec<DVec3> = self.points_mm.iter().map(|point| *point + start.start).collect();
        let ordered_t = self.film.field_at(Quantity::FluxDensity, &places).map_err(FilmError::Points)?;
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
