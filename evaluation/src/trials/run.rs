use super::sampler::Sampler;
use super::{Trial, TrialError, TrialSettings, TrialStrategy, TrialWorld};
use crate::map_hash::map_hash;
use crate::metrics::rate_scores;
use agent::Features;
use interfaces::{CellReading, GroundTruth, Reading, TrueState};
use robot::{GoalSelector, Pilot, Tour, explore};
use std::ops::ControlFlow;

/// Runs one trial. `goes_on` is called at every reading; when it returns false, the trial is canceled and there is no result.
///
/// # Errors
/// When the trial cannot run.
pub fn run_trial<W: TrialWorld>(
    trial: &TrialSettings<W>,
    goes_on: impl FnMut() -> bool,
) -> Result<Option<Trial>, TrialError> {
    let own = trial.world.in_own_frame(&trial.experiment.robot, trial.seed);
    let world = own.as_ref().unwrap_or(trial.world);
    let trial = &TrialSettings { world, ..*trial };
    match trial.strategy {
        TrialStrategy::Agent(policy) => run(trial, W::agent(trial, policy)?, goes_on),
        TrialStrategy::FullObservation => run(trial, Tour::new(Vec::new(), false), goes_on),
    }
}

/// Runs a trial whose robot drives to the goals of `selector`.
fn run<W: TrialWorld, G: GoalSelector>(
    trial: &TrialSettings<W>,
    selector: G,
    mut goes_on: impl FnMut() -> bool,
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
        let mapper = full_map.as_ref().unwrap_or(&robot.mapper);
        if let Some(count) = W::collisions(world) {
            *collisions.get_or_insert(0) += count;
        }
        sampler.update::<W>(mapper, truth);
        let is_complete = sampler.is_complete(mapper.time());
        if is_complete {
            rates = Some(rate_scores(mapper, truth));
        }
        robot.pilot.take_messages(); // they must not accumulate
        Ok(if goes_on() && !is_complete { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
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
