//! The threads of this process. A process that was forked has none of the threads of the other one, and would
//! wait for them for ever: it gets its own.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// The pools, by process and number of threads. They stay: threads of another process cannot be ended.
static POOLS: Mutex<BTreeMap<(u32, usize), &'static ThreadPool>> = Mutex::new(BTreeMap::new());

/// Runs `work` without the interpreter; what is parallel in it runs on this number of threads, 0 for one per
/// core; nothing is with 1.
///
/// # Errors
///
/// When the system gives no threads.
pub(crate) fn on_threads<R: Send>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce() -> R + Send,
) -> PyResult<R> {
    if threads == 1 {
        return Ok(py.detach(work));
    }
    let pool = || -> PyResult<&'static ThreadPool> {
        let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (std::process::id(), threads);
        if let Some(pool) = pools.get(&key) {
            return Ok(*pool);
        }
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool: &'static ThreadPool =
            Box::leak(Box::new(pool.map_err(|error| PyRuntimeError::new_err(error.to_string()))?));
        pools.insert(key, pool);
        Ok(pool)
    };
    py.detach(|| Ok(pool()?.install(work)))
}
