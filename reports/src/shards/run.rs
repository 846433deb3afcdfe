//! The trials of a shard, run and appended to its file.

use super::{ShardError, ShardFile};
use evaluation::trials::{Experiment, TrialSettings, TrialWorld, run_trial};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::sync::atomic::{AtomicBool, Ordering};

impl ShardFile {
    /// The trials of the shard that were not finished when the file was opened, in the order in which they are merged.
    pub fn open_trials<'a, W: TrialWorld>(&self, experiment: &'a Experiment<W>) -> Vec<TrialSettings<'a, W>> {
        let mut open = experiment.jobs();
        open.retain(|trial| self.shard.has(trial.number) && !self.finished.contains(&trial.number));
        open.sort_by_key(|trial| trial.number);
        open
    }

    /// Runs trials on the threads of the present rayon pool, and appends them to the file. Returns how many were
    /// finished: all, unless `is_canceled` was set. `observe` is called after each of them, from any thread.
    ///
    /// # Errors
    ///
    /// When a trial cannot run or be written. The other trials are canceled then, and those before are kept.
    pub fn run<W: TrialWorld>(
        &self,
        trials: Vec<TrialSettings<W>>,
        is_canceled: &AtomicBool,
        observe: impl Fn() + Sync,
    ) -> Result<u64, ShardError> {
        let run = |trial| {
            let ran = self.run_one(&trial, is_canceled);
            match ran {
                Ok(true) => observe(),
                Ok(false) => {}
                Err(_) => is_canceled.store(true, Ordering::Relaxed), // the other trials cannot be written either
            }
            ran.map(u64::from)
        };
        trials.into_par_iter().map(run).collect::<Vec<_>>().into_iter().sum()
    }

    /// Runs one trial and appends it to the file; false if it was canceled.
    fn run_one<W: TrialWorld>(
        &self,
        trial: &TrialSettings<W>,
        is_canceled: &AtomicBool,
    ) -> Result<bool, ShardError> {
        let goes_on = || !is_canceled.load(Ordering::Relaxed);
        let Some(done) = goes_on().then(|| run_trial(trial, goes_on)).transpose()?.flatten() else {
            return Ok(false);
        };
        self.append(trial.number, &done).map_err(ShardError::Append)?;
        Ok(true)
    }
}
