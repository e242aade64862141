//! Progress of an evaluation.

/// A stage of an evaluation, and how much of it is done.
///
/// A film passes it to the callback of [`Film::with_progress`](crate::Film::with_progress).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// Name in a few words, such as "field".
    pub name: &'static str,
    /// Number of finished items, counted in `unit`.
    pub done: usize,
    /// Number of all items. `None` if it is not known or there is nothing to count.
    pub of: Option<usize>,
    /// The items, such as "points".
    pub unit: &'static str,
}

impl Stage {
    /// A stage without items to count.
    pub const fn uncounted(name: &'static str) -> Stage {
        Stage { name, done: 0, of: None, unit: "" }
    }
}
