//! The diagnosis of a film from scans of its field.

use glam::DVec3;
use magsplice_magnet::Tile;
use magsplice_tolerance::{RealFilm, mean_square};

use crate::diagnosis::candidate::{Candidate, ErrorKind};
use crate::diagnosis::error::{DiagnosisError, LEAST_NOISE_T};
use crate::diagnosis::model::{Linearized, ScanModel};
use crate::diagnosis::prior_fit::PriorFit;
use crate::diagnosis::result::{Diagnosis, FittedError};
use crate::diagnosis::search::Search;
use crate::diagnosis::settings::{DiagnosisSettings, FieldScan};
use crate::diagnosis::significance::ln_probability_above;
use crate::diagnosis::unknowns::{State, Unknown, Unknowns};
use crate::diagnosis::unresolved::{narrowed, similar};
use crate::exclusion::Exclusion;
use crate::parameters::ScanParameters;

/// A film and the positions of its scan, for any number of scans.
///
/// # Cost
/// A film of 56 tiles at 441 points needs about 0.3 s on one core; with expected errors of all
/// tiles, several seconds. Memory grows as readings times unknowns. A tile has nine to twelve
/// unknowns.
///
/// # Accuracy
/// Field and derivatives are exact at the found errors. Standard deviations come from the linear
/// model there.
#[derive(Clone, Debug)]
pub struct ScanDiagnosis {
    model: ScanModel,
    settings: DiagnosisSettings,
    candidates: Vec<Candidate>,
    nominal: Linearized,
}

impl ScanDiagnosis {
    /// The model of a film at the points of a scan. `start` has the fixed parameters of the scan,
    /// and the start values of fitted parameters.
    ///
    /// # Errors
    /// See [`DiagnosisError`].
    ///
    /// # Panics
    /// If expected errors are given for some of the tiles only.
    pub fn new(
        tiles: &[Tile],
        scan: FieldScan,
        settings: DiagnosisSettings,
        start: ScanParameters,
    ) -> Result<ScanDiagnosis, DiagnosisError> {
        if tiles.is_empty() || scan.points_mm.is_empty() {
            return Err(DiagnosisError::Empty);
        }
        if let Some(axis) = (0..3).find(|axis| !(LEAST_NOISE_T..f64::INFINITY).contains(&scan.noise_t[*axis])) {
            return Err(DiagnosisError::Noise { axis, value_t: scan.noise_t[axis] });
        }
        if !(settings.false_alarm > 0.0 && settings.false_alarm < 1.0) {
            return Err(DiagnosisError::FalseAlarm(settings.false_alarm));
        }
        let unknowns = Unknowns::new(tiles.len(), &settings.expected, settings.free);
        let film = RealFilm::new(tiles, &settings.expected).with_iron(settings.iron.clone());
        let model = ScanModel { film, points: scan.points_mm, noise_t: scan.noise_t, unknowns }.checked()?;
        let state = State::nominal(tiles.len(), settings.expected.groups.len(), &start);
        let nominal = model.linearized(state, None, &vec![true; model.points.len()], None)?;
        let of_tile = |tile| ErrorKind::ALL.map(|kind| Candidate { tile, kind });
        let candidates = (0..tiles.len()).flat_map(of_tile).collect();
        Ok(ScanDiagnosis { model, settings, candidates, nominal })
    }

    /// The largest probability by chance of an identified error: the probability of a false alarm
    /// over the number of candidate errors (Bonferroni).
    pub fn naming_probability(&self) -> f64 {
        self.settings.false_alarm / self.candidates.len() as f64
    }

    /// The diagnosis of readings, in tesla, one for each point of the scan and in the frame of the
    /// film. Readings that are not finite are not used, and wild readings are excluded. `watch`
    /// receives the number of errors identified so far.
    ///
    /// # Errors
    /// See [`DiagnosisError`].
    ///
    /// # Panics
    /// If the numbers of readings and points differ.
    pub fn diagnose(&self, readings_t: &[DVec3], watch: impl FnMut(usize)) -> Result<Diagnosis, DiagnosisError> {
        assert_eq!(readings_t.len(), self.model.points.len(), "one reading per point");
        let unfinished = |reading_t: &DVec3| (!reading_t.is_finite()).then_some(Exclusion::Incomplete);
        let mut exclusions: Vec<Option<Exclusion>> = readings_t.iter().map(unfinished).collect();
        let unusable: Vec<usize> = (0..exclusions.len()).filter(|index| exclusions[*index].is_some()).collect();
        if unusable.len() == exclusions.len() {
            return Err(DiagnosisError::Empty);
        }
        let nominal = self.nominal.clone().without(&unusable);
        let (model, unknowns) = (&self.model, &self.model.unknowns);
        let ln_limit = self.naming_probability().ln();
        let candidates = &self.candidates;
        let most_errors = self.settings.most_errors;
        let search = Search { model, readings_t, candidates, unusable: unusable.len(), ln_limit, most_errors };
        let found = search.run(&nominal, watch)?;
        for (exclusion, is_used) in exclusions.iter_mut().zip(&found.at.is_used) {
            *exclusion = exclusion.or_else(|| (!is_used).then_some(Exclusion::Outlier));
        }
        let used = exclusions.iter().filter(|exclusion| exclusion.is_none()).count();
        let errors: Vec<Candidate> = found.detected.iter().map(|detected| detected.candidate).collect();
        let deviations = unknowns.with_detected(&errors);
        let after = PriorFit::new(&found.at.gram, &found.compared.projected, &deviations)?.deviations();
        let values = model.values(&found.at.state);
        let fitted = |index: usize| match unknowns.list[index] {
            Unknown::Tile { error, .. } => Some(FittedError { error, value: values[index], deviation: after[index] }),
            _ => None,
        };
        let mut detected = found.detected;
        for error in &mut detected {
            error.components = unknowns.of_error(error.candidate).into_iter().filter_map(fitted).collect();
        }
        let is_part = |index: usize| errors.iter().any(|error| unknowns.of_error(*error).contains(&index));
        let expected = values.iter().zip(&unknowns.expected).enumerate().filter(|(index, (_, deviation))| {
            **deviation > 0.0 && !matches!(unknowns.list[*index], Unknown::Scan(_)) && !is_part(*index)
        });
        let chi_squared = found.compared.chi_squared
            + expected.map(|(_, (value, deviation))| (value / deviation).powi(2)).sum::<f64>();
        let free = unknowns.of_scan() + detected.iter().map(|detected| detected.components.len()).sum::<usize>();
        let freedom = (3 * used).saturating_sub(free).max(1);
        // In the found film, components below the noise have their expected values or vanish.
        let mut resolved = deviations.clone();
        for (index, resolved) in resolved.iter_mut().enumerate().filter(|(index, _)| is_part(*index)) {
            if fitted(index).is_some_and(|error| !error.is_significant()) {
                *resolved = unknowns.expected[index];
            }
        }
        let (film, _) = model.converged(readings_t, found.at.clone(), &resolved)?;
        let prior = self.prior();
        Ok(Diagnosis {
            detected,
            is_complete: found.is_complete,
            is_biased: unknowns.expects_errors() && unknowns.of_scan() > 0 && found.at.slopes_at.is_none(),
            tiles: model.tiles(&film.state)?,
            errors: film.state.tiles,
            scan: found.at.state.scan_parameters(),
            scan_deviations: ScanParameters::from_fn(|parameter| {
                let index = unknowns.list.iter().position(|unknown| *unknown == Unknown::Scan(parameter));
                index.map_or(0.0, |index| after[index])
            }),
            residuals_t: found.compared.residuals_t,
            exclusions,
            chi_squared,
            degrees_of_freedom: freedom,
            ln_probability: ln_probability_above(chi_squared, freedom),
            narrowed: narrowed(&found.at, unknowns, &prior)?,
            similar: similar(&found.at, unknowns),
        })
    }

    /// The deviations before the scan: the expected deviations, or the prior deviations without
    /// expected errors.
    fn prior(&self) -> Vec<f64> {
        let Unknowns { list, expected } = &self.model.unknowns;
        if self.model.unknowns.expects_errors() {
            return expected.clone();
        }
        let prior = |(unknown, deviation): (&Unknown, &f64)| match unknown {
            Unknown::Tile { error, .. } => mean_square(&self.settings.prior[*error]).sqrt(),
            _ => *deviation,
        };
        list.iter().zip(expected).map(prior).collect()
    }
}
