//! Work for several threads.

use rayon::{Scope, ThreadPool};
use std::sync::{Mutex, PoisonError};

/// The pieces of the work, per thread: the jobs of a piece take different times, since a reset takes longer than a step.
const PIECES: usize = 4;

/// Runs all jobs on this thread, and if `is_parallel` on those of a pool, of which one stays idle; `None`: the present pool.
/// This thread works instead of waiting: on a busy machine, another one may come late.
pub(crate) fn share<J: Send>(
    is_parallel: bool,
    pool: Option<&ThreadPool>,
    jobs: impl Iterator<Item = J>,
    run: impl Fn(J) + Sync,
) {
    if !is_parallel {
        return jobs.for_each(run);
    }
    let threads = pool.map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
    let mut jobs: Vec<Option<J>> = jobs.map(Some).collect();
    let piece = jobs.len().div_ceil(PIECES * threads).max(1);
    let pieces = Mutex::new(jobs.chunks_mut(piece));
    // From both ends, so that most jobs meet the caches in which they were at the last time.
    let work = |is_caller: bool| {
        loop {
            let mut pieces = pieces.lock().unwrap_or_else(PoisonError::into_inner);
            let next = if is_caller { pieces.next() } else { pieces.next_back() };
            drop(pieces);
            let Some(piece) = next else { return };
            piece.iter_mut().filter_map(Option::take).for_each(&run);
        }
    };
    match pool {
        Some(pool) => pool.in_place_scope(|scope| work_on(scope, threads, &work)),
        None => rayon::in_place_scope(|scope| work_on(scope, threads, &work)),
    }
}

/// Does some work on this thread and on others.
fn work_on<'scope>(scope: &Scope<'scope>, threads: usize, work: &'scope (impl Fn(bool) + Sync)) {
    (1..threads).for_each(|_| scope.spawn(|_| work(false)));
    work(true);
}
