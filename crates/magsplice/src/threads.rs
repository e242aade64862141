//! The number of threads that compute.

use std::env;
use std::num::NonZero;
use std::thread::available_parallelism;

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// Largest number of threads per processor. Work is divided among all threads, so threads beyond
/// the number of processors only wait for each other. Several per processor are allowed, because
/// containers may report fewer processors than they have.
const MOST_PER_PROCESSOR: usize = 4;

/// The variable of the environment with the number of threads.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// The number of threads that are started where `asked` are asked for: at most four per processor.
/// Results do not depend on it.
fn bounded(asked: usize) -> usize {
    let processors = available_parallelism().map_or(1, NonZero::get);
    asked.min(MOST_PER_PROCESSOR * processors)
}

/// The number of threads of the environment, bounded. `None` if it states none, or all processors.
fn of_environment() -> Option<usize> {
    asked_by(&env::var(VARIABLE).ok()?).map(bounded)
}

/// A number with more digits than a machine word is a number of threads too.
fn asked_by(text: &str) -> Option<usize> {
    let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().unwrap_or(usize::MAX)).filter(|count| *count > 0)
}

/// Starts the threads of all later work, at most four per processor: `asked`, else the number of
/// `RAYON_NUM_THREADS` in the environment, else one per processor.
///
/// # Errors
/// If they cannot be started, or have been started before.
pub fn start(asked: Option<usize>) -> Result<(), ThreadPoolBuildError> {
    builder(asked).build_global()
}

/// A pool of threads of its own, with the numbers of [`start`].
///
/// # Errors
/// If the threads cannot be started.
pub fn pool(asked: Option<usize>) -> Result<ThreadPool, ThreadPoolBuildError> {
    builder(asked).build()
}

fn builder(asked: Option<usize>) -> ThreadPoolBuilder {
    // 0 stands for one per processor.
    ThreadPoolBuilder::new().num_threads(asked.map(bounded).or_else(of_environment).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_few_per_processor() {
        let processors = available_parallelism().map_or(1, NonZero::get);
        assert_eq!((bounded(1), bounded(100_000), bounded(usize::MAX)), (1, 4 * processors, 4 * processors));
    }

    #[test]
    fn numbers_of_the_environment_are_read() {
        let digits = "9".repeat(30);
        let texts = ["7", &digits, "0", "", "-1", "many"];
        assert_eq!(texts.map(asked_by), [Some(7), Some(usize::MAX), None, None, None, None]);
    }
}
