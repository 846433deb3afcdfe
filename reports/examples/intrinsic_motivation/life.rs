//! A robot in a world, from its first reading on, and how well it learns the rates.

use evaluation::metrics::{BrierOfAll, ChangingAccuracy, map_scores, mean_log_error};
use interfaces::{CellReading, Step};
use mapper::{EstimatorChoice, Mapper, MapperSettings};
use robot::{ExactPoses, Pilot, Robot, explore};
use sim::grid::{GridGroundTruth, GridSpec, GridWorld};
use std::ops::ControlFlow;

/// The steps at which the log error is kept.
pub(crate) const TIMES: [u64; 7] = [1000, 2000, 5000, 10_000, 20_000, 50_000, 100_000];
/// The lengths over which the log error is averaged.
pub(crate) const AREAS: [u64; 2] = [5000, 20_000];
/// The log error is averaged over one of this number of steps.
const SAMPLE_EVERY: u64 = 20;

/// What came of a life. A number that its length does not reach is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outcome {
    /// The mean log error over the first steps, for each of [`AREAS`].
    pub(crate) areas: [f64; AREAS.len()],
    /// The log error at [`TIMES`].
    pub(crate) errors: [f64; TIMES.len()],
    /// At 20,000 steps or at the end: the map quality, and the means so far of the balanced accuracy on changing cells and of
    /// the Brier score of the predicted map on them.
    pub(crate) map_quality: f64,
    pub(crate) changing: f64,
    pub(crate) brier: f64,
}

struct Measured {
    steps: u64,
    sum: f64,
    count: f64,
    changing: ChangingAccuracy,
    brier: BrierOfAll,
    outcome: Outcome,
}

impl Measured {
    fn new(steps: u64) -> Self {
        let (areas, errors) = ([f64::NAN; AREAS.len()], [f64::NAN; TIMES.len()]);
        let (map_quality, changing, brier) = (f64::NAN, f64::NAN, f64::NAN);
        let outcome = Outcome { areas, errors, map_quality, changing, brier };
        let (changing, brier) = (ChangingAccuracy::default(), BrierOfAll::default());
        Self { steps, sum: 0.0, count: 0.0, changing, brier, outcome }
    }

    fn measure(&mut self, step: u64, mapper: &Mapper, truth: &GridGroundTruth) {
        let last = self.steps.min(AREAS[1]);
        if let Some(time) = TIMES.iter().position(|time| *time == step) {
            self.outcome.errors[time] = mean_log_error(mapper, truth).unwrap_or(f64::NAN);
        }
        if step > last || !step.is_multiple_of(SAMPLE_EVERY) {
            return;
        }
        // Before anything has changed there is no error.
        if let Some(error) = mean_log_error(mapper, truth) {
            self.sum += error;
            self.count += 1.0;
        }
        self.changing.sample(mapper, truth);
        self.brier.sample(mapper, truth);
        if let Some(area) = AREAS.iter().position(|length| *length == step) {
            self.outcome.areas[area] = self.sum / self.count;
        }
        if step == last {
            self.outcome.map_quality = map_scores(mapper, truth).map_quality;
            self.outcome.changing = self.changing.scores().all.unwrap_or(f64::NAN);
            self.outcome.brier = self.brier.get().unwrap_or(f64::NAN);
        }
    }
}

/// Runs a life with measures. Returns the outcome, and the mapper.
pub(crate) fn live<P: Pilot<Command = Step>>(
    spec: &GridSpec,
    seed: u64,
    steps: u64,
    estimator: &EstimatorChoice,
    pilot: P,
    mut reveal: impl FnMut(&mut P, &Mapper, &GridGroundTruth),
) -> anyhow::Result<Outcome> {
    let mut measured = Measured::new(steps);
    run(spec, seed, steps, estimator, pilot, |step, pilot, mapper, truth| {
        measured.measure(step, mapper, truth);
        reveal(pilot, mapper, truth);
    })?;
    Ok(measured.outcome)
}

/// Runs a life. `observe` is called at every step. Returns the pilot.
pub(crate) fn run<P: Pilot<Command = Step>>(
    spec: &GridSpec,
    seed: u64,
    steps: u64,
    estimator: &EstimatorChoice,
    pilot: P,
    mut observe: impl FnMut(u64, &mut P, &Mapper, &GridGroundTruth),
) -> anyhow::Result<P> {
    let settings = MapperSettings { estimator: estimator.clone(), ..MapperSettings::default() };
    let mapper = Mapper::new(&settings, *spec.frame())?;
    let mut robot = Robot::<CellReading, P>::new(Box::new(ExactPoses), mapper, pilot);
    let mut world = GridWorld::new(spec, seed);
    explore(&mut world, &mut robot, |world, robot, _| {
        let step = world.time() as u64;
        observe(step, &mut robot.pilot, &robot.mapper, world.truth());
        robot.pilot.take_messages(); // they must not accumulate
        anyhow::Ok(if step >= steps { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    Ok(robot.pilot)
}
