//! Which tiles of a film that was made are faulty, from a scan of its field.

use std::collections::BTreeMap;

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Layout, Preset};
use magsplice_magnet::{Grid, Quantity, Tile, TileError};
use magsplice_scan::{
    Candidate, ColumnFault, DetectedError, Diagnosis, ErrorKind, Exclusion, FreeParameters, NarrowedError, ScanError,
    find_row_order, is_row_order_likely,
};
use magsplice_sensor::Noise;
use serde::Serialize;

use super::error_words::in_words;
use super::placement::{FittedScan, SensorPlacement};
use super::scan::ExcludedReadings;
use super::source::Source;
use super::tile_search::{Searched, TileSearch};
use crate::film::Film;
use crate::film_error::FilmError;

/// Cosine of the angle between J and an axis of rotation from which on a turn is about J.
const ABOUT_J: f64 = 0.99;

/// The errors of tiles that a scan shows. Values are in the units of [`TileError::unit`].
#[derive(Clone, Debug, Serialize)]
pub struct FilmDiagnosis {
    /// The film as ordered.
    #[serde(flatten)]
    pub source: Source,
    /// Number of readings.
    pub readings: usize,
    /// Readings that the fit does not use.
    pub excluded: ExcludedReadings,
    /// Noise of a reading along x, y, z.
    pub noise_t: DVec3,
    /// Probability that a tile of a film without faulty tiles is reported.
    pub false_alarm: f64,
    /// Whether other tiles have the errors that the layout expects; otherwise they count as
    /// ordered.
    pub has_expected_errors: bool,
    /// The tiles that neither noise nor expected errors explain, the surest first. Empty if the
    /// model is rejected.
    pub faulty: Vec<FaultyTile>,
    /// Whether these are all significant errors.
    pub is_complete: bool,
    /// What was fitted of the scan.
    pub scan: FittedScan,
    /// Its standard deviations; 0 for what was not fitted.
    pub scan_deviation: FittedScan,
    /// Root mean square of the residual of a component.
    pub residual_t: f64,
    /// Sum of the squares of the residuals over the noise, and of expected errors over their
    /// deviations.
    pub chi_squared: f64,
    /// Expectation of `chi_squared`.
    pub degrees_of_freedom: usize,
    /// Whether the residual is too large for the noise.
    pub is_residual_too_large: bool,
    /// Whether errors of tiles do not explain the scan: the residual is too large, an error is
    /// larger than a tile can have, or the strength is not that of this film. `scan` is then that
    /// of a wrong model.
    pub is_rejected: bool,
    /// Typical errors of every tile that explain the scan with less than half as many errors of
    /// single tiles than are found with the expected errors: no tile is reported then.
    pub made_as: Option<Preset>,
    /// Another placement of the sensor, which explains a rejected scan better than errors of tiles.
    pub placement: Option<SensorPlacement>,
    /// Parameters of the scan with which less than half as many errors of tiles explain it, or few
    /// explain a rejected scan, where not all are fitted.
    pub explained_by: Option<FittedScan>,
    /// Errors that the scan hardly narrows.
    pub unresolved: Vec<UnresolvedError>,
    /// Pairs of errors that change the readings alike, the most alike first.
    pub similar: Vec<SimilarPair>,
    /// The diagnosis by indices of tiles.
    #[serde(skip)]
    pub diagnosis: Diagnosis,
}

/// A tile with an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultyTile {
    /// The tile.
    pub tile: String,
    /// The kind of the error.
    pub kind: ErrorKind,
    /// Change of the strength, or length of the vector of all components that are more than noise.
    pub magnitude: f64,
    /// Value and standard deviation of each component.
    pub components: BTreeMap<TileError, [f64; 2]>,
    /// Rise of `chi_squared` without it.
    pub chi_squared: f64,
    /// Natural logarithm of the probability that chance alone changes `chi_squared` as much, for
    /// one error.
    pub ln_probability: f64,
    /// Errors that explain the readings nearly as well in its place, the best first.
    pub alternatives: Vec<Suspect>,
    /// The magnitude in words.
    #[serde(skip)]
    pub words: String,
}

/// A tile that may have an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Suspect {
    /// The tile.
    pub tile: String,
    /// The kind of the error.
    pub kind: ErrorKind,
}

/// An error that the scan hardly narrows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnresolvedError {
    /// The tile.
    pub tile: String,
    /// The error.
    pub error: TileError,
    /// Standard deviation before the scan.
    pub before: f64,
    /// Standard deviation after it.
    pub after: f64,
    /// Whether the error turns the tile about its J, which hardly changes the field.
    #[serde(skip)]
    pub is_about_j: bool,
}

/// Two errors that change the readings alike.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimilarPair {
    /// The tiles.
    pub tiles: [String; 2],
    /// The errors.
    pub errors: [TileError; 2],
    /// Correlation of what both change in the readings, over the noise.
    pub correlation: f64,
}

impl Film {
    /// The noise of a flux density along each axis of the film: of the readings, or without it of
    /// the sensor of the layout.
    ///
    /// # Errors
    /// [`FilmError::NoNoise`].
    pub fn scan_noise_t(&self, noise: Option<Noise>) -> Result<DVec3, FilmError> {
        let of_sensor = self.layout().sensor.as_ref().map(|of| of.as_one());
        let of_sensor = of_sensor.map(|of| of.deviation_t() / of.gain.abs());
        let of_sensor = of_sensor.filter(|noise_t| noise_t.min_element() > 0.0);
        noise.map(|noise| noise.deviation_t).or(of_sensor).ok_or(FilmError::NoNoise)
    }

    /// The errors of tiles that a scan shows: `readings_t` of the sensor of the layout at points in
    /// millimetres, with their `numbers`. Its plates count as points there. `noise` is the noise of
    /// the readings, by default the noise of the sensor. Expected errors are the errors of tiles
    /// and groups in the layout. Recoil adds the same field as in the film as ordered: its change
    /// by a faulty tile is neglected.
    ///
    /// # Errors
    /// [`FilmError::NoNoise`] if the noise is not known; [`FilmError::Points`] for points without a
    /// field; [`FilmError::Misplaced`] for a scan with another placement of the sensor;
    /// [`FilmError::Scan`] for a scan of another film; otherwise [`FilmError::Diagnosis`].
    ///
    /// # Panics
    /// If there are not as many readings as points.
    pub fn diagnose(
        &self,
        points_mm: &[DVec3],
        readings_t: &[DVec3],
        numbers: &[u64],
        noise: Option<Noise>,
        free: FreeParameters,
        false_alarm: f64,
    ) -> Result<FilmDiagnosis, FilmError> {
        if self.head().is_some() {
            return Err(FilmError::Head("a diagnosis needs the readings of one sensor"));
        }
        let element = self.layout().sensor.as_ref().map(|sensor| sensor.as_one()).unwrap_or_default();
        let noise_t = self.scan_noise_t(noise)?;
        let unusable: Vec<Option<Exclusion>> =
            readings_t.iter().map(|reading_t| Exclusion::of_reading(&element, *reading_t)).collect();
        let usable_t = readings_t.iter().zip(&unusable);
        let usable_t: Vec<DVec3> =
            usable_t.map(|(reading_t, unusable)| unusable.map_or(*reading_t, |_| DVec3::NAN)).collect();
        if !readings_t.is_empty() && unusable.iter().all(Option::is_some) {
            return Err(FilmError::Scan(ScanError::TooFew { readings: 0, excluded: unusable.len(), needed: 1 }));
        }
        // No search explains them, and it takes minutes. Readings without noise may be 0 on a line.
        if let Some(fault) = ColumnFault::among(points_mm, &usable_t).filter(ColumnFault::is_certain) {
            return Err(FilmError::Scan(ScanError::Columns(fault)));
        }
        let field_t =
            usable_t.iter().map(|usable_t| element.rotation * ((*usable_t - element.offset_t) / element.gain));
        let mut field_t: Vec<DVec3> = field_t.collect();
        if self.recoil().is_some() {
            let [with_t, rigid_t] = [self, &Film::rigid(self.layout().clone())]
                .map(|film| film.scene().field_at(Quantity::FluxDensity, points_mm).map_err(FilmError::Points));
            let added_t = with_t?.into_iter().zip(rigid_t?).map(|(with_t, rigid_t)| with_t - rigid_t);
            field_t.iter_mut().zip(added_t).for_each(|(field_t, added_t)| *field_t -= added_t);
        }
        let tiles = self.layout().bare_tiles();
        let expected = self.layout().tolerance.as_ref().map(|stated| FilmTolerance {
            tiles: stated.tiles.clone(),
            groups: stated.groups.clone(),
            ..FilmTolerance::default()
        });
        let expected = expected.unwrap_or_default();
        let has_expected_errors = expected != FilmTolerance::default();
        let search = TileSearch {
            film: self,
            tiles: &tiles,
            points_mm,
            field_t: &field_t,
            noise_t,
            expected: &expected,
            free,
            false_alarm,
        };
        // Every other reason is a consequence of columns that no scan has.
        let in_order = || {
            let sensed = self.sensed_field(&Grid::around(points_mm))?;
            match find_row_order(&sensed, points_mm, readings_t, None, self.centre_mm()) {
                Some(order) => Err(FilmError::Scan(ScanError::RowOrder(order))),
                None => Ok(()),
            }
        };
        let found = match (search.run(), ColumnFault::among(points_mm, readings_t)) {
            (Err(FilmError::Scan(_) | FilmError::Diagnosis(_) | FilmError::Misplaced(_)), Some(fault)) => {
                return Err(FilmError::Scan(ScanError::Columns(fault)));
            }
            (
                Err(FilmError::Scan(
                    error @ (ScanError::Turned(_) | ScanError::Unit { .. } | ScanError::ReadingUnit { .. }),
                )),
                None,
            ) => return Err(FilmError::Scan(error)),
            (Err(error @ (FilmError::Scan(_) | FilmError::Diagnosis(_) | FilmError::Misplaced(_))), None) => {
                if let Some(limit) = self.unfit_readings(readings_t) {
                    return Err(limit);
                }
                in_order()?;
                return Err(error);
            }
            (found, _) => found?,
        };
        if found.is_rejected || is_row_order_likely(&found.diagnosis.exclusions) {
            in_order()?;
        }
        let Searched { mut diagnosis, is_rejected, made_as, placement, explained_by } = found;
        // Saturated readings were withheld as unfinished.
        for (exclusion, unusable) in diagnosis.exclusions.iter_mut().zip(&unusable) {
            *exclusion = unusable.or(*exclusion);
        }
        let name = |tile: usize| self.layout().tiles[tile].name.clone();
        let suspect = |of: &Candidate| Suspect { tile: name(of.tile), kind: of.kind };
        let faulty = |detected: &DetectedError| FaultyTile {
            tile: name(detected.candidate.tile),
            kind: detected.candidate.kind,
            magnitude: detected.components[0].error.shown(detected.magnitude()),
            components: detected
                .components
                .iter()
                .map(|of| (of.error, [of.value, of.deviation].map(|value| of.error.shown(value))))
                .collect(),
            chi_squared: detected.chi_squared,
            ln_probability: detected.ln_probability,
            alternatives: detected.alternatives.iter().map(suspect).collect(),
            words: in_words(detected),
        };
        let unresolved = |of: &NarrowedError| UnresolvedError {
            tile: name(of.tile),
            error: of.error,
            before: of.error.shown(of.before),
            after: of.error.shown(of.after),
            is_about_j: is_about_j(self.layout(), of),
        };
        let scan = FittedScan::new(&diagnosis.scan, diagnosis.scan.offset_t);
        let listed = if is_rejected { &[][..] } else { &diagnosis.detected };
        let similar = diagnosis.similar.iter().map(|of| SimilarPair {
            tiles: [of.first.0, of.second.0].map(name),
            errors: [of.first.1, of.second.1],
            correlation: of.correlation,
        });
        Ok(FilmDiagnosis {
            source: Source::of(self),
            readings: readings_t.len(),
            excluded: ExcludedReadings::of_scan(readings_t, &diagnosis.exclusions, numbers),
            noise_t,
            false_alarm,
            has_expected_errors,
            faulty: listed.iter().map(faulty).collect(),
            is_complete: diagnosis.is_complete,
            scan,
            scan_deviation: FittedScan::new(&diagnosis.scan_deviations, diagnosis.scan_deviations.offset_t),
            residual_t: diagnosis.residual_t(),
            chi_squared: diagnosis.chi_squared,
            degrees_of_freedom: diagnosis.degrees_of_freedom,
            is_residual_too_large: diagnosis.is_residual_too_large(),
            is_rejected,
            made_as,
            placement,
            explained_by,
            unresolved: diagnosis.narrowed.iter().filter(|of| of.is_unresolved()).map(unresolved).collect(),
            similar: similar.collect(),
            diagnosis,
        })
    }
}

impl FilmDiagnosis {
    /// `chi_squared` over its expectation.
    pub fn reduced_chi_squared(&self) -> f64 {
        self.chi_squared / self.degrees_of_freedom as f64
    }

    /// The largest standard deviation of the errors of a tile after the scan over the one before
    /// it, but for turns about J.
    pub fn unresolved_share(&self, layout: &Layout, tile: usize) -> f64 {
        let of_tile = self.diagnosis.narrowed.iter().filter(|of| of.tile == tile && !is_about_j(layout, of));
        of_tile.map(NarrowedError::ratio).fold(0.0, f64::max)
    }

    /// The film that was found, as a layout. `[expect]` and `[design]` belong to the film as
    /// ordered and are omitted; so are the errors of its tiles, which are now known. The history
    /// contains `scan`, the name of the scan, and `program`, the name of the program.
    pub fn found_layout(&self, original: &Layout, scan: &str, program: &str) -> Layout {
        let mut layout = made_layout(original, &self.diagnosis.tiles);
        let faulty: Vec<String> = self.faulty.iter().map(|of| format!("{} {}", of.tile, of.words)).collect();
        layout.history.push(format!(
            "{program}: from \"{}\" (sha256 {}) by {scan}: {}",
            original.name,
            &original.sha256[..12],
            if faulty.is_empty() { "no faulty tile".to_owned() } else { faulty.join(", ") }
        ));
        layout
    }
}

/// The layout with these tiles, whose errors are now known and omitted.
pub(super) fn made_layout(original: &Layout, tiles: &[Tile]) -> Layout {
    let mut layout = original.clone().with_made_tiles(tiles);
    layout.tolerance =
        layout.tolerance.map(|tolerance| FilmTolerance { tiles: Vec::new(), groups: Vec::new(), ..tolerance });
    layout.tolerance = layout.tolerance.filter(|tolerance| *tolerance != FilmTolerance::default());
    layout
}

/// Whether an error turns a tile about its J, which hardly changes the field.
fn is_about_j(layout: &Layout, of: &NarrowedError) -> bool {
    let along = layout.tiles[of.tile].tile.scene_polarization_t().normalize_or_zero();
    matches!(of.error, TileError::Rotation(axis) if along.dot(axis.unit()).abs() > ABOUT_J)
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;
    use magsplice_magnet::{Grid, Quantity};
    use magsplice_scan::ErrorKind;

    use super::*;

    #[test]
    fn weak_tile_is_found_by_readings_of_a_sensor_with_a_gain() {
        let squares = |second_t: f64| {
            format!(
                "format = 1\nname = \"two\"\n[sensor]\ngain = 1.1\nnoise_ut = 1\n\
                 [[tile]]\nposition_mm = [2, 0, 0.5]\nsize_mm = [3, 3, 1]\npolarization_t = [0, 0, 0.1]\n\
                 [[tile]]\nposition_mm = [-2, 0, 0.5]\nsize_mm = [3, 3, 1]\npolarization_t = [0, 0, {second_t}]\n"
            )
        };
        let [ordered, made] = [0.1, 0.09].map(|second_t| Layout::parse(&squares(second_t), "layout").unwrap());
        let grid = Grid::new(DVec3::new(-4.0, -2.0, -1.0), DVec3::new(4.0, 2.0, -1.0), [17, 9, 1]).unwrap();
        let points_mm: Vec<DVec3> = grid.points().collect();
        let field_t = Film::rigid(made).scene().field_at(Quantity::FluxDensity, &points_mm).unwrap();
        let readings_t: Vec<DVec3> = field_t.iter().map(|field_t| 1.1 * *field_t).collect();
        let numbers: Vec<u64> = (0..points_mm.len() as u64).collect();
        let known = FreeParameters { strength: false, offset: false, rotation: false, start: false };
        let found =
            Film::rigid(ordered.clone()).diagnose(&points_mm, &readings_t, &numbers, None, known, 0.01).unwrap();
        let [weak] = &found.faulty[..] else { panic!("{:?}", found.faulty) };
        assert_eq!((weak.tile.as_str(), weak.kind), ("tile-2", ErrorKind::Strength));
        let [percent, _] = weak.components[&TileError::Strength];
        assert!((percent + 10.0).abs() < 0.01, "{percent}");
        assert_eq!(weak.words, "10.00 % too weak");
        let quiet = Layout { sensor: None, ..ordered };
        let refused = Film::rigid(quiet).diagnose(&points_mm, &readings_t, &numbers, None, known, 0.01);
        assert_eq!(refused.unwrap_err(), FilmError::NoNoise);
    }
}
