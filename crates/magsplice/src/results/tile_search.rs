//! The search for errors of tiles in a scan: with the errors that the layout expects, with typical
//! errors of every tile instead, and with another placement of the sensor where it is rejected.

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Preset};
use magsplice_magnet::Tile;
use magsplice_scan::{
    Diagnosis, DiagnosisError, DiagnosisSettings, FieldScan, FreeParameters, MOST_ERRORS, ScanDiagnosis, ScanError,
    ScanParameter, ScanParameters,
};

use super::likelier_errors::{MOST_SINGLE_ERRORS, likelier_preset};
use super::placed_scan::PlacedScan;
use super::placement::{FittedScan, SensorPlacement};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// Standard deviations from the stated value above which a parameter of the scan is another one.
const CERTAIN: f64 = 4.0;

/// A scan of the field of a film, and what is searched in it.
pub(super) struct TileSearch<'a> {
    pub(super) film: &'a Film,
    pub(super) tiles: &'a [Tile],
    pub(super) points_mm: &'a [DVec3],
    /// The field that the sensor read, along the axes of the film; NaN for unusable readings.
    pub(super) field_t: &'a [DVec3],
    pub(super) noise_t: DVec3,
    /// Expected errors of tiles and groups.
    pub(super) expected: &'a FilmTolerance,
    pub(super) free: FreeParameters,
    pub(super) false_alarm: f64,
}

/// What a search found.
pub(super) struct Searched {
    pub(super) diagnosis: Diagnosis,
    /// See [`FilmDiagnosis`](super::diagnosis::FilmDiagnosis), as the next ones.
    pub(super) is_rejected: bool,
    pub(super) made_as: Option<Preset>,
    pub(super) placement: Option<SensorPlacement>,
    pub(super) explained_by: Option<FittedScan>,
}

impl TileSearch<'_> {
    /// # Errors
    /// As [`Film::diagnose`].
    pub(super) fn run(&self) -> Result<Searched, FilmError> {
        self.film.tell(Stage::uncounted("fitting the place of the scan"));
        let placed = self.placed()?;
        let start = placed.start(self.free)?;
        let searched =
            |expected: FilmTolerance, most_errors: usize| self.diagnosed(start, self.free, expected, most_errors);
        let likelier_than = |errors: usize| likelier_preset(self.tiles.len(), self.expected, errors, searched);
        let (mut made_as, mut explained_by) = (None, None);
        let mut diagnosis = match searched(self.expected.clone(), MOST_SINGLE_ERRORS) {
            Err(error @ FilmError::Diagnosis(DiagnosisError::AnotherFilm { .. })) => {
                self.refuse_turned(&placed, None)?;
                return Err(error);
            }
            found => found?,
        };
        // Errors of tiles bend to a scan taken otherwise, or to other errors of every tile.
        if !diagnosis.is_complete || diagnosis.detected.len() > 1 || !self.is_possible(&diagnosis) {
            placed.refuse_turned()?;
            self.refuse_turned(&placed, Some(&diagnosis))?;
        }
        if !diagnosis.is_complete {
            explained_by = self.explained_by(&placed, MOST_SINGLE_ERRORS / 2)?;
            if explained_by.is_none() {
                made_as = likelier_than(MOST_SINGLE_ERRORS + 1)?;
            }
            if explained_by.is_none() && made_as.is_none() {
                diagnosis = searched(self.expected.clone(), MOST_ERRORS)?;
                made_as = likelier_than(diagnosis.detected.len())?;
            }
        } else if diagnosis.detected.len() > 1 {
            explained_by = self.explained_by(&placed, (diagnosis.detected.len() - 1) / 2)?;
        }
        let is_impossible = !self.is_possible(&diagnosis);
        let is_open = is_impossible && made_as.is_none() && explained_by.is_none();
        let placement = is_open.then(|| placed.explaining(diagnosis.residual_t())).transpose()?.flatten();
        // Where errors of single tiles explain no scan, one may remain beside typical errors.
        if is_open && placement.is_none() {
            made_as = likelier_than(diagnosis.detected.len() + 2)?;
        }
        if is_open && made_as.is_none() && placement.is_none() {
            explained_by = self.explained_by(&placed, MOST_SINGLE_ERRORS)?;
        }
        let is_rejected = is_impossible || made_as.is_some() || explained_by.is_some();
        Ok(Searched { diagnosis, is_rejected, made_as, placement, explained_by })
    }

    /// The diagnosis from a start that the scan is near, with its place in the frame of the film.
    fn diagnosed(
        &self,
        start: ScanParameters,
        free: FreeParameters,
        expected: FilmTolerance,
        most_errors: usize,
    ) -> Result<Diagnosis, FilmError> {
        let (iron, false_alarm) = (self.film.layout().iron.clone(), self.false_alarm);
        let settings = DiagnosisSettings { expected, iron, free, false_alarm, most_errors, ..Default::default() };
        let failed = |error: DiagnosisError| match error {
            DiagnosisError::Points(errors) => FilmError::Points(errors),
            error => FilmError::Diagnosis(error),
        };
        self.film.tell(Stage::uncounted("preparing the diagnosis"));
        // The positions count from the start, which the prior of the start is about.
        let points_mm = self.points_mm.iter().map(|point| *point + start.start).collect();
        let scan = FieldScan { points_mm, noise_t: self.noise_t };
        let at_start = ScanParameters { start: DVec3::ZERO, ..start };
        let model = ScanDiagnosis::new(self.tiles, scan, settings, at_start).map_err(failed)?;
        let show = |found: usize| {
            self.film.tell(Stage { name: "faulty tiles", done: found, of: None, unit: "identified" });
        };
        let mut diagnosis = model.diagnose(self.field_t, show).map_err(failed)?;
        diagnosis.scan.start += start.start;
        Ok(diagnosis)
    }

    /// # Errors
    /// [`FilmError::Scan`] if less than half as many errors of tiles explain the scan of a film
    /// that was turned against the positions. Errors of every tile leave so much that the turn
    /// alone does not.
    fn refuse_turned(&self, placed: &PlacedScan, diagnosis: Option<&Diagnosis>) -> Result<(), FilmError> {
        let Some(turn) = placed.turn() else { return Ok(()) };
        let (points_mm, field_t) = turn.undone(self.points_mm, self.field_t);
        let turned = TileSearch { points_mm: &points_mm, field_t: &field_t, ..*self };
        let start = turned.placed()?.start(self.free);
        let most_errors = match diagnosis.filter(|diagnosis| self.is_possible(diagnosis)) {
            Some(diagnosis) => diagnosis.detected.len().saturating_sub(1) / 2,
            None => MOST_SINGLE_ERRORS,
        };
        let found = start.and_then(|start| turned.diagnosed(start, self.free, self.expected.clone(), most_errors));
        match found {
            Ok(found) if found.is_complete && turned.is_possible(&found) => {
                Err(FilmError::Scan(ScanError::Turned(turn)))
            }
            _ => Ok(()),
        }
    }

    /// The scan before errors of tiles are searched.
    fn placed(&self) -> Result<PlacedScan<'_>, FilmError> {
        let expects_errors = *self.expected != FilmTolerance::default();
        let (centre_mm, noise_t) = (self.film.centre_mm(), self.noise_t);
        PlacedScan::new(
            (self.tiles, &self.film.layout().iron),
            self.points_mm,
            self.field_t,
            noise_t,
            centre_mm,
            expects_errors,
        )
    }

    /// Whether noise, errors that tiles can have, and a strength of this film explain a scan.
    fn is_possible(&self, found: &Diagnosis) -> bool {
        let scan = FittedScan::new(&found.scan, found.scan.offset_t);
        !found.is_residual_too_large() && found.has_possible_errors(self.tiles) && scan.implausible_strength().is_none()
    }

    /// The parameters of the scan with which so many errors of tiles explain it.
    fn explained_by(&self, placed: &PlacedScan, most_errors: usize) -> Result<Option<FittedScan>, FilmError> {
        if self.free == FreeParameters::ALL {
            return Ok(None);
        }
        let Ok(start) = placed.start(FreeParameters::ALL) else { return Ok(None) };
        let found = self.diagnosed(start, FreeParameters::ALL, self.expected.clone(), most_errors)?;
        // Parameters within noise of those that are stated explain nothing.
        let is_other = ScanParameter::ALL.into_iter().any(|of| {
            let stated = ScanParameters::PERFECT.get(of);
            (found.scan.get(of) - stated).abs() > CERTAIN * found.scan_deviations.get(of)
        });
        let is_explained = is_other && found.is_complete && self.is_possible(&found);
        Ok(is_explained.then(|| FittedScan::new(&found.scan, found.scan.offset_t)))
    }
}
