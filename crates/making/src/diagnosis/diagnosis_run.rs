//! The diagnosis of a film: settings and results.

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Preset, TileErrors};
use magsplice_magnet::{PerTileError, Tile, TileError};
use magsplice_sensor::{FreeParameters, ScanParameters};
use magsplice_tolerance::{RealFilm, mean_square};

use super::error::DiagnosisError;
use super::error_kind::ErrorKind;
use super::ridge::Ridge;
use super::scan_model::{Linearized, ScanModel};
use super::search::{Search, TileAndKind};
use super::significance::ln_probability_above;
use super::unknowns::{State, Unknown, Unknowns};
use super::unresolved::{NarrowedError, SimilarErrors, narrowed, similar};

/// Where a film was scanned, and how exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldScan {
    /// Positions, in the frame of the film, in millimetres.
    pub points_mm: Vec<DVec3>,
    /// Standard deviation of each reading along x, y, z, in tesla.
    pub noise_t: DVec3,
}

/// What is ordinary, and when a tile is named.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagnosisSettings {
    /// The errors that tiles and groups of tiles ordinarily have. With the default, tiles that are
    /// not named are exactly as ordered. Each distribution counts as a normal one of the same mean
    /// square.
    pub ordinary: FilmTolerance,
    /// The errors whose deviation before the scan is compared with that after it, where nothing is
    /// ordinary.
    pub prior: TileErrors,
    /// Parameters of the scan that are not known.
    pub free: FreeParameters,
    /// Probability that any tile of a film without errors beyond the ordinary ones is named.
    /// Default: 0.01.
    pub false_alarm: f64,
}

impl Default for DiagnosisSettings {
    fn default() -> DiagnosisSettings {
        DiagnosisSettings {
            ordinary: FilmTolerance::default(),
            prior: Preset::ByHand.errors(),
            free: FreeParameters { strength: false, offset: false, rotation: false, start: false },
            false_alarm: 0.01,
        }
    }
}

/// A tile and what may be wrong with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Candidate {
    /// Index of the tile.
    pub tile: usize,
    /// What is wrong.
    pub kind: ErrorKind,
}

/// An error with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FittedError {
    /// The error.
    pub error: TileError,
    /// The error, in mm, radians, or as a fraction.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// An error that neither noise nor ordinary errors explain.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NamedError {
    /// The tile and what is wrong with it.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub candidate: Candidate,
    /// Its components.
    pub components: Vec<FittedError>,
    /// What chi squared rises by without it.
    pub chi_squared: f64,
    /// The natural logarithm of the probability that chance gives as much for one error.
    pub ln_probability: f64,
    /// Errors that explain the readings nearly as well in its place, the best first.
    pub alternatives: Vec<Candidate>,
}

/// Value of a component over its deviation from which on it is no noise.
const SIGNIFICANT: f64 = 2.0;

impl FittedError {
    /// Whether the value is more than noise: beyond two deviations.
    pub fn is_significant(&self) -> bool {
        self.value.abs() > SIGNIFICANT * self.deviation
    }
}

impl NamedError {
    /// The magnitude: the error of strength itself, or the length of the vector of all components
    /// that are more than noise. The scan may hardly tell one of them, such as a turn about J.
    pub fn magnitude(&self) -> f64 {
        let length =
            |parts: &mut dyn Iterator<Item = &FittedError>| parts.map(|of| of.value.powi(2)).sum::<f64>().sqrt();
        match &self.components[..] {
            [one] => one.value,
            several if several.iter().any(FittedError::is_significant) => {
                length(&mut several.iter().filter(|estimate| estimate.is_significant()))
            }
            several => length(&mut several.iter()),
        }
    }
}

/// What a scan tells of a film.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The errors that are named, the surest first.
    pub named: Vec<NamedError>,
    /// Whether all significant errors are named. Where a film has more than 16 of them, it is
    /// another film, or its tiles have ordinary errors that were not stated.
    pub is_complete: bool,
    /// The film that explains the readings: named errors without components that are noise, and the
    /// most probable ordinary ones.
    pub tiles: Vec<Tile>,
    /// The errors of each tile in this film, in mm, radians, or as fractions.
    pub errors: Vec<PerTileError<f64>>,
    /// The parameters of the scan.
    pub scan: ScanParameters,
    /// Readings less those of the film that was found, in tesla.
    pub residuals_t: Vec<DVec3>,
    /// Sum of the squares of residuals over those of the noise, and of ordinary errors over their
    /// deviations.
    pub chi_squared: f64,
    /// Its expectation: the number of readings less that of the free numbers.
    pub freedom: usize,
    /// The natural logarithm of the probability of a larger one.
    pub ln_probability: f64,
    /// Standard deviations of all errors of tiles before and after the scan.
    pub narrowed: Vec<NarrowedError>,
    /// Pairs of errors that look alike, the most alike first.
    pub similar: Vec<SimilarErrors>,
}

/// Probability of a residual below which noise and ordinary errors do not explain it.
const IMPLAUSIBLE: f64 = 1e-4;

impl Diagnosis {
    /// Whether the residual is too large for the noise: the film has errors of another kind, or the
    /// noise is larger than stated.
    pub fn is_residual_too_large(&self) -> bool {
        self.ln_probability < IMPLAUSIBLE.ln()
    }

    /// Root mean square of the residual of a component, in tesla.
    pub fn residual_t(&self) -> f64 {
        let squares: f64 = self.residuals_t.iter().map(|residual| residual.length_squared()).sum();
        (squares / (3 * self.residuals_t.len().max(1)) as f64).sqrt()
    }
}

/// A film and the places at which it is scanned, for any number of scans.
///
/// # Cost
/// A film of 56 tiles at 441 points needs about 0.3 s on one core; with ordinary errors of all
/// tiles, several seconds. Memory grows as readings times unknowns, of which a tile has nine to
/// twelve.
///
/// # Accuracy
/// The field is exact for the errors that are found, and so are the derivatives. Standard
/// deviations are those of the linear model there.
#[derive(Clone, Debug)]
pub struct ScanDiagnosis {
    model: ScanModel,
    settings: DiagnosisSettings,
    candidates: Vec<TileAndKind>,
    nominal: Linearized,
}

impl ScanDiagnosis {
    /// The model of a film at the points of a scan. `start` has the parameters of the scan where
    /// they are not fitted, and where the fit begins.
    ///
    /// # Errors
    /// See [`DiagnosisError`].
    ///
    /// # Panics
    /// If there are ordinary errors of some tiles and not of all.
    pub fn new(
        tiles: &[Tile],
        scan: FieldScan,
        settings: DiagnosisSettings,
        start: ScanParameters,
    ) -> Result<ScanDiagnosis, DiagnosisError> {
        if tiles.is_empty() || scan.points_mm.is_empty() {
            return Err(DiagnosisError::Empty);
        }
        if let Some(axis) = (0..3).find(|axis| !(scan.noise_t[*axis] > 0.0 && scan.noise_t[*axis].is_finite())) {
            return Err(DiagnosisError::Noise { axis, value_t: scan.noise_t[axis] });
        }
        if !(settings.false_alarm > 0.0 && settings.false_alarm < 1.0) {
            return Err(DiagnosisError::FalseAlarm(settings.false_alarm));
        }
        let unknowns = Unknowns::new(tiles.len(), &settings.ordinary, settings.free);
        let film = RealFilm::new(tiles, &settings.ordinary);
        let model = ScanModel { film, points: scan.points_mm, noise_t: scan.noise_t, unknowns }.checked()?;
        let state = State::nominal(tiles.len(), settings.ordinary.groups.len(), &start);
        let nominal = model.linearized(state, None)?;
        let candidates =
            (0..tiles.len()).flat_map(|tile| ErrorKind::ALL.map(|kind| (tile, kind))).collect::<Vec<TileAndKind>>();
        Ok(ScanDiagnosis { model, settings, candidates, nominal })
    }

    /// The largest probability of one error by chance for which it is named: the probability of a
    /// false alarm over the number of errors that may be named (Bonferroni).
    pub fn naming_probability(&self) -> f64 {
        self.settings.false_alarm / self.candidates.len() as f64
    }

    /// The diagnosis of readings, in tesla, one for each point of the scan and in the frame of the
    /// film. `watch` is told the number of errors named so far.
    ///
    /// # Errors
    /// See [`DiagnosisError`].
    ///
    /// # Panics
    /// If there are not as many readings as points.
    pub fn diagnose(&self, readings_t: &[DVec3], watch: impl FnMut(usize)) -> Result<Diagnosis, DiagnosisError> {
        assert_eq!(readings_t.len(), self.model.points.len(), "one reading per point");
        if let Some(index) = readings_t.iter().position(|reading_t| !reading_t.is_finite()) {
            return Err(DiagnosisError::Reading { index });
        }
        let (model, unknowns) = (&self.model, &self.model.unknowns);
        let ln_limit = self.naming_probability().ln();
        let search = Search { model, readings_t, candidates: &self.candidates, ln_limit };
        let found = search.run(&self.nominal, watch)?;
        let errors: Vec<TileAndKind> = found.named.iter().map(|named| named.error).collect();
        let deviations = unknowns.with_named(&errors);
        let after = Ridge::new(&found.at.gram, &found.compared.projected, &deviations)?.deviations();
        let values = model.values(&found.at.state);
        let estimates = |(tile, kind): TileAndKind| -> Vec<FittedError> {
            let estimate = |index: usize| match unknowns.list[index] {
                Unknown::Tile { error, .. } => {
                    Some(FittedError { error, value: values[index], deviation: after[index] })
                }
                _ => None,
            };
            unknowns.of_error(tile, kind).into_iter().filter_map(estimate).collect()
        };
        let candidate = |(tile, kind): TileAndKind| Candidate { tile, kind };
        let named: Vec<NamedError> = found
            .named
            .iter()
            .map(|named| NamedError {
                candidate: candidate(named.error),
                components: estimates(named.error),
                chi_squared: named.score.chi_squared,
                ln_probability: named.score.ln_probability,
                alternatives: named.alternatives.iter().copied().map(candidate).collect(),
            })
            .collect();
        let is_part = |index: usize| errors.iter().any(|(tile, kind)| unknowns.of_error(*tile, *kind).contains(&index));
        let ordinary = values.iter().zip(&unknowns.ordinary).enumerate().filter(|(index, (_, deviation))| {
            **deviation > 0.0 && !matches!(unknowns.list[*index], Unknown::Scan(_)) && !is_part(*index)
        });
        let chi_squared = found.compared.chi_squared
            + ordinary.map(|(_, (value, deviation))| (value / deviation).powi(2)).sum::<f64>();
        let free = unknowns.of_scan() + named.iter().map(|named| named.components.len()).sum::<usize>();
        let freedom = (3 * readings_t.len()).saturating_sub(free).max(1);
        // Components that are noise are ordinary errors, or none, in the film that was found.
        let mut told = deviations.clone();
        for (index, told) in told.iter_mut().enumerate().filter(|(index, _)| is_part(*index)) {
            if values[index].abs() <= SIGNIFICANT * after[index] {
                *told = unknowns.ordinary[index];
            }
        }
        let (film, _) = search.converged(found.at.clone(), &told)?;
        let prior = self.prior();
        Ok(Diagnosis {
            named,
            is_complete: found.is_complete,
            tiles: model.tiles(&film.state)?,
            errors: film.state.tiles,
            scan: found.at.state.scan_parameters(),
            residuals_t: found.compared.residuals_t,
            chi_squared,
            freedom,
            ln_probability: ln_probability_above(chi_squared, freedom),
            narrowed: narrowed(&found.at, unknowns, &prior)?,
            similar: similar(&found.at, unknowns),
        })
    }

    /// The deviations before the scan: the ordinary ones, or those of the prior where nothing is
    /// ordinary.
    fn prior(&self) -> Vec<f64> {
        let Unknowns { list, ordinary } = &self.model.unknowns;
        let is_stated = list
            .iter()
            .zip(ordinary)
            .any(|(unknown, deviation)| !matches!(unknown, Unknown::Scan(_)) && *deviation > 0.0);
        if is_stated {
            return ordinary.clone();
        }
        let prior = |(unknown, deviation): (&Unknown, &f64)| match unknown {
            Unknown::Tile { error, .. } => mean_square(&self.settings.prior[*error]).sqrt(),
            _ => *deviation,
        };
        list.iter().zip(ordinary).map(prior).collect()
    }
}
