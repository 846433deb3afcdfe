use super::sampler::Sampler;
use super::{Sample, Trial, TrialError, TrialSettings, TrialStrategy, TrialWorld};
use crate::map_hash::map_hash;
use crate::metrics::rate_scores;
use agent::Features;
use interfaces::{CellReading, GroundTruth, Reading, TrueState, World};
use mapper::Mapper;
use robot::{GoalSelector, Pilot, Robot, Tour, Turn, explore};
use std::ops::ControlFlow;

/// One turn of the robot of a trial.
pub struct TrialStep<'a, W: TrialWorld> {
    /// The world.
    pub world: &'a W::World,
    /// What the robot has made of the reading of its sensors.
    pub turn: &'a Turn<<W::World as World>::Reading, <W::World as World>::Command>,
    /// The map.
    pub mapper: &'a Mapper,
    /// The pilot.
    pub pilot: &'a mut dyn Pilot<Command = <W::World as World>::Command>,
    /// The sample at this reading; `None` for most readings.
    pub sample: Option<&'a Sample>,
    /// Whether this is the last reading of the trial.
    pub is_complete: bool,
}

/// Runs one trial. `observe` is called at every reading; when it returns false, the trial is canceled and there
/// is no result.
///
/// # Errors
///
/// When the trial cannot run.
pub fn run_trial<W: TrialWorld>(
    trial: &TrialSettings<W>,
    observe: impl FnMut(TrialStep<W>) -> bool,
) -> Result<Option<Trial>, TrialError> {
    let own = trial.world.in_own_frame(&trial.experiment.robot, trial.seed);
    let world = own.as_ref().unwrap_or(trial.world);
    let trial = &TrialSettings { world, ..*trial };
    match trial.strategy {
        TrialStrategy::Agent(policy) => run(trial, W::agent(trial, policy)?, observe),
        TrialStrategy::FullObservation => run(trial, Tour::new(Vec::new(), false), observe),
    }
}

/// Runs a trial whose robot drives to the goals of `selector`.
fn run<W: TrialWorld, G: GoalSelector>(
    trial: &TrialSettings<W>,
    selector: G,
    mut observe: impl FnMut(TrialStep<W>) -> bool,
) -> Result<Option<Trial>, TrialError> {
    let mut world = trial.world.start(trial.seed);
    let mut robot = W::robot(trial, &mut world, selector)?;
    let sees_all = *trial.strategy == TrialStrategy::FullObservation;
    let mut full_map = sees_all.then(|| robot.mapper.clone());
    let mut sampler = Sampler::new(trial.experiment.length);
    let (mut collisions, mut rates) = (None, None);
    explore(&mut world, &mut robot, |world, robot, turn| -> Result<_, TrialError> {
        let truth = W::truth(world);
        if let Some(map) = &mut full_map {
            map.update(&observed(truth, &turn.reading))?;
        }
        let Robot { mapper, pilot, .. } = robot;
        let mapper = full_map.as_ref().unwrap_or(mapper);
        if let Some(count) = W::collisions(world) {
            *collisions.get_or_insert(0) += count;
        }
        let is_complete = sampler.is_complete(mapper.time());
        let sample = sampler.update::<W>(mapper, truth);
        if is_complete {
            rates = Some(rate_scores(mapper, truth));
        }
        let goes_on = observe(TrialStep { world, turn, mapper, pilot, sample, is_complete }) && !is_complete;
        pilot.take_messages(); // messages that `observe` has not taken must not accumulate
        Ok(if goes_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    })?;
    let Some(rates) = rates else { return Ok(None) };
    let mut mapper = full_map.unwrap_or(robot.mapper);
    let strategies = robot.pilot.strategies(Features::of(&mut mapper)).into_iter();
    Ok(Some(Trial {
        world: trial.world.name().to_owned(),
        estimator: trial.estimator.name().to_owned(),
        strategy: trial.strategy.name().to_owned(),
        seed: trial.seed,
        samples: sampler.into_samples(),
        strategy_share: strategies.map(|strategy| (strategy.name, strategy.share)).collect(),
        false_change_events: rates.false_change_events,
        false_map_changes: rates.false_map_changes,
        collisions,
        map_hash: map_hash(&mapper),
    }))
}

/// The true state of every cell, except of cells that are partly covered, at the time and the pose of a reading. A map of these
/// readings has the errors of the estimator alone: it bounds what exploration can reach.
fn observed(truth: &impl GroundTruth, of_sensors: &impl Reading) -> CellReading {
    let frame = truth.frame();
    let cells = (0..frame.len()).filter_map(|index| match truth.state(index) {
        TrueState::PartlyCovered => None,
        state => Some((frame.cell(index), state == TrueState::Blocked)),
    });
    CellReading { time: of_sensors.time(), pose: *of_sensors.pose(), cells: cells.collect() }
}
