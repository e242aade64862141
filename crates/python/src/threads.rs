//! The threads of the library's work, also in forked processes.
//!
//! A fork copies the calling thread alone, so the global pool of rayon has no threads in the child
//! and its work would never end. A forked process therefore has a pool of its own.

use std::mem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, Once, PoisonError};

use magsplice::threads;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::exceptions::failed;

/// Whether the process was forked from one that had imported the module.
static IS_FORKED: AtomicBool = AtomicBool::new(false);
/// The pool of a forked process. It is locked only by threads attached to the interpreter, so no
/// other thread holds it at a fork.
static POOL: Mutex<Option<Arc<ThreadPool>>> = Mutex::new(None);
/// The start of the global pool.
static START: Once = Once::new();

/// Registers [`after_fork`] with the interpreter; without effect on systems without a fork.
pub(crate) fn watch_forks(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    if let Some(register) = py.import("os")?.getattr_opt("register_at_fork")? {
        let arguments = pyo3::types::PyDict::new(py);
        arguments.set_item("after_in_child", wrap_pyfunction!(after_fork, module)?)?;
        register.call((), Some(&arguments))?;
    }
    Ok(())
}

#[pyfunction]
fn after_fork() {
    IS_FORKED.store(true, Ordering::Relaxed);
    // The threads of the parent's pool do not exist here. Dropping the pool could wait for them.
    mem::forget(POOL.lock().unwrap_or_else(PoisonError::into_inner).take());
}

/// The pool of a forked process, started by the first call; `None` in other processes, which use
/// the global pool of rayon.
///
/// # Errors
/// If the system refuses the threads.
pub(crate) fn pool(_: Python<'_>) -> PyResult<Option<Arc<ThreadPool>>> {
    if !IS_FORKED.load(Ordering::Relaxed) {
        // Rayon reports threads that the system refuses when the work begins.
        START.call_once(|| _ = threads::start(None));
        return Ok(None);
    }
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let pool = match kept.take() {
        Some(pool) => pool,
        None => Arc::new(threads::pool(None).map_err(failed)?),
    };
    Ok(Some(kept.insert(pool).clone()))
}

/// Does work on the threads of a pool.
pub(crate) fn on<T: Send>(pool: Option<&ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// Does work without the interpreter, on the threads of this process.
///
/// # Errors
/// If the system refuses the threads.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool(py)?;
    Ok(py.detach(|| on(pool.as_deref(), work)))
}
