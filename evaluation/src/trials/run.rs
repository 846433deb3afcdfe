use super::full_observation::observed;
use super::sampler::Sampler;
use super::{Sample, Trial, TrialError, TrialSettings, TrialStrategy, TrialWorld};
use crate::map_hash::map_hash;
use crate::metrics::{RateScores, rate_scores};
use agent::Features;
use controller::Controller;
use interfaces::World;
use mapper::Mapper;
use robot::{Autonomous, ExactPoses, GoalSelector, Pilot, Robot, Tour, Turn, explore};
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

fn run<W: TrialWorld, G: GoalSelector>(
    trial: &TrialSettings<W>,
    selector: G,
    observe: impl FnMut(TrialStep<W>) -> bool,
) -> Result<Option<Trial>, TrialError> {
    let mut world = trial.world.start(trial.seed);
    let mut robot = W::robot(trial, &mut world, selector)?;
    let sampler = Sampler::new(trial.experiment.length);
    let mut measured = Measured { sampler, collisions: None, rates: None, observe };
    if *trial.strategy == TrialStrategy::FullObservation {
        let Robot { mapper, pilot, .. } = robot;
        let mut seeing = Robot::new(Box::new(ExactPoses), mapper, pilot);
        loop {
            let reading = world.sense();
            let Turn { belief, features, command, .. } = seeing.step(observed::<W>(&world, &reading))?;
            let turn = Turn { reading, belief, features, command };
            if measured.measure(&world, &mut seeing, &turn)?.is_break() {
                break;
            }
            world.act(&turn.command);
        }
        let Robot { mapper, pilot, .. } = seeing;
        return Ok(measured.result(trial, mapper, &pilot));
    }
    explore(&mut world, &mut robot, |world, robot, turn| measured.measure(world, robot, turn))?;
    let Robot { mapper, pilot, .. } = robot;
    Ok(measured.result(trial, mapper, &pilot))
}

/// The measurements of a trial.
struct Measured<O> {
    sampler: Sampler,
    collisions: Option<u64>,
    /// The rates at the end.
    rates: Option<RateScores>,
    observe: O,
}

impl<O> Measured<O> {
    fn measure<W: TrialWorld, G: GoalSelector, R>(
        &mut self,
        world: &W::World,
        robot: &mut Robot<R, Autonomous<G, Controller<W::Drive>>>,
        turn: &Turn<<W::World as World>::Reading, <W::World as World>::Command>,
    ) -> Result<ControlFlow<()>, TrialError>
    where
        O: FnMut(TrialStep<W>) -> bool,
    {
        let (truth, Robot { mapper, pilot, .. }) = (W::truth(world), &mut *robot);
        if let Some(count) = W::collisions(world) {
            *self.collisions.get_or_insert(0) += count;
        }
        let is_complete = self.sampler.is_complete(mapper.time());
        let sample = self.sampler.update::<W>(mapper, truth);
        if is_complete {
            self.rates = Some(rate_scores(mapper, truth));
        }
        let step = TrialStep { world, turn, mapper, pilot, sample, is_complete };
        let goes_on = (self.observe)(step) && !is_complete;
        robot.pilot.take_messages(); // messages that `observe` has not taken must not accumulate
        Ok(if goes_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    }

    /// The result; `None` of a trial that was canceled.
    fn result<W: TrialWorld>(
        self,
        trial: &TrialSettings<W>,
        mut mapper: Mapper,
        pilot: &impl Pilot,
    ) -> Option<Trial> {
        let Self { sampler, collisions, rates, .. } = self;
        let rates = rates?;
        let strategies = pilot.strategies(Features::of(&mut mapper)).into_iter();
        Some(Trial {
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
        })
    }
}
