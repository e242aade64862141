//! Distributions of errors in `[tolerance]`: a plain number, or a table.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

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
#[serde(deny_unknown_fields)]
#[schemars(rename = "DistributionTable")]
#[schemars(extend("example" = "{ uniform = 0.1 }"))]
pub(crate) struct DistributionTable {
    /// Standard deviation of normal errors of mean 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) normal: Option<f64>,
    /// Largest magnitude of normal errors: parts beyond it are sorted out. Goes with normal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) within: Option<f64>,
    /// Largest magnitude of errors of equal probability.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) uniform: Option<f64>,
    /// The error, the same in every film that is made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fixed: Option<f64>,
    /// CSV file of measured errors, relative to the folder of the layout.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) file: Option<String>,
    /// Name of the column of the file. Default: its only column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) column: Option<String>,
    /// Measured errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) values: Option<Vec<f64>>,
}

/// One distribution for all of `N` components, or a list of one for each. Each component has errors
/// of its own.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(untagged)]
pub(crate) enum Components<const N: usize> {
    /// The same distribution for each component.
    Same(WrittenDistribution),
    /// A list of `N` distributions.
    Each(Vec<WrittenDistribution>),
}

impl<const N: usize> Components<N> {
    /// The distribution of each component.
    pub(crate) fn each(&self) -> [&WrittenDistribution; N] {
        match self {
            Components::Same(one) => [one; N],
            // The schema has the length.
            Components::Each(list) => std::array::from_fn(|i| &list[i]),
        }
    }
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
