use super::{Experiment, TrialStrategy};
use crate::map_hash::map_hash;
use crate::metrics::{ChangingAccuracy, Prediction, map_scores, rate_scores};
use crate::oracle::Oracle;
use crate::report::{Sample, Trial};
use agent::{Agent, AgentSettings, Features};
use controller::{CellDrive, Controller};
use interfaces::{CellReading, GroundTruth, Purpose, RandomStream, SettingsError, Step};
use mapper::{EstimatorChoice, Mapper, MapperSettings, ReadingError};
use robot::{Autonomous, Belief, GoalSelector, Pilot, explore};
use sim::grid::{GridGroundTruth, GridSpec, GridWorld};
use std::ops::ControlFlow;

/// The number of samples of a trial.
const SAMPLES: u64 = 80;
/// The swept cells are compared once in this number of steps, and at every sample.
const COMPARE_EVERY: u64 = 10;

/// Everything that determines a trial.
#[derive(Clone, Copy, Debug)]
pub struct TrialSettings<'a> {
    /// The world.
    pub world: &'a GridSpec,
    /// The estimator of rates.
    pub estimator: &'a EstimatorChoice,
    /// The strategy that chooses goals.
    pub strategy: &'a TrialStrategy,
    /// The seed of all random streams.
    pub seed: u64,
    /// The other settings.
    pub experiment: &'a Experiment,
}

/// One step of a trial.
pub struct TrialStep<'a> {
    /// The world.
    pub world: &'a GridWorld,
    /// The reading of this step.
    pub reading: &'a CellReading,
    /// What the robot knows: the inputs of the pilot.
    pub belief: &'a Belief<'a>,
    /// The pilot.
    pub pilot: &'a mut dyn Pilot<Command = Step>,
    /// The sample at this step; `None` for most steps.
    pub sample: Option<&'a Sample>,
}

/// Runs one trial. `observe` is called at every step; when it returns false, the trial is canceled and there
/// is no result.
///
/// # Errors
///
/// When a setting is out of range.
pub fn run_trial(
    trial: &TrialSettings,
    mut observe: impl FnMut(TrialStep) -> bool,
) -> Result<Option<Trial>, SettingsError> {
    let stream = RandomStream::new(trial.seed, Purpose::GridController);
    let controller = Controller::new(trial.experiment.controller, CellDrive, stream)?;
    match trial.strategy {
        TrialStrategy::Agent(policy) => {
            let sensor_radius_m = f64::from(trial.world.sensor_radius) * trial.world.frame().resolution_m();
            let settings = AgentSettings { sensor_radius_m, ..trial.experiment.agent.clone() };
            let agent = Agent::new(&settings, policy, RandomStream::new(trial.seed, Purpose::GridAgent))?;
            run(trial, Autonomous::new(agent, controller), |_, _| (), &mut observe)
        }
        TrialStrategy::Oracle => {
            let oracle = Oracle::new(trial.world);
            run(trial, Autonomous::new(oracle, controller), Oracle::learn, &mut observe)
        }
    }
}

fn run<G: GoalSelector>(
    trial: &TrialSettings,
    mut pilot: Autonomous<G, CellDrive>,
    reveal: impl Fn(&mut G, &GridGroundTruth),
    observe: &mut impl FnMut(TrialStep) -> bool,
) -> Result<Option<Trial>, SettingsError> {
    let mut world = GridWorld::new(trial.world, trial.seed);
    let Experiment { steps, mapper, .. } = trial.experiment;
    let settings = MapperSettings { estimator: trial.estimator.clone(), ..mapper.clone() };
    let mut mapper = Mapper::new(&settings, *trial.world.frame())?;
    let mut samples = Vec::with_capacity(SAMPLES as usize);
    let (mut step, mut due) = (0, sample_step(0, *steps));
    let mut measured = Measured::default();
    let mut is_complete = false;
    explore(
        &mut world,
        &mut mapper,
        &mut pilot,
        |world, reading, belief, pilot| -> Result<_, ReadingError> {
            let truth = world.truth();
            reveal(pilot.selector_mut(), truth);
            measured.count(truth, reading);
            if step == due || step % COMPARE_EVERY == 0 {
                measured.compare(belief.mapper, truth);
            }
            let mut sample = None;
            if step == due {
                samples.push(measured.sample(step, belief.mapper, truth));
                sample = samples.last();
                due = sample_step(samples.len() as u64, *steps);
            }
            is_complete = step == *steps;
            step += 1;
            let goes_on = observe(TrialStep { world, reading, belief, pilot, sample });
            pilot.take_messages(); // messages that `observe` has not taken must not accumulate
            Ok(if goes_on && !is_complete { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        },
    )
    .expect("a grid world gives valid readings");
    Ok(is_complete.then(|| Trial {
        world: trial.world.name.clone(),
        estimator: trial.estimator.name().to_owned(),
        strategy: trial.strategy.name().to_owned(),
        seed: trial.seed,
        samples,
        strategy_share: pilot
            .strategies(Features::of(&mut mapper))
            .into_iter()
            .map(|strategy| (strategy.name, strategy.share))
            .collect(),
        false_change_events: rate_scores(&mapper, world.truth()).false_change_events,
        map_hash: map_hash(&mapper),
    }))
}

/// The step of the sample of a number: denser early, the last one at the end.
fn sample_step(number: u64, steps: u64) -> u64 {
    let part = (number + 1) as f64 / SAMPLES as f64;
    // Every step later than the one before, also in a short trial.
    let step = (steps as f64 * part * part.sqrt()).round() as u64;
    if number >= SAMPLES { u64::MAX } else { step.max(number + 1).min(steps) }
}

/// What is measured between the samples.
#[derive(Default)]
struct Measured {
    steps: u64,
    /// The steps with a swept cell in view.
    steps_near_changes: u64,
    /// Since the last sample.
    accuracy: ChangingAccuracy,
    /// Since the last sample.
    prediction: Prediction,
}

impl Measured {
    fn count(&mut self, truth: &GridGroundTruth, reading: &CellReading) {
        let is_swept =
            |&(cell, _): &(_, bool)| truth.frame().index(cell).is_some_and(|index| truth.is_swept(index));
        self.steps += 1;
        self.steps_near_changes += u64::from(reading.cells.iter().any(is_swept));
    }

    fn compare(&mut self, mapper: &Mapper, truth: &GridGroundTruth) {
        self.accuracy.sample(mapper, truth);
        self.prediction.sample(mapper, truth);
    }

    fn sample(&mut self, step: u64, mapper: &Mapper, truth: &GridGroundTruth) -> Sample {
        let (rates, map) = (rate_scores(mapper, truth), map_scores(mapper, truth));
        let brier = std::mem::take(&mut self.prediction).scores();
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Sample {
            step,
            rate_error: or_nan(rates.rate_error_all),
            log_error: or_nan(rates.log_error),
            map_quality: map.map_quality,
            map_quality_changing: or_nan(std::mem::take(&mut self.accuracy).scores().all),
            coverage: map.coverage,
            false_rate: rates.false_rate_hz,
            changing_share: self.steps_near_changes as f64 / self.steps as f64,
            brier: or_nan(brier.brier),
            brier_last_seen: or_nan(brier.brier_last_seen),
            brier_mean: or_nan(brier.brier_mean),
        }
    }
}
