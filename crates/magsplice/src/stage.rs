//! Progress of an evaluation.

/// A stage of an evaluation, and how much of it is done.
///
/// A film passes it to its [`Progress`].
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

/// Receives the progress of an evaluation, from any thread. It must be short.
pub trait Progress: Send + Sync {
    /// Shows how far the work is.
    fn show(&self, stage: Stage);
}

impl<F: Fn(Stage) + Send + Sync> Progress for F {
    fn show(&self, stage: Stage) {
        self(stage);
    }
}
