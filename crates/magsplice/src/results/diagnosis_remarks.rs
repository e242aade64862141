//! What speaks against a diagnosis, in words.

use super::diagnosis::FilmDiagnosis;
use super::error_words::in_words;
use super::likelier_errors::MOST_SINGLE_ERRORS;
use super::significant::ratio;

/// Standard deviation of the strength beside expected errors from which on it is too small: 60
/// films made by hand, of a stated deviation of 5 %, scattered 1.6 times as much. Films of jigs and
/// workshops with deviations of 0.2 % scattered as stated.
const VAGUE: f64 = 0.02;

/// Standard deviations of chi squared below its expectation from which on the expected errors are
/// larger than those of the film: one right film in a thousand million is so far off.
const COARSE: f64 = 6.0;

impl FilmDiagnosis {
    /// What speaks against the diagnosis, one sentence each.
    pub fn remarks(&self) -> Vec<String> {
        let plateau = self.excluded.remark();
        let strength = self.scan.implausible_strength();
        let placement = self.placement.as_ref().map(ToString::to_string);
        plateau
            .into_iter()
            .chain(self.of_few_readings())
            .chain(strength)
            .chain(self.of_fitted_parameters())
            .chain(self.of_expected_errors())
            .chain(self.of_residual())
            .chain(placement)
            .chain(self.of_impossible_errors())
            .collect()
    }

    fn of_few_readings(&self) -> Option<String> {
        let (used, tiles) = (self.readings - self.excluded.count(), self.diagnosis.tiles.len());
        (used < tiles).then(|| {
            format!("{used} readings are fewer than {tiles} tiles: most faulty tiles do not show in this scan")
        })
    }

    /// How far the fitted parameters of the scan hold.
    fn of_fitted_parameters(&self) -> Option<String> {
        if self.is_rejected {
            return None;
        }
        if self.diagnosis.is_biased {
            return Some(
                "expected errors of the tiles bias what is fitted of the scan, by more than the stated deviations: the film \
                 is too near or too far for a linear model of its errors, so scan it at another distance, such as 2 mm"
                    .to_owned(),
            );
        }
        (self.has_expected_errors && self.scan_deviation.strength > VAGUE).then(|| {
            "deviations of strength and height are those of a linear model, which is too coarse here: films made by hand \
             scatter 1.6 times as much; readings nearer to the film determine them, or hold the strength"
                .to_owned()
        })
    }

    /// Errors of every tile that are likelier, or larger than those of the film.
    fn of_expected_errors(&self) -> Option<String> {
        if let Some(preset) = self.made_as {
            let single = match (self.diagnosis.detected.len(), self.is_complete) {
                (_, true) if self.is_residual_too_large => "errors of single tiles alone do not".to_owned(),
                (errors, true) => format!("{errors} errors of single tiles are less likely"),
                (errors, false) if errors < MOST_SINGLE_ERRORS => "errors of single tiles alone do not".to_owned(),
                (errors, false) => format!("more than {errors} errors of single tiles are less likely"),
            };
            return Some(format!(
                "typical errors of every tile (preset {}), and few errors of single tiles, explain the scan, and {single}: no \
                 tile is reported unless errors of every tile are expected",
                preset.name()
            ));
        }
        let freedom = self.degrees_of_freedom as f64;
        let is_coarse = freedom - self.chi_squared > COARSE * (2.0 * freedom).sqrt();
        (self.has_expected_errors && is_coarse).then(|| {
            format!(
                "chi squared is {} times its expectation: the expected errors are larger than those of the film, or the \
                 noise is smaller than specified, and hide faulty tiles; expect smaller errors, as those of a jig, or \
                 specify the noise of these readings",
                ratio(self.reduced_chi_squared())
            )
        })
    }

    /// A residual that errors of tiles do not explain, or only in a scan taken otherwise.
    fn of_residual(&self) -> Option<String> {
        if let Some(parameters) = &self.explained_by {
            return Some(format!(
                "errors of tiles explain the scan with {}: fit these parameters with the errors of tiles",
                parameters.in_words()
            ));
        }
        (self.is_residual_too_large && self.made_as.is_none()).then(|| {
            format!(
                "chi squared of the residual is {} times its expectation: the noise is larger than specified, the readings \
                 drift or have other gains (a fit without errors of tiles, as by scan, names both), the tiles have other or \
                 larger errors than are expected (a preset expects errors of every tile), or the positions of the scan are \
                 wrong",
                ratio(self.reduced_chi_squared())
            )
        })
    }

    /// Errors that no tile can have, by which a scan is rejected that they explain.
    fn of_impossible_errors(&self) -> Option<String> {
        let is_explained = self.is_complete && !self.is_residual_too_large && self.made_as.is_none();
        let has_strength = self.scan.implausible_strength().is_none();
        (is_explained && self.is_rejected && self.placement.is_none() && has_strength).then(|| {
            let errors: Vec<String> = self.diagnosis.detected.iter().map(in_words).collect();
            format!("only errors that no tile can have explain the scan: a tile {}", errors.join(", another "))
        })
    }
}
