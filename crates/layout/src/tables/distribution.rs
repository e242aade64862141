//! Distributions of errors in `[tolerance]`: a plain number, or a table.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// The distribution of an error: the standard deviation of normal errors, or a table.
#[derive(Clone, Debug, JsonSchema, Serialize)]
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
#[derive(Clone, Debug, Serialize)]
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
            // The length has been checked by the deserializer.
            Components::Each(list) => std::array::from_fn(|i| &list[i]),
        }
    }
}

impl<'de> Deserialize<'de> for WrittenDistribution {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfNumberOrTable;
        impl<'de> Visitor<'de> for OfNumberOrTable {
            type Value = WrittenDistribution;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number, or a table such as { uniform = 0.1 }")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
                Ok(WrittenDistribution::Deviation(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
                Ok(WrittenDistribution::Deviation(value as f64))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Self::Value, E> {
                Ok(WrittenDistribution::Deviation(value as f64))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                DistributionTable::deserialize(MapAccessDeserializer::new(map)).map(WrittenDistribution::Table)
            }
        }
        deserializer.deserialize_any(OfNumberOrTable)
    }
}

impl<'de, const N: usize> Deserialize<'de> for Components<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfOneOrEach<const N: usize>;
        impl<'de, const N: usize> Visitor<'de> for OfOneOrEach<N> {
            type Value = Components<N>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "a number, a table such as {{ uniform = 0.1 }}, or a list of {N} of them")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
                Ok(Components::Same(WrittenDistribution::Deviation(value)))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
                Ok(Components::Same(WrittenDistribution::Deviation(value as f64)))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Self::Value, E> {
                Ok(Components::Same(WrittenDistribution::Deviation(value as f64)))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                WrittenDistribution::deserialize(MapAccessDeserializer::new(map)).map(Components::Same)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
                let list = Vec::<WrittenDistribution>::deserialize(SeqAccessDeserializer::new(list))?;
                if list.len() != N {
                    return Err(serde::de::Error::invalid_length(list.len(), &self));
                }
                Ok(Components::Each(list))
            }
        }
        deserializer.deserialize_any(OfOneOrEach)
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
