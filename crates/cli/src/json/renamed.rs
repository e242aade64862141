//! Values of the library with other names of some keys.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde::{Serialize, Serializer};
use serde_json::Value;

/// A value of the library with other names of some keys.
///
/// The library has any unit of length. The keys of the program name its unit, the millimetre.
pub(crate) struct RenamedJson(Vec<(String, Value)>);

impl RenamedJson {
    /// `names` are pairs: the name of a key in the library, and its name here.
    pub(crate) fn new(value: &impl Serialize, names: &[(&str, &str)]) -> RenamedJson {
        // Through text, because `serde_json::Map` does not keep the order of keys.
        let text = serde_json::to_string(value).expect("results hold numbers and strings only");
        let mut renamed: RenamedJson = serde_json::from_str(&text).expect("results are objects");
        for (key, _) in &mut renamed.0 {
            if let Some((_, name)) = names.iter().find(|(from, _)| from == key) {
                *key = (*name).to_owned();
            }
        }
        renamed
    }
}

impl Serialize for RenamedJson {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

impl<'de> Deserialize<'de> for RenamedJson {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<RenamedJson, D::Error> {
        deserializer.deserialize_map(EntriesInOrder)
    }
}

struct EntriesInOrder;

impl<'de> Visitor<'de> for EntriesInOrder {
    type Value = RenamedJson;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<RenamedJson, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(RenamedJson(entries))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Sample {
        worst_t: f64,
        at: [f64; 3],
        amplitude: Option<f64>,
        count: usize,
    }

    #[test]
    fn keys_get_their_names_and_keep_their_order_and_numbers() {
        let sample = Sample { worst_t: 0.1 + 0.2, at: [1.0, -0.0, 1e-300], amplitude: None, count: 3 };
        let renamed = RenamedJson::new(&sample, &[("at", "at_mm"), ("lower", "lower_mm")]);
        let json = r#"{"worst_t":0.30000000000000004,"at_mm":[1.0,-0.0,1e-300],"amplitude":null,"count":3}"#;
        assert_eq!(serde_json::to_string(&renamed).expect("JSON"), json);
    }
}
