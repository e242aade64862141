//! Distributions of errors as they are written: a plain number, or a table.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::error_unit::ErrorUnit;
use crate::faults::TableFaults;
use crate::limits::MAX_TABULATED_IN_ALL;
use crate::tolerance::distribution::Distribution;
use crate::tolerance::tabulated::ErrorTable;

/// Fraction of its standard deviation below which the limit of a truncated normal distribution
/// makes it uniform, to 1e-4 of its density.
const LEAST_LIMIT: f64 = 0.01;

/// The distribution of an error: the standard deviation of normal errors, or a table.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize)]
#[serde(untagged)]
#[schemars(rename = "Distribution")]
pub(crate) enum WrittenDistribution {
    /// Standard deviation of normal errors, in the unit of the key.
    Deviation(f64),
    /// A distribution of another form.
    Table(DistributionTable),
}

/// A distribution, given once: as normal, uniform, fixed, file or values. Numbers have the unit of
/// the key.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, Serialize)]
#[schemars(extend("example" = "{ uniform = 0.1 }"))]
pub(crate) struct DistributionTable {
    /// Standard deviation of normal errors of mean 0.
    normal: Option<f64>,
    /// Largest magnitude of normal errors: parts beyond it are sorted out. Goes with normal.
    within: Option<f64>,
    /// Largest magnitude of errors of equal probability.
    uniform: Option<f64>,
    /// The error, the same in every film that is made.
    fixed: Option<f64>,
    /// CSV file of measured errors, relative to the folder of the layout.
    file: Option<String>,
    /// Name of the column of the file. Default: its only column.
    column: Option<String>,
    /// Measured errors.
    values: Option<Vec<f64>>,
}

/// One distribution for all of `N` components, or a list of one for each. Each component has errors
/// of its own.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(untagged)]
pub(crate) enum Components<const N: usize> {
    /// The same distribution for each component.
    Same(WrittenDistribution),
    /// A list of `N` distributions, which the schema counts.
    Each(Vec<WrittenDistribution>),
}

impl<const N: usize> JsonSchema for Components<N> {
    fn schema_name() -> Cow<'static, str> {
        format!("{N}Distributions").into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<WrittenDistribution>();
        json_schema!({
            "description": format!("One distribution for all components, or a list of {N}."),
            "anyOf": [&one, { "type": "array", "items": &one, "minItems": N, "maxItems": N }],
        })
    }
}

impl<const N: usize> Components<N> {
    /// The distributions of the components of a key. A component is none after adding its faults.
    pub(crate) fn resolve(&self, key: &str, unit: ErrorUnit, at: &mut ErrorTable) -> [Distribution; N] {
        match self {
            Components::Same(one) => {
                let one = one.resolve(key, unit, at);
                std::array::from_fn(|_| one.clone())
            }
            Components::Each(all) => std::array::from_fn(|i| all[i].resolve(&format!("{key}[{i}]"), unit, at)),
        }
    }

    /// One distribution if all are the same.
    pub(crate) fn of(errors: &[Distribution; N], unit: ErrorUnit) -> Components<N> {
        let key = |error| DistributionKey::from(error);
        if errors.iter().all(|error| key(error) == key(&errors[0])) {
            return Components::Same(WrittenDistribution::of(&errors[0], unit));
        }
        Components::Each(errors.iter().map(|error| WrittenDistribution::of(error, unit)).collect())
    }

    /// Nothing if there are no errors.
    pub(crate) fn some(errors: &[Distribution; N], unit: ErrorUnit) -> Option<Components<N>> {
        (!errors.iter().all(Distribution::is_none)).then(|| Components::of(errors, unit))
    }
}

impl WrittenDistribution {
    /// The distribution of a key. It is none after adding its faults.
    pub(crate) fn resolve(&self, key: &str, unit: ErrorUnit, at: &mut ErrorTable) -> Distribution {
        let before = at.faults.count();
        let found = match self {
            WrittenDistribution::Deviation(deviation) => {
                check_deviation(key, *deviation, &mut at.faults);
                Some(Distribution::Normal { deviation: *deviation })
            }
            WrittenDistribution::Table(table) => table.resolve(key, unit, at),
        };
        let Some(found) = found.filter(|_| at.faults.count() == before) else { return Distribution::NONE };
        // Measured errors have been converted already.
        let (found, largest) = match found {
            Distribution::Tabulated(_) => {
                let largest = unit.written(found.largest());
                (found, largest)
            }
            _ => (found.map(|value| unit.read(value)).simplified(), found.largest()),
        };
        if unit.largest().is_some_and(|most| largest > most) {
            at.faults.require(false, key, largest, unit.rule(largest));
            return Distribution::NONE;
        }
        if !at.tabulated.count([&found], 1) {
            at.faults.add(too_many_values(key));
        }
        found
    }

    pub(crate) fn of(error: &Distribution, unit: ErrorUnit) -> WrittenDistribution {
        let number = |value: f64| Some(unit.written(value));
        let table = DistributionTable::default();
        WrittenDistribution::Table(match error {
            Distribution::Fixed(0.0) => return WrittenDistribution::Deviation(0.0),
            Distribution::Normal { deviation } => return WrittenDistribution::Deviation(unit.written(*deviation)),
            Distribution::Fixed(value) => DistributionTable { fixed: number(*value), ..table },
            Distribution::Truncated { deviation, limit } => {
                DistributionTable { normal: number(*deviation), within: number(*limit), ..table }
            }
            Distribution::Uniform { half_width } => DistributionTable { uniform: number(*half_width), ..table },
            Distribution::Tabulated(values) => {
                DistributionTable { values: Some(values.iter().map(|value| unit.written(*value)).collect()), ..table }
            }
        })
    }

    /// Nothing if there are no errors.
    pub(crate) fn some(error: &Distribution, unit: ErrorUnit) -> Option<WrittenDistribution> {
        (!error.is_none()).then(|| WrittenDistribution::of(error, unit))
    }
}

impl DistributionTable {
    /// The distribution, in the unit of the file unless it is tabulated. `None` after adding a
    /// fault.
    fn resolve(&self, key: &str, unit: ErrorUnit, at: &mut ErrorTable) -> Option<Distribution> {
        let DistributionTable { normal, within, uniform, fixed, file, column, values } = self;
        let forms = [
            ("normal", normal.is_some()),
            ("uniform", uniform.is_some()),
            ("fixed", fixed.is_some()),
            ("file", file.is_some()),
            ("values", values.is_some()),
        ];
        let given = at.faults.only_one(key, &forms)?;
        for (goes_with, is_given, wanted) in
            [("within", within.is_some(), "normal"), ("column", column.is_some(), "file")]
        {
            if is_given && given != wanted {
                at.faults.add(format!("{key} gives {goes_with}, which goes with {wanted}"));
            }
        }
        match (normal, uniform, fixed, file, values) {
            (Some(deviation), ..) => {
                check_deviation(&format!("{key}.normal"), *deviation, &mut at.faults);
                let Some(limit) = *within else { return Some(Distribution::Normal { deviation: *deviation }) };
                at.faults.positive(format_args!("{key}.within"), limit);
                if limit > 0.0 && limit < LEAST_LIMIT * deviation {
                    at.faults.add(format!(
                        "{key}.within = {limit}, must be at least a hundredth of normal = {deviation}: write {{ uniform = {limit} }}"
                    ));
                }
                Some(Distribution::Truncated { deviation: *deviation, limit })
            }
            (_, Some(half_width), ..) => {
                let rule = "must be a finite number of at least 0, the largest magnitude";
                let is_kept = half_width.is_finite() && *half_width >= 0.0;
                at.faults.require(is_kept, format_args!("{key}.uniform"), half_width, rule);
                Some(Distribution::Uniform { half_width: *half_width })
            }
            (_, _, Some(value), ..) => {
                at.faults.finite(format_args!("{key}.fixed"), *value);
                Some(Distribution::Fixed(*value))
            }
            (.., Some(file), _) => {
                let found = at.tabulated.of_file(file, column.as_deref(), unit);
                found.map_err(|rule| at.faults.add(format!("{key}: {rule}"))).ok()
            }
            (.., Some(values)) => {
                let found = at.tabulated.of_values(values, unit);
                found.map_err(|rule| at.faults.add(format!("{key}.values: {rule}"))).ok()
            }
            _ => None,
        }
    }
}

fn check_deviation(key: &str, deviation: f64, faults: &mut TableFaults) {
    let rule = "must be a finite number of at least 0, a standard deviation";
    faults.require(deviation.is_finite() && deviation >= 0.0, key, deviation, rule);
}

/// The rule that limits tabulated values in all.
pub(crate) fn too_many_values(key: &str) -> String {
    format!(
        "{key}: has too many tabulated values beside the others of the layout, must be at most {MAX_TABULATED_IN_ALL}, \
         counted in each distribution"
    )
}

/// The identity of a distribution: its form and the bits of its numbers. Tabulated ones have their
/// place in memory, which copies share.
#[derive(Clone, Copy, Eq, Hash, PartialEq)]
pub(crate) struct DistributionKey(u8, u64, u64);

impl From<&Distribution> for DistributionKey {
    fn from(distribution: &Distribution) -> DistributionKey {
        match distribution {
            // Adding 0 turns -0 into 0.
            Distribution::Fixed(value) => DistributionKey(0, (value + 0.0).to_bits(), 0),
            Distribution::Normal { deviation } => DistributionKey(1, deviation.to_bits(), 0),
            Distribution::Truncated { deviation, limit } => DistributionKey(2, deviation.to_bits(), limit.to_bits()),
            Distribution::Uniform { half_width } => DistributionKey(3, half_width.to_bits(), 0),
            Distribution::Tabulated(values) => DistributionKey(4, values.as_ptr().addr() as u64, values.len() as u64),
        }
    }
}
