//! Ctrl-C during work.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use magsplice::{Progress, Stage};
use pyo3::prelude::*;

use crate::threads;

/// Time between two polls for signals.
const POLL: Duration = Duration::from_millis(50);

/// Work that a signal ends. Progress callbacks of the work call [`Interruption::poll`], or return
/// [`Interruption::has_begun`].
#[derive(Default)]
pub(crate) struct Interruption {
    stop: AtomicBool,
}

/// The payload that unwinds interrupted work.
struct Interrupted;

impl Progress for Interruption {
    fn show(&self, _: Stage) {
        self.poll();
    }
}

impl Interruption {
    /// Whether a signal has arrived, so that the work should end.
    pub(crate) fn has_begun(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Ends the work by unwinding if a signal has arrived. It is called by any thread of the work.
    pub(crate) fn poll(&self) {
        if self.has_begun() {
            // Unlike a panic, this prints no message.
            resume_unwind(Box::new(Interrupted));
        }
    }

    /// Does work in a thread while the calling thread polls for signals.
    ///
    /// # Errors
    /// The exception of a signal, such as `KeyboardInterrupt`, when the work has ended.
    pub(crate) fn run<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        self.run_and_tell(py, work, || Ok(()))
    }

    /// [`Interruption::run`] that calls `tell` with each poll. Exceptions of `tell` end the work
    /// too.
    pub(crate) fn run_and_tell<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce() -> T + Send,
        tell: impl Fn() -> PyResult<()>,
    ) -> PyResult<T> {
        let (pool, poller) = (threads::pool(py)?, thread::current());
        thread::scope(|scope| {
            let worker = scope.spawn(move || {
                let result = catch_unwind(AssertUnwindSafe(|| threads::on(pool.as_deref(), work)));
                poller.unpark();
                result
            });
            let mut exception = None;
            while !worker.is_finished() {
                py.detach(|| thread::park_timeout(POLL));
                if let Err(error) = py.check_signals().and_then(|()| tell()) {
                    self.stop.store(true, Ordering::Relaxed);
                    exception.get_or_insert(error);
                }
            }
            let result = worker.join().and_then(|result| result);
            match (result, exception) {
                (Err(panic), _) if !is_interruption(panic.as_ref()) => resume_unwind(panic),
                (_, Some(exception)) => Err(exception),
                (Ok(result), None) => Ok(result),
                (Err(_), None) => unreachable!("only an exception interrupts"),
            }
        })
    }
}

fn is_interruption(panic: &(dyn Any + Send)) -> bool {
    panic.is::<Interrupted>()
}
