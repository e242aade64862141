//! Distributions of errors as they are written: a plain number, or a table.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::error_unit::ErrorUnit;
use crate::faults::{FINITE, NOT_NEGATIVE, POSITIVE, Rule};
use crate::limits::MAX_TABULATED_IN_ALL;
use crate::tolerance::distribution::Distribution;
use crate::tolerance::tabulated::{ErrorTable, tabulated};

/// Fraction of its standard deviation below which the limit of a truncated normal distribution
/// makes it uniform, to 1e-4 of its density.
const LEAST_LIMIT: f64 = 0.01;

/// The distribution of an error: the standard deviation of normal errors, or a table.
#[derive(Deserialize, JsonSchema, Serialize)]
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
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[schemars(extend("example" = "{ uniform = 0.1 }"))]
pub(crate) struct DistributionTable {
    /// Standard deviation of normal errors of mean 0.
    normal: Option<f64>,
    /// Largest magnitude of normal errors: parts beyond it are sorted out. Goes with normal.
    within: Option<f64>,
    /// Largest magnitude of errors of equal probability.
    uniform: Option<f64>,
    /// The error, the same in every film as made.
    fixed: Option<f64>,
    /// CSV file of measured errors, relative to the folder of the layout.
    file: Option<String>,
    /// Name of the column of the file. Default: its only column.
    column: Option<String>,
    /// Measured errors.
    values: Option<Vec<f64>>,
}

/// One distribution for all components, or a list of one for each. Each component has errors of its
/// own.
#[derive(Deserialize, Serialize)]
#[serde(untagged)]
enum WrittenErrors {
    /// The same distribution for each component.
    Same(WrittenDistribution),
    /// A list of distributions, which the schema counts.
    Each(Vec<WrittenDistribution>),
}

/// The errors of `N` components. Nothing if the key is not given.
#[derive(Default, Deserialize, Serialize)]
#[serde(transparent)]
pub(crate) struct Components<const N: usize>(Option<WrittenErrors>);

impl<const N: usize> JsonSchema for Components<N> {
    fn inline_schema() -> bool {
        N == 1
    }

    fn schema_name() -> Cow<'static, str> {
        format!("{N}Distributions").into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<WrittenDistribution>();
        if N == 1 {
            return one;
        }
        json_schema!({
            "description": format!("One distribution for all components, or a list of {N}."),
            "anyOf": [&one, { "type": "array", "items": &one, "minItems": N, "maxItems": N }],
        })
    }
}

/// A key of a table of errors: its errors as they are written, and in memory.
pub(crate) struct ErrorKey<'k> {
    pub(crate) name: &'static str,
    pub(crate) unit: ErrorUnit,
    written: &'k mut Option<WrittenErrors>,
    pub(crate) errors: &'k mut [Distribution],
}

impl<'k> ErrorKey<'k> {
    /// The key of this name with errors of `N` components.
    pub(crate) fn new<const N: usize>(
        name: &'static str,
        unit: ErrorUnit,
        written: &'k mut Components<N>,
        errors: &'k mut [Distribution],
    ) -> ErrorKey<'k> {
        ErrorKey { name, unit, written: &mut written.0, errors }
    }

    pub(crate) fn is_given(&self) -> bool {
        self.written.is_some()
    }

    pub(crate) fn has_errors(&self) -> bool {
        !self.errors.iter().all(Distribution::is_none)
    }

    /// Takes the errors from the table if it gives the key. An error is none after adding its
    /// faults.
    pub(crate) fn read(&mut self, at: &mut ErrorTable) {
        match self.written {
            None => {}
            Some(WrittenErrors::Same(one)) => self.errors.fill(one.resolve(self.name, self.unit, at)),
            Some(WrittenErrors::Each(all)) => {
                for (i, (error, one)) in self.errors.iter_mut().zip(all).enumerate() {
                    *error = one.resolve(&format!("{}[{i}]", self.name), self.unit, at);
                }
            }
        }
    }

    /// Gives the key in the table: one distribution if all are the same.
    pub(crate) fn write(self) {
        let of = |error: &Distribution| WrittenDistribution::of(error, self.unit);
        let are_same = self.errors.iter().all(|error| DistributionKey::from(error) == (&self.errors[0]).into());
        *self.written = Some(match are_same {
            true => WrittenErrors::Same(of(&self.errors[0])),
            false => WrittenErrors::Each(self.errors.iter().map(of).collect()),
        });
    }

    /// The largest magnitude of each error with its key, once where one distribution is given for
    /// all.
    pub(crate) fn largest(&self) -> impl Iterator<Item = (String, f64)> {
        let is_list = matches!(self.written, Some(WrittenErrors::Each(_)));
        let count = if is_list { self.errors.len() } else { 1 };
        self.errors.iter().take(count).enumerate().map(move |(i, error)| {
            let place = if is_list { format!("[{i}]") } else { String::new() };
            (format!("{}{place}", self.name), error.largest())
        })
    }
}

impl WrittenDistribution {
    /// The distribution of a key. It is none after adding its faults.
    pub(crate) fn resolve(&self, key: &str, unit: ErrorUnit, at: &mut ErrorTable) -> Distribution {
        let before = at.faults.count();
        let found = match self {
            WrittenDistribution::Deviation(deviation) => {
                at.faults.number(key, *deviation, DEVIATION);
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
        if let Some(rule) = unit.broken_rule(largest) {
            at.faults.require(false, key, largest, rule);
            return Distribution::NONE;
        }
        if !at.tabulated.count([&found], 1) {
            at.faults.add(too_many_values(key));
        }
        found
    }

    pub(crate) fn of(error: &Distribution, unit: ErrorUnit) -> WrittenDistribution {
        let number = |value: &f64| Some(unit.written(*value));
        let table = DistributionTable::default();
        WrittenDistribution::Table(match error {
            Distribution::Fixed(0.0) => return WrittenDistribution::Deviation(0.0),
            Distribution::Normal { deviation } => return WrittenDistribution::Deviation(unit.written(*deviation)),
            Distribution::Fixed(value) => DistributionTable { fixed: number(value), ..table },
            Distribution::Truncated { deviation, limit } => {
                DistributionTable { normal: number(deviation), within: number(limit), ..table }
            }
            Distribution::Uniform { half_width } => DistributionTable { uniform: number(half_width), ..table },
            Distribution::Tabulated(values) => {
                DistributionTable { values: values.iter().map(number).collect(), ..table }
            }
        })
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
                at.faults.number(format_args!("{key}.normal"), *deviation, DEVIATION);
                let Some(limit) = *within else { return Some(Distribution::Normal { deviation: *deviation }) };
                at.faults.number(format_args!("{key}.within"), limit, POSITIVE);
                if limit > 0.0 && limit < LEAST_LIMIT * deviation {
                    at.faults.add(format!(
                        "{key}.within = {limit}, must be at least a hundredth of normal = {deviation}: write {{ uniform = {limit} }}"
                    ));
                }
                Some(Distribution::Truncated { deviation: *deviation, limit })
            }
            (_, Some(half_width), ..) => {
                at.faults.number(format_args!("{key}.uniform"), *half_width, MAGNITUDE);
                Some(Distribution::Uniform { half_width: *half_width })
            }
            (_, _, Some(value), ..) => {
                at.faults.number(format_args!("{key}.fixed"), *value, FINITE);
                Some(Distribution::Fixed(*value))
            }
            (.., Some(file), _) => {
                let found = at.tabulated.of_file(file, column.as_deref(), unit);
                found.map_err(|rule| at.faults.add(format!("{key}: {rule}"))).ok()
            }
            (.., Some(values)) => {
                let found = tabulated(values.clone(), unit);
                found.map_err(|rule| at.faults.add(format!("{key}.values: {rule}"))).ok()
            }
            _ => None,
        }
    }
}

const DEVIATION: Rule = Rule { words: "must be a finite number of at least 0, a standard deviation", ..NOT_NEGATIVE };
const MAGNITUDE: Rule = Rule { words: "must be a finite number of at least 0, the largest magnitude", ..NOT_NEGATIVE };

/// The rule that limits tabulated values in all.
pub(crate) fn too_many_values(key: &str) -> String {
    format!(
        "{key}: the layout has too many tabulated values up to this distribution, must have at most \
         {MAX_TABULATED_IN_ALL} in the sum over all distributions"
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
