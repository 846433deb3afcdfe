use super::{SettingsError, TrialStrategy};
use crate::metrics::{ChangingLooks, cell_map_scores, cell_rate_scores, false_change_events};
use crate::oracle::Oracle;
use crate::report::{Sample, Trial};
use crate::summary::map_hash;
use agent::{Agent, AgentSettings};
use controller::{CellDrive, Controller};
use interfaces::CellReading;
use interfaces::GroundTruth;
use mapper::{Mapper, MapperSettings, ReadingError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use robot::{Autonomous, Belief, GoalSelector, Pilot, explore};
use sim::grid::{GridSpec, GridTruth, GridWorld};
use std::ops::ControlFlow;

/// Points of a curve.
const SAMPLES: u64 = 80;
/// The changing cells are looked at once in so many steps, and at every sample.
const LOOK_EVERY: u64 = 10;

/// One trial before it begins.
#[derive(Clone, Debug)]
pub struct Life<'a> {
    /// Where.
    pub world: &'a GridSpec,
    /// How goals are chosen.
    pub strategy: TrialStrategy,
    /// The seed of all chance.
    pub seed: u64,
    /// How long, in steps.
    pub steps: u64,
    /// The mapper's settings.
    pub mapper: MapperSettings,
    /// The agent's settings.
    pub agent: &'a AgentSettings,
    /// The controller's settings.
    pub controller: controller::Settings,
}

/// A trial at one step.
pub struct Look<'a> {
    /// The world.
    pub world: &'a GridWorld,
    /// What was seen in this step.
    pub reading: &'a CellReading,
    /// What is known.
    pub belief: &'a Belief<'a>,
    /// Who decides.
    pub pilot: &'a mut dyn Pilot<Command = interfaces::Step>,
    /// What was measured in this step, if it was.
    pub sample: Option<&'a Sample>,
}

/// Streams of chance, one per purpose; the world has its own.
enum Purpose {
    Agent,
    Controller,
}

fn chance(seed: u64, purpose: Purpose) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(match purpose {
        Purpose::Agent => 1 << 32,
        Purpose::Controller => 2 << 32,
    });
    rng
}

/// Runs one trial. `watch` is called at every step; when it says false, the trial is given up.
///
/// # Errors
///
/// When settings make no sense.
pub fn live(life: &Life, mut watch: impl FnMut(Look) -> bool) -> Result<Option<Trial>, SettingsError> {
    let controller = chance(life.seed, Purpose::Controller);
    let controller = Controller::new(life.controller, CellDrive, controller)?;
    match life.strategy {
        TrialStrategy::Agent(choice) => {
            let sensor_radius_m = f64::from(life.world.sensor_radius()) * life.world.frame().resolution_m();
            let settings = AgentSettings { sensor_radius_m, ..life.agent.clone() };
            let agent = Agent::new(&settings, choice, chance(life.seed, Purpose::Agent))?;
            run(life, Autonomous::new(agent, controller), |_, _| (), &mut watch)
        }
        TrialStrategy::Oracle => {
            let oracle = Oracle::new(life.world);
            run(life, Autonomous::new(oracle, controller), Oracle::learn, &mut watch)
        }
    }
}

fn run<G: GoalSelector>(
    life: &Life,
    mut pilot: Autonomous<G, CellDrive>,
    teach: impl Fn(&mut G, &GridTruth),
    watch: &mut impl FnMut(Look) -> bool,
) -> Result<Option<Trial>, SettingsError> {
    let mut world = GridWorld::new(life.world, life.seed);
    let mut mapper = Mapper::new(&life.mapper, *life.world.frame())?;
    let mut samples = Vec::with_capacity(SAMPLES as usize);
    let (mut step, mut due) = (0, sample_step(0, life.steps));
    let (mut near, mut looks) = (Nearness::default(), ChangingLooks::default());
    let mut is_whole = false;
    explore(
        &mut world,
        &mut mapper,
        &mut pilot,
        |world, reading, belief, pilot| -> Result<_, ReadingError> {
            let truth = world.truth();
            teach(pilot.selector_mut(), truth);
            near.count(truth, reading);
            if step == due || step % LOOK_EVERY == 0 {
                looks.look(belief.mapper, truth);
            }
            let mut sample = None;
            if step == due {
                samples.push(measure(step, belief.mapper, truth, &near, &std::mem::take(&mut looks)));
                sample = samples.last();
                due = sample_step(samples.len() as u64, life.steps);
            }
            is_whole = step == life.steps;
            step += 1;
            let goes_on = watch(Look { world, reading, belief, pilot, sample });
            pilot.take_messages(); // those that nobody wanted must not pile up
            Ok(if goes_on && !is_whole { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        },
    )
    .expect("a grid world's readings make sense");
    Ok(is_whole.then(|| Trial {
        world: life.world.name().to_owned(),
        estimator: life.mapper.estimator.name().to_owned(),
        strategy: life.strategy.name().to_owned(),
        seed: life.seed,
        samples,
        strategy_share: pilot
            .strategies(mapper.features())
            .iter()
            .map(|strategy| (strategy.name.clone(), strategy.share))
            .collect(),
        false_change_events: false_change_events(&mapper, world.truth()),
        map_hash: map_hash(&mapper),
    }))
}

/// When the sample of a number is due: denser early, the last one at the end.
fn sample_step(number: u64, steps: u64) -> u64 {
    let part = (number + 1) as f64 / SAMPLES as f64;
    // Every one later than the one before, also in a short run.
    let step = (steps as f64 * part * part.sqrt()).round() as u64;
    if number >= SAMPLES { u64::MAX } else { step.max(number + 1).min(steps) }
}

fn measure(step: u64, mapper: &Mapper, truth: &GridTruth, near: &Nearness, looks: &ChangingLooks) -> Sample {
    let (rates, map) = (cell_rate_scores(mapper, truth), cell_map_scores(mapper, truth));
    let changing = looks.scores();
    Sample {
        step,
        rate_error: rates.rate_error,
        log_error: rates.log_error,
        map_quality: map.map_quality,
        map_quality_changing: changing.map_quality,
        coverage: map.coverage,
        false_rate: rates.false_rate,
        changing_share: near.changing_share(),
        brier: changing.brier,
        brier_last_seen: changing.brier_last_seen,
        brier_mean: changing.brier_mean,
    }
}

/// How much of its time the robot had cells in view that change.
#[derive(Default)]
struct Nearness {
    steps: u64,
    near: u64,
}

impl Nearness {
    fn count(&mut self, truth: &GridTruth, reading: &CellReading) {
        let is_swept =
            |&(cell, _): &(_, bool)| truth.frame().index(cell).is_some_and(|at| truth.is_swept(at));
        self.steps += 1;
        self.near += u64::from(reading.cells.iter().any(is_swept));
    }

    fn changing_share(&self) -> f64 {
        self.near as f64 / self.steps.max(1) as f64
    }
}
