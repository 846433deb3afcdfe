//! A trial that is recorded while it runs, in any kind of world.

use draw::view::Measured;
use evaluation::metrics::{RateErrors, map_scores, rate_scores};
use evaluation::scenes::Visible;
use evaluation::trials::{Trial, TrialError, TrialSettings, TrialStep, TrialWorld, run_trial};
use robot::{Level, Message};
use std::sync::atomic::{AtomicBool, Ordering};
use viewer::recording::{Recorder, RecordingError};

/// Later readings are not recorded, so that the file stays a few megabytes large.
pub(super) const RECORDED_READINGS: usize = 20_000;

/// Scores take a pass over the map: once in this many readings in a map of up to [`SCORE_CELLS`] cells, and
/// less often in a larger map.
const SCORE_EVERY: usize = 10;
/// See [`SCORE_EVERY`].
const SCORE_CELLS: usize = 10_000;

/// The outcome of a recorded trial.
#[derive(Debug)]
pub(super) struct Recorded {
    /// The trial, the same as without a recording; `None` if it was canceled.
    pub(super) trial: Option<Trial>,
    /// Why a part of the trial is not in the recording; `None` if the recording is complete. The trial has
    /// continued.
    pub(super) problem: Option<RecordingError>,
}

/// Runs one trial and records its first readings. When `is_canceled` is set, the trial stops, and the recording
/// so far is kept.
///
/// # Errors
///
/// When the trial cannot run.
pub(super) fn record<W: TrialWorld<World: Visible>>(
    settings: &TrialSettings<W>,
    mut recorder: Recorder,
    is_canceled: &AtomicBool,
) -> Result<Recorded, TrialError> {
    let mut problem = None;
    let trial = run_trial(settings, |mut step| {
        let is_canceled = is_canceled.load(Ordering::Relaxed);
        if problem.is_none() && step.mapper.readings() <= RECORDED_READINGS + 1 {
            problem = log(&mut recorder, settings, &mut step, is_canceled).err();
        }
        !is_canceled
    })?;
    Ok(Recorded { trial, problem })
}

/// Records one reading, which is the last one if `is_canceled`.
fn log<W: TrialWorld<World: Visible>>(
    recorder: &mut Recorder,
    settings: &TrialSettings<W>,
    now: &mut TrialStep<W>,
    is_canceled: bool,
) -> Result<(), RecordingError> {
    let (mapper, truth) = (now.mapper, W::truth(now.world));
    // The first reading is that of the start.
    let steps = mapper.readings() - 1;
    let is_over = now.is_complete;
    let is_last = is_canceled || is_over || steps >= RECORDED_READINGS;
    let mut messages = now.pilot.take_messages();
    if is_last && !is_canceled && !is_over {
        let end = W::length(settings.experiment.length).end();
        let text = format!("the recording ends here; the trial goes on to {end}");
        messages.push(Message { level: Level::Event, text });
    }
    let score_every = SCORE_EVERY * mapper.frame().len().div_ceil(SCORE_CELLS);
    let mut measured = Measured { messages: &messages, ..Measured::default() };
    if is_last || steps.is_multiple_of(score_every) {
        let (scores, errors) = (map_scores(mapper, truth), RateErrors::from(&rate_scores(mapper, truth)));
        measured.coverage_and_quality = Some([scores.coverage, scores.map_quality]);
        measured.rate_errors = Some([errors.relative, errors.log]);
    }
    recorder.log(&now.world.view(now.turn, mapper, &*now.pilot, measured), is_last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use evaluation::scenes::Displayed;
    use evaluation::trials::{Experiment, GridRobot, TrialStrategy};
    use mapper::Paper;
    use sim::grid::GridSpec;
    use std::path::Path;

    /// The first trial of the shipped world, of `steps` steps.
    fn experiment(steps: u64) -> Experiment<GridSpec> {
        Experiment {
            worlds: vec![
                worldfile::grid::parse("two_blocks.toml", include_str!("../../../worlds/two_blocks.toml"))
                    .unwrap(),
            ],
            estimators: vec![Paper.into()],
            strategies: vec![TrialStrategy::Agent("recency".parse().unwrap())],
            trials: 1,
            seed: 3,
            length: steps,
            robot: GridRobot::default(),
        }
    }

    fn recorded(steps: u64, file: &Path, is_canceled: bool) -> Recorded {
        let experiment = experiment(steps);
        let life = experiment.jobs().remove(0);
        let recorder = Recorder::new(Some(file), &[], life.world.scene()).unwrap();
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
