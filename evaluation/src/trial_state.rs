//! A run in a physics world in a state file: a run that goes on from there equals one that was never interrupted, bit for
//! bit.

use crate::observer::Observer;
use crate::physics_trial::PhysicsTrial;
use interfaces::{PoseMode, Twist, Values, value};
use robot::state::{Facts, LearnedFacts, LearnedSnapshot, State, StateError};
use robot::{Pilot, Settings};
use sim::physics::{WorldSnapshot, WorldSpec};
use xxhash_rust::xxh3::xxh3_64;

const WORLD: &str = "world";
const CONTENT: &str = "content";
const PILOT: &str = "pilot";
const MEASUREMENTS: &str = "measurements";
/// What the state of a run belongs to.
#[derive(Clone, Debug)]
pub struct TrialFacts {
    learned: LearnedFacts,
    world: Facts,
    /// What another build prints otherwise, though the world is the same.
    content: Facts,
    pilot: Facts,
    allows_other_build: bool,
}

impl TrialFacts {
    /// The facts of a run. `pilot` is what its pilot is made of, beside the settings.
    pub fn new(spec: &WorldSpec, seed: u64, settings: &Settings, pilot: Facts) -> Self {
        let Settings { mapper, agent, local_steps, drive, pose, localizer, .. } = settings;
        let localizer = (*pose == PoseMode::Localized).then_some(localizer);
        let content = xxh3_64(format!("{spec:?}").as_bytes());
        let world = Facts::default().with("world", &spec.name).with("seed", seed);
        let content = Facts::default().with("content of the world", format!("{content:016x}"));
        let pilot = pilot
            .with_settings("agent", agent)
            .with("local_steps", local_steps)
            .with_settings("drive", drive);
        let learned = LearnedFacts::new(mapper, &spec.frame, pose.name(), localizer);
        Self { learned, world, content, pilot, allows_other_build: false }
    }

    /// The same; with `allows`, a run can go on that another build has begun: its bits are those of neither build.
    #[must_use]
    pub fn allowing_other_build(self, allows: bool) -> Self {
        Self { allows_other_build: allows, ..self }
    }
}

/// A copy of the state of a run. A thread can turn it into bytes while the run goes on.
#[derive(Clone, Debug)]
pub struct TrialSnapshot {
    facts: TrialFacts,
    learned: LearnedSnapshot,
    world: WorldSnapshot,
    pilot: Vec<u8>,
    observer: Observer,
}

impl TrialSnapshot {
    /// The state for a file.
    pub fn into_state(self) -> State {
        let Self { facts, learned, world, pilot, observer } = self;
        let state = State::default()
            .with(WORLD, facts.world.clone(), world.into_bytes())
            .with(CONTENT, facts.content, Vec::new())
            .with(PILOT, facts.pilot, pilot)
            .with(MEASUREMENTS, facts.world.clone(), interfaces::to_bytes(&observer));
        learned.added_to(state).with_build()
    }
}

impl<P: Pilot<Command = Twist>> PhysicsTrial<P> {
    /// Copies the state of a run between two [turns](Self::turn). This is short.
    pub fn snapshot(&mut self, facts: &TrialFacts) -> TrialSnapshot {
        TrialSnapshot {
            facts: facts.clone(),
            learned: facts.learned.snapshot(&mut self.robot),
            world: self.world.snapshot(),
            pilot: interfaces::snapshot(self.pilot_values()),
            observer: self.observer.clone(),
        }
    }

    /// Goes on from a state that a run with the same facts has saved.
    ///
    /// # Errors
    ///
    /// When the state is of another run or of another build; the error names what differs. The run must not be used then.
    pub fn restore(&mut self, state: &State, facts: &TrialFacts) -> Result<(), StateError> {
        let misfit = |part: &str| StateError::OtherContent(part.to_owned());
        let world = state.section(WORLD, &facts.world)?;
        let (pilot, observer) =
            (state.section(PILOT, &facts.pilot)?, state.section(MEASUREMENTS, &facts.world)?);
        match state.check_build() {
            Err(other) if !facts.allows_other_build => return Err(other), // after what differs by a choice
            Err(_) => {}
            Ok(()) => drop(state.section(CONTENT, &facts.content)?),
        }
        facts.learned.restore(state, &mut self.robot)?;
        self.world.restore(world).map_err(|_| misfit(WORLD))?;
        interfaces::restore(self.pilot_values(), pilot).map_err(|_| misfit(PILOT))?;
        self.observer = interfaces::from_bytes(observer).map_err(|_| misfit(MEASUREMENTS))?;
        Ok(())
    }

    /// The values of the pilot and of its last command.
    fn pilot_values(&mut self) -> Values<'_> {
        let mut values = self.robot.pilot.values(&self.robot.mapper);
        values.push(value(&mut self.command));
        values
    }
}
