//! Lists of an exact length. The arrays of serde take as many elements as they hold from a longer
//! list, and the TOML parser does not tell of the rest.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Error, IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// A list of N elements.
struct ExactList<T, const N: usize>([T; N]);

struct ListVisitor<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for ListVisitor<T, N> {
    type Value = ExactList<T, N>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "an array of length {N}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<ExactList<T, N>, A::Error> {
        let mut elements = Vec::with_capacity(N);
        while elements.len() < N
            && let Some(element) = list.next_element()?
        {
            elements.push(element);
        }
        let mut count = elements.len();
        while list.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        match elements.try_into() {
            Ok(elements) if count == N => Ok(ExactList(elements)),
            _ => Err(A::Error::invalid_length(count, &self)),
        }
    }
}

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for ExactList<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(ListVisitor(PhantomData))
    }
}

/// A list of N elements.
pub(crate) fn exactly<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    deserializer: D,
) -> Result<[T; N], D::Error> {
    ExactList::deserialize(deserializer).map(|ExactList(elements)| elements)
}

/// A list of N elements that may be absent.
pub(crate) fn some_exactly<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    deserializer: D,
) -> Result<Option<[T; N]>, D::Error> {
    exactly(deserializer).map(Some)
}

/// A matrix by rows that may be absent.
pub(crate) fn some_matrix<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    deserializer: D,
) -> Result<Option<[[T; N]; N]>, D::Error> {
    exactly(deserializer).map(|rows: [ExactList<T, N>; N]| Some(rows.map(|ExactList(row)| row)))
}
