//! Values that a file has in another form than memory.

use std::marker::PhantomData;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Whether a value is the default, which is not written.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Writes and reads a value as a `W`, for the attribute `serde(with = "As::<W>")`.
pub(crate) struct As<W>(PhantomData<W>);

impl<W> As<W> {
    pub(crate) fn serialize<T: Clone + Into<W>, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error>
    where
        W: Serialize,
    {
        value.clone().into().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, T: From<W>, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error>
    where
        W: Deserialize<'de>,
    {
        W::deserialize(deserializer).map(T::from)
    }
}
