//! `[expect]`: requirements on a film: upper and lower bounds, and a baseline of its field.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use std::f64::consts::PI;
use std::path::PathBuf;

use magsplice_decouple::{Figure, PerAxis, PerParameter};
use magsplice_ideal::IdealFilm;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{FINITE, NOT_NEGATIVE, POSITIVE, Rule, TableFaults};
use crate::finding::{Finding, FindingSubject};
use crate::plausible::typed;
use crate::tables_present::TablesPresent;
use crate::written_as::{As, is_default};

/// The relative difference of opposite fields, the largest that there is.
const MOST_DIFFERENT: f64 = 2.0;

/// Fraction of |B| from which on a tolerance of a baseline was probably meant in another unit.
const LARGEST_WITHIN: f64 = 0.1;

/// A best-fit amplitude above which a bound was probably meant in percent. A film is seldom twice
/// as strong as its ideal film.
const LARGEST_AMPLITUDE: f64 = 10.0;

// The comments of the following types are descriptions in the JSON Schema.
/// Requirements on the film over its working volume.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(rename = "ExpectTable", extend("minProperties" = 1))]
pub struct Expectations {
    /// Bounds of the figures of the film over the working volume.
    #[serde(flatten)]
    pub bounds: FigureBounds,
    /// A baseline that the field must reproduce.
    pub field: Option<ExpectedField>,
    /// Lower bound of the distance between the tiles and the working volume, in mm. The distance is
    /// negative where a tile reaches into the volume.
    #[serde(rename = "clearance_mm", skip_serializing_if = "Option::is_none", with = "As::<LowerBound>")]
    #[schemars(with = "Option<LowerBound>", extend("example" = "{ min = 3.0 }"))]
    pub least_clearance_mm: Option<f64>,
    /// Requirements on films as made, with the errors of [tolerance].
    pub made: Option<MadeExpectations>,
}

/// Bounds of the figures of a film. `None` where nothing is required. All bounds are inclusive.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
pub struct FigureBounds {
    /// Upper bounds of the uniformity RMSE.
    #[serde(skip_serializing_if = "is_default")]
    #[schemars(extend("example" = "{ r_x = 0.065, r_y = 0.065, s_z = 0.042 }", "minProperties" = 1))]
    pub uniformity_rmse: PerParameter<Option<f64>>,
    /// Upper bounds of the RMSE of the displacement, in mm.
    #[serde(skip_serializing_if = "is_default")]
    #[schemars(extend("example" = "{ x = 0.25, y = 0.25, z = 0.32 }", "minProperties" = 1))]
    pub displacement_rmse_mm: PerAxis<Option<f64>>,
    /// Lower bound of the amplitude: the best-fit factor of B against the ideal film.
    #[serde(rename = "amplitude", skip_serializing_if = "Option::is_none", with = "As::<LowerBound>")]
    #[schemars(with = "Option<LowerBound>", extend("example" = "{ min = 0.8 }"))]
    pub least_amplitude: Option<f64>,
}

/// Requirements on a percentile of films as made, with the errors of [tolerance], at least one:
/// upper bounds at the percentile, and a lower bound of the amplitude at 100 minus it. A bound
/// counts as broken only if the samples show it with the confidence.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(rename = "MadeTable")]
pub struct MadeExpectations {
    /// Per cent of the films that must keep each bound. Default: 95.
    pub percentile: f64,
    /// The bounds at the percentile.
    #[serde(flatten)]
    pub bounds: FigureBounds,
    /// Number of films that are evaluated. Default: the samples of [tolerance].
    pub samples: Option<u64>,
    /// Confidence with which the evaluated films must show that a bound is broken: a fraction.
    /// Default: 0.95.
    pub confidence: f64,
}

/// A baseline of the field and the largest deviation from it.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(extend("example" = "{ file = \"film.field.csv\", within = 1e-9 }"))]
pub struct ExpectedField {
    /// CSV file as `magsplice field` writes it, relative to the folder of the layout. `magsplice
    /// check --update` rewrites it.
    pub file: PathBuf,
    /// Largest difference at any point, as a fraction of |B| there.
    pub within: f64,
}

/// A lower bound.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct LowerBound {
    /// The smallest value allowed.
    min: f64,
}

impl From<LowerBound> for Option<f64> {
    fn from(bound: LowerBound) -> Option<f64> {
        Some(bound.min)
    }
}

impl From<Option<f64>> for LowerBound {
    /// A bound that is not given is not written.
    fn from(min: Option<f64>) -> LowerBound {
        LowerBound { min: min.unwrap_or(f64::NEG_INFINITY) }
    }
}

impl Default for MadeExpectations {
    /// No bounds, the 95th percentile, and a confidence of 95 %.
    fn default() -> MadeExpectations {
        MadeExpectations { percentile: 95.0, bounds: FigureBounds::default(), samples: None, confidence: 0.95 }
    }
}

impl Expectations {
    /// Whether nothing is required.
    pub fn is_empty(&self) -> bool {
        is_default(self)
    }

    /// Adds the faults of all bounds outside of [`MadeExpectations`].
    pub(crate) fn check(&self, present: TablesPresent, faults: &mut TableFaults) {
        let FigureBounds { uniformity_rmse, displacement_rmse_mm, least_amplitude } = self.bounds;
        for (key, is_given, needs_ideal) in [
            ("uniformity_rmse ", !is_default(&uniformity_rmse), true),
            ("displacement_rmse_mm ", !is_default(&displacement_rmse_mm), true),
            ("amplitude ", least_amplitude.is_some(), true),
            ("field ", self.field.is_some(), false),
            ("clearance_mm ", self.least_clearance_mm.is_some(), false),
        ] {
            if is_given {
                present.check(key, needs_ideal, faults);
            }
        }
        self.bounds.check(faults);
        faults.number("clearance_mm.min", self.least_clearance_mm, FINITE);
        if let Some(ExpectedField { file, within }) = &self.field {
            if file.as_os_str().is_empty() {
                faults.add("field.file is empty, must name a CSV file");
            }
            let words = "must be a finite number greater than 0, a fraction of |B|";
            faults.number("field.within", *within, Rule { words, ..POSITIVE });
            let rule = format_args!("must be less than {MOST_DIFFERENT}, a fraction of |B| that no field exceeds");
            faults.require(!(*within >= MOST_DIFFERENT && within.is_finite()), "field.within", within, rule);
        }
    }

    /// Findings about expectations that every film meets, and about bounds in another unit.
    pub(crate) fn findings(&self, ideal: Option<&IdealFilm>) -> Vec<Finding> {
        let mut messages = self.bounds.kept_by_every_film(ideal);
        if let Some(least) = self.least_clearance_mm.filter(|least| *least < 0.0) {
            messages.push(format!(
                "expect: clearance_mm.min = {least} lets tiles reach {} mm into the working volume, in the way of the \
                 sensor: give at least 0",
                -least
            ));
        }
        if let Some(least) = self.bounds.least_amplitude.filter(|least| *least <= 0.0) {
            messages.push(format!(
                "expect: amplitude.min = {least} is also met by a film that is reversed or has no field: give a \
                 fraction of the ideal film's field, such as 0.8"
            ));
        }
        if let Some(field) = self.field.as_ref().filter(|field| field.within >= LARGEST_WITHIN) {
            messages.push(format!(
                "expect: field.within = {} is a fraction of |B|, {} %, and accepts a film that is far from its baseline",
                field.within,
                100.0 * field.within
            ));
        }
        let found = messages.into_iter().map(|message| Finding::new(FindingSubject::Expectations, message));
        let of_amplitude = self.bounds.least_amplitude;
        found.chain(of_amplitude.and_then(|least| about_amplitude(FindingSubject::Expectations, least))).collect()
    }
}

impl FigureBounds {
    /// The bound of one figure: a lower one of the amplitude, an upper one of the others.
    pub fn get(&self, figure: Figure) -> Option<f64> {
        match figure {
            Figure::Uniformity(parameter) => self.uniformity_rmse[parameter],
            Figure::Displacement(axis) => self.displacement_rmse_mm[axis],
            Figure::Amplitude => self.least_amplitude,
        }
    }

    fn check(&self, faults: &mut TableFaults) {
        for figure in Figure::ALL {
            match figure {
                Figure::Amplitude => faults.number("amplitude.min", self.least_amplitude, FINITE),
                _ => faults.number(figure.key(), self.get(figure), NOT_NEGATIVE),
            }
        }
    }

    /// Findings about upper bounds that no film exceeds. R_x and R_y are angles: they deviate by at
    /// most pi from their mean, and displacements along x and y by half the wavelength.
    fn kept_by_every_film(&self, ideal: Option<&IdealFilm>) -> Vec<String> {
        let mut messages = Vec::new();
        for figure in Figure::ALL {
            let Some(bound) = self.get(figure) else { continue };
            let key = figure.key();
            let is_of_z = key.ends_with('z');
            let films = if is_of_z { "almost every film" } else { "every film" };
            match (figure, ideal) {
                (Figure::Uniformity(_), _) if bound >= PI => {
                    let why = if is_of_z {
                        format!(
                            "S_z is a natural logarithm, so that a flux density may vary by a factor of exp({bound}) at \
                             equal z; it is no percentage"
                        )
                    } else {
                        "it bounds an angle in rad, not in mrad or degrees".to_owned()
                    };
                    messages.push(format!("expect: {key} = {bound} is met by {films}: {why}"));
                }
                (Figure::Displacement(_), Some(ideal)) if bound >= 0.5 * ideal.wavelength() => {
                    let (half, meant_mm) = (0.5 * ideal.wavelength(), 1e-3 * bound);
                    let meant = if meant_mm < half {
                        format!("; did you mean {} mm, which is {bound} um?", typed(meant_mm))
                    } else {
                        String::new()
                    };
                    messages.push(format!(
                        "expect: {key} = {bound} is met by {films}: it is not below half the wavelength, {half} mm{meant}"
                    ));
                }
                _ => {}
            }
        }
        messages
    }
}

impl MadeExpectations {
    /// Adds the faults.
    pub(crate) fn check(&self, present: TablesPresent, faults: &mut TableFaults) {
        let MadeExpectations { percentile, bounds, samples, confidence } = self;
        present.check_for_made_films(faults);
        if *bounds == FigureBounds::default() {
            faults.add("has no bound, must give at least one of uniformity_rmse, displacement_rmse_mm, amplitude");
        }
        if *percentile > 0.0 && *percentile <= 1.0 {
            let rule = format_args!("must be greater than 1 (per cent: {}?)", 100.0 * percentile);
            faults.require(false, "percentile", percentile, rule);
        } else {
            let rule = "must be greater than 0 and less than 100, in per cent of the films";
            faults.require(*percentile > 0.0 && *percentile < 100.0, "percentile", percentile, rule);
        }
        let meant = if (1.0..100.0).contains(confidence) {
            format!(" (a fraction, not per cent: {}?)", confidence / 100.0)
        } else {
            String::new()
        };
        let rule = format_args!("must be greater than 0 and less than 1{meant}");
        faults.require(*confidence > 0.0 && *confidence < 1.0, "confidence", confidence, rule);
        faults.sample_count(*samples);
        bounds.check(faults);
    }
}

/// The finding about a least amplitude in percent, in the table of the subject.
pub(crate) fn about_amplitude(subject: FindingSubject, least: f64) -> Option<Finding> {
    let table = if subject == FindingSubject::Design { "design" } else { "expect" };
    (least > LARGEST_AMPLITUDE).then(|| {
        let percent = typed(100.0 * least);
        let meant = format!(", so {percent} %: did you mean {}?", typed(0.01 * least));
        let message = format!("{table}: amplitude.min = {least} is a fraction of the ideal film's field{meant}");
        Finding::new(subject, message)
    })
}
