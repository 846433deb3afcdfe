//! The time of a step in a grid world: `cargo bench -p curious-evaluation --bench grid_loop`.
//!
//! Every benchmark simulates 20,000 steps and reports the steps per second. [`whole`] is the loop as the program
//! runs it, without metrics: sense, map, features, choose, plan, act. The other two replay recorded decisions:
//! [`known_goals`] does not choose goals, [`known_way`] in addition does not plan and follow paths. The differences
//! are the times of these parts.
//!
//! Two conditions must hold: `whole` in the world of 25 × 25 cells runs at 300,000 steps per second or more, and
//! `known_way` (everything except decisions) needs at most three times as long with 200 × 200 cells.

mod generated;

use agent::{Agent, AgentSettings, Features, Goal, Travel};
use controller::{CellDrive, Controller};
use divan::Bencher;
use divan::counter::ItemsCount;
use generated::generated;
use interfaces::{CellReading, Purpose, RandomStream, Step, Transition};
use mapper::{Mapper, MapperSettings};
use nalgebra::Isometry2;
use robot::{Autonomous, Belief, ExactPoses, GoalSelector, Pilot, Robot};
use sim::grid::{GridSpec, GridWorld};

const STEPS: usize = 20_000;
const SEED: u64 = 1;

/// The paper's world and random worlds, all with a sensor range of 4 cells, and how goals are chosen.
const RUNS: [(&str, &str); 6] = [
    ("two_blocks", "recency"),
    ("two_blocks", "curious"),
    ("25 x 25", "recency"),
    ("25 x 25", "curious"),
    ("200 x 200", "recency"),
    ("200 x 200", "curious"),
];

fn main() {
    divan::main();
}

fn world(name: &str) -> GridSpec {
    let side = match name {
        "25 x 25" => 25,
        "200 x 200" => 200,
        shipped => return worldfile::shipped::load_grid(shipped).expect("a shipped world is valid"),
    };
    generated(side, 4, SEED)
}

/// A robot in its world.
struct Run<P> {
    world: GridWorld,
    robot: Robot<CellReading, P>,
}

impl<P: Pilot<Command = Step>> Run<P> {
    fn new(spec: &GridSpec, pilot: P) -> Self {
        let mapper = Mapper::new(&MapperSettings::default(), *spec.frame()).expect("defaults make sense");
        Self { world: GridWorld::new(spec, SEED), robot: Robot::new(Box::new(ExactPoses), mapper, pilot) }
    }

    fn run(mut self) -> Self {
        let mut command = None;
        for _ in 0..STEPS {
            robot::turn(&mut self.world, &mut self.robot, &mut command).expect("its readings make sense");
            self.robot.pilot.take_messages();
        }
        self
    }
}

fn autonomous<G: GoalSelector>(selector: G) -> Autonomous<G, Controller<CellDrive>> {
    let controller = Controller::new(CellDrive, 42, RandomStream::new(SEED, Purpose::GridController));
    Autonomous::new(selector, controller)
}

fn agent(policy: &str) -> Agent {
    let policy = policy.parse().expect("a built-in policy");
    let rng = RandomStream::new(SEED, Purpose::GridAgent);
    Agent::new(&AgentSettings::default(), &policy, rng).expect("defaults make sense")
}

/// An agent, and its recorded decisions.
struct Remembering {
    agent: Agent,
    visits: Vec<Goal>,
}

impl GoalSelector for Remembering {
    fn next_goal(
        &mut self,
        pose: &Isometry2<f64>,
        mapper: &Mapper,
        travel: &mut impl Travel,
    ) -> Option<Goal> {
        let visit = self.agent.next_goal(pose, mapper, travel);
        self.visits.extend(visit);
        visit
    }

    fn observe(&mut self, features: Features, transitions: &[Transition]) {
        self.agent.observe(features, transitions);
    }

    fn reason(&self) -> String {
        self.agent.reason()
    }
}

/// Repeats recorded decisions.
struct Repeating(std::vec::IntoIter<Goal>);

impl GoalSelector for Repeating {
    fn next_goal(&mut self, _: &Isometry2<f64>, _: &Mapper, _: &mut impl Travel) -> Option<Goal> {
        self.0.next()
    }

    fn reason(&self) -> String {
        String::new()
    }
}

/// Records every command of a pilot.
struct Followed<P> {
    pilot: P,
    way: Vec<Step>,
}

impl<P: Pilot<Command = Step>> Pilot for Followed<P> {
    type Command = Step;

    fn command(&mut self, belief: &Belief, features: Features, mapper: &Mapper) -> Step {
        let step = self.pilot.command(belief, features, mapper);
        self.way.push(step);
        step
    }
}

/// Repeats recorded commands.
struct Way(std::vec::IntoIter<Step>);

impl Pilot for Way {
    type Command = Step;

    fn command(&mut self, _: &Belief, _: Features, _: &Mapper) -> Step {
        self.0.next().unwrap_or_default()
    }
}

fn bench<P: Pilot<Command = Step>>(bencher: Bencher<'_, '_>, spec: &GridSpec, pilot: impl Fn() -> P) {
    bencher
        .counter(ItemsCount::new(STEPS))
        .with_inputs(|| Run::new(spec, pilot()))
        .bench_local_values(Run::run);
}

/// The complete loop.
#[divan::bench(args = RUNS, sample_count = 20, sample_size = 1)]
fn whole(bencher: Bencher<'_, '_>, (name, policy): (&str, &str)) {
    bench(bencher, &world(name), || autonomous(agent(policy)));
}

/// The loop without the choice of goals.
#[divan::bench(args = RUNS, sample_count = 20, sample_size = 1)]
fn known_goals(bencher: Bencher<'_, '_>, (name, policy): (&str, &str)) {
    let spec = world(name);
    let remembering = Remembering { agent: agent(policy), visits: Vec::new() };
    let mut run = Run::new(&spec, autonomous(remembering)).run();
    let visits = std::mem::take(&mut run.robot.pilot.selector.visits);
    let robot = run.world.robot();
    let again = || autonomous(Repeating(visits.clone().into_iter()));
    assert_eq!(Run::new(&spec, again()).run().world.robot(), robot, "the same goals, the same way");
    bench(bencher, &spec, again);
}

/// The loop without the choice of goals, planning and path following.
#[divan::bench(args = RUNS, sample_count = 20, sample_size = 1)]
fn known_way(bencher: Bencher<'_, '_>, (name, policy): (&str, &str)) {
    let spec = world(name);
    let followed = Followed { pilot: autonomous(agent(policy)), way: Vec::with_capacity(STEPS) };
    let way = Run::new(&spec, followed).run().robot.pilot.way;
    bench(bencher, &spec, || Way(way.clone().into_iter()));
}
