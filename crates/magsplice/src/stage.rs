//! How far an evaluation is, for people who wait.

/// What is being done, and how much of it is done.
///
/// A film tells it to whom [`Film::with_progress`](crate::Film::with_progress) names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// In a few words, such as "field".
    pub name: &'static str,
    /// How many are done, of what `unit` says.
    pub done: usize,
    /// How many there are; `None` if that is not known, or if there is nothing to count.
    pub of: Option<usize>,
    /// What is counted, such as "points".
    pub unit: &'static str,
}

impl Stage {
    /// Work that ends all at once.
    pub const fn uncounted(name: &'static str) -> Stage {
        Stage { name, done: 0, of: None, unit: "" }
    }
}
