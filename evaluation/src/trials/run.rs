use super::full_observation::FullyObserved;
use super::sampler::Sampler;
use super::{Experiment, Sample, Trial, TrialError, TrialStrategy, TrialWorld};
use crate::map_hash::map_hash;
use crate::metrics::rate_scores;
use crate::oracle::Oracle;

use agent::Features;
use interfaces::World;
use mapper::{EstimatorChoice, Mapper, MapperSettings};
use robot::{Autonomous, Belief, ExactPoses, GoalSelector, Pilot, Tour, explore};
use std::ops::ControlFlow;

/// Everything that determines a trial.
pub struct TrialSettings<'a, W: TrialWorld> {
    /// The number of the trial in the experiment, from 1 on, in the order of a report: by world, estimator, strategy
    /// and seed.
    pub number: u64,
    /// The world.
    pub world: &'a W,
    /// The estimator of rates.
    pub estimator: &'a EstimatorChoice,
    /// The strategy that chooses goals.
    pub strategy: &'a TrialStrategy,
    /// The seed of all random streams.
    pub seed: u64,
    /// The other settings.
    pub experiment: &'a Experiment<W>,
}

/// One reading of a trial.
pub struct TrialStep<'a, W: TrialWorld> {
    /// The world.
    pub world: &'a W::World,
    /// The reading.
    pub reading: &'a <W::World as World>::Reading,
    /// What the robot knows: the inputs of the pilot.
    pub belief: &'a Belief<'a>,
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
    let (seed, robot) = (trial.seed, &trial.experiment.robot);
    let own = trial.world.in_own_frame(robot, seed);
    let world = own.as_ref().unwrap_or(trial.world);
    let trial = &TrialSettings { world, ..*trial };
    match trial.strategy {
        TrialStrategy::Agent(policy) => {
            let agent = world.agent(robot, policy, seed)?;
            run(trial, world.pilot(robot, agent, seed)?, |_, _| (), observe)
        }
        TrialStrategy::Oracle => {
            run(trial, world.pilot(robot, world.oracle(), seed)?, Oracle::learn, observe)
        }
        TrialStrategy::FullObservation => {
            let stands = Tour::new(Vec::new(), false);
            run(trial, world.pilot(robot, stands, seed)?, |_, _| (), observe)
        }
    }
}

fn run<W: TrialWorld, G: GoalSelector>(
    trial: &TrialSettings<W>,
    mut pilot: Autonomous<G, W::Drive>,
    reveal: impl Fn(&mut G, &W::Truth),
    mut observe: impl FnMut(TrialStep<W>) -> bool,
) -> Result<Option<Trial>, TrialError> {
    let mut world = trial.world.start(trial.seed);
    let settings =
        MapperSettings { estimator: trial.estimator.clone(), ..trial.world.mapper(&trial.experiment.robot)? };
    let mut mapper = Mapper::new(&settings, *interfaces::GroundTruth::frame(W::truth(&world)))?;
    let mut sampler = Sampler::new(trial.experiment.length);
    let (mut collisions, mut rates) = (None, None);
    let mut step = |world: &W::World,
                    reading: &<W::World as World>::Reading,
                    belief: &Belief,
                    pilot: &mut Autonomous<G, W::Drive>| {
        let truth = W::truth(world);
        reveal(pilot.selector_mut(), truth);
        if let Some(count) = W::collisions(world) {
            *collisions.get_or_insert(0) += count;
        }
        let is_complete = sampler.is_complete(belief.mapper.time());
        let sample = sampler.update::<W>(belief.mapper, truth);
        if is_complete {
            rates = Some(rate_scores(belief.mapper, truth));
        }
        let goes_on = observe(TrialStep { world, reading, belief, pilot, sample, is_complete });
        pilot.take_messages(); // messages that `observe` has not taken must not accumulate
        Ok::<_, TrialError>(if goes_on && !is_complete {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        })
    };
    if *trial.strategy == TrialStrategy::FullObservation {
        let mut world = FullyObserved::<W>(world);
        explore(&mut world, &mut ExactPoses, &mut mapper, &mut pilot, |world, reading, belief, pilot| {
            step(&world.0, &reading.of_sensors, belief, pilot)
        })?;
    } else {
        let mut poses = trial.world.localization(&trial.experiment.robot, &mut world)?;
        explore(&mut world, poses.as_mut(), &mut mapper, &mut pilot, step)?;
    }
    Ok(rates.map(|rates| Trial {
        world: trial.world.name().to_owned(),
        estimator: trial.estimator.name().to_owned(),
        strategy: trial.strategy.name().to_owned(),
        seed: trial.seed,
        samples: sampler.into_samples(),
        strategy_share: pilot
            .strategies(Features::of(&mut mapper))
            .into_iter()
            .map(|strategy| (strategy.name, strategy.share))
            .collect(),
        false_change_events: rates.false_change_events,
        false_map_changes: rates.false_map_changes,
        collisions,
        map_hash: map_hash(&mapper),
    }))
}
