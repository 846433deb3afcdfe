//! A grid trial that is recorded while it runs.

use crate::recording::{Recorder, RecordingError};
use crate::view::{Measured, View};
use evaluation::metrics::{RateErrors, map_scores, rate_scores};
use evaluation::report::Trial;
use evaluation::trials::{TrialSettings, TrialStep, run_trial};
use interfaces::SettingsError;
use robot::{Level, Message};
use std::sync::atomic::{AtomicBool, Ordering};

/// Later steps are not recorded, so that the file stays a few megabytes large.
pub const RECORDED_STEPS: u64 = 20_000;

/// Scores take a pass over the map: once in this many steps in a map of up to [`SCORE_CELLS`] cells, and
/// less often in a larger map.
const SCORE_EVERY: u64 = 10;
/// See [`SCORE_EVERY`].
const SCORE_CELLS: usize = 10_000;

/// The outcome of a recorded trial.
#[derive(Debug)]
pub struct Recorded {
    /// The trial, the same as without a recording; `None` if it was canceled.
    pub trial: Option<Trial>,
    /// Why a part of the trial is not in the recording; `None` if the recording is complete. The trial has
    /// continued.
    pub problem: Option<RecordingError>,
}

/// Runs one trial and records its first steps. When `is_canceled` is set, the trial stops, and the recording
/// so far is kept.
///
/// # Errors
///
/// When settings are invalid.
pub fn record(
    settings: &TrialSettings,
    mut recorder: Recorder,
    is_canceled: &AtomicBool,
) -> Result<Recorded, SettingsError> {
    let mut problem = None;
    let trial = run_trial(settings, |mut step| {
        let is_canceled = is_canceled.load(Ordering::Relaxed);
        if problem.is_none() && step.reading.time as u64 <= RECORDED_STEPS {
            problem = log(&mut recorder, settings, &mut step, is_canceled).err();
        }
        !is_canceled
    })?;
    Ok(Recorded { trial, problem })
}

/// Records one step, which is the last one if `is_canceled`.
fn log(
    recorder: &mut Recorder,
    settings: &TrialSettings,
    now: &mut TrialStep,
    is_canceled: bool,
) -> Result<(), RecordingError> {
    let step = now.reading.time as u64;
    let is_last = is_canceled || step >= settings.experiment.steps.min(RECORDED_STEPS);
    let mut messages = now.pilot.take_messages();
    if is_last && !is_canceled && step < settings.experiment.steps {
        let text =
            format!("the recording ends here; the trial goes on to step {}", settings.experiment.steps);
        messages.push(Message { level: Level::Event, text });
    }
    let score_every = SCORE_EVERY * settings.world.frame().len().div_ceil(SCORE_CELLS) as u64;
    let mut measured = Measured { messages: &messages, ..Measured::default() };
    if is_last || step.is_multiple_of(score_every) {
        let (mapper, truth) = (now.belief.mapper, now.world.truth());
        measured.scores = Some(map_scores(mapper, truth));
        measured.rate_errors = Some(RateErrors::from(&rate_scores(mapper, truth)));
    }
    recorder.log(&View::new(now.world, now.reading, now.belief, &*now.pilot, measured), is_last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use agent::AgentSettings;
    use controller::CellDrive;
    use evaluation::trials::{Experiment, TrialStrategy};
    use mapper::{MapperSettings, Paper};
    use std::path::Path;

    /// The first trial of the shipped world, of `steps` steps.
    fn experiment(steps: u64) -> Experiment {
        Experiment {
            worlds: vec![
                worldfile::grid::parse("two_blocks.toml", include_str!("../../worlds/two_blocks.toml"))
                    .unwrap(),
            ],
            estimators: vec![Paper.into()],
            strategies: vec![TrialStrategy::Agent("recency".parse().unwrap())],
            trials: 1,
            seed: 3,
            steps,
            mapper: MapperSettings::default(),
            agent: AgentSettings::default(),
            controller: CellDrive::settings(),
        }
    }

    fn recorded(steps: u64, file: &Path, is_canceled: bool) -> Recorded {
        let experiment = experiment(steps);
        let life = experiment.jobs()[0];
        let recorder = Recorder::new(Some(file), &[], life.world.into()).unwrap();
        record(&life, recorder, &is_canceled.into()).unwrap()
    }

    #[test]
    fn a_recording_does_not_change_the_trial() {
        let folder = tempfile::tempdir().unwrap();
        let Recorded { trial, problem } = recorded(400, &folder.path().join("trial.rrd"), false);
        assert!(problem.is_none(), "{problem:?}");
        let experiment = experiment(400);
        let alone = experiment.run(experiment.jobs(), &false.into(), |_| ()).unwrap();
        // As text: what is not a number is not equal to itself.
        assert_eq!(format!("{:?}", trial.unwrap()), format!("{:?}", alone[0]));
    }

    #[test]
    fn a_trial_that_is_given_up_leaves_a_whole_recording() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("trial.rrd");
        let Recorded { trial, problem } = recorded(400, &file, true);
        assert!(trial.is_none() && problem.is_none(), "{problem:?}");
        let bytes = std::fs::read(&file).unwrap();
        let stores = rerun::ChunkStore::from_rrd_reader(&rerun::ChunkStoreConfig::ALL_DISABLED, &mut &*bytes);
        assert_eq!(stores.unwrap().len(), 2, "the trial and its layout");
    }
}
