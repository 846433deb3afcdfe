//! A run in a physics world in a state file: a run that goes on from there equals one that was never interrupted, bit for
//! bit.

use crate::observer::Observer;
use crate::physics_trial::PhysicsTrial;
use interfaces::{Twist, Values, from_bytes, to_bytes, value};
use robot::state::{Part, SavedSettings, Sessions, State, StateCopy, StateError, learned, restore};
use robot::{Pilot, Settings};
use sim::physics::WorldSpec;
use xxhash_rust::xxh3::xxh3_64;

/// What the state of a run belongs to.
#[derive(Clone, Debug)]
pub struct TrialFacts {
    settings: Settings,
    run: SavedSettings,
    /// What another build prints otherwise, though the world is the same.
    content: u64,
    /// Whether a run can go on that another build has begun: its bits are those of neither build.
    pub allows_other_build: bool,
}

/// The run in a state: the content of its world, the world, the pilot, the measurements.
type SavedRun = (u64, Vec<u8>, Vec<u8>, Observer);

impl TrialFacts {
    /// The facts of a run. `pilot` is what its pilot is made of, beside the settings.
    pub fn new(spec: &WorldSpec, seed: u64, settings: &Settings, pilot: SavedSettings) -> Self {
        let run = pilot.with("world", &spec.name).with("seed", &seed);
        let run = run.with("pose", &settings.pose.name()).with("", settings);
        let content = xxh3_64(format!("{spec:?}").as_bytes());
        Self { settings: settings.clone(), run, content, allows_other_build: false }
    }
}

impl<P: Pilot<Command = Twist>> PhysicsTrial<P> {
    /// Copies the state of a run between two [turns](Self::turn).
    pub fn snapshot(&mut self, facts: &TrialFacts, sessions: &Sessions) -> StateCopy {
        let learned = learned(&mut self.robot, &facts.settings, sessions);
        let (settings, content, world) = (facts.run.clone(), facts.content, self.world.snapshot());
        let (pilot, observer) = (interfaces::snapshot(self.pilot_values()), self.observer.clone());
        Box::new(move || {
            let run: SavedRun = (content, world.into_bytes(), pilot, observer);
            State { run: Some(Part { settings, bytes: to_bytes(&run) }), ..learned() }
        })
    }

    /// Goes on from a state that a run with the same facts has saved.
    ///
    /// # Errors
    ///
    /// When the state is of another run or of another build; the error names what differs. The run must not be used then.
    pub fn restore(&mut self, state: &State, facts: &TrialFacts) -> Result<(), StateError> {
        let run = state.run.as_ref().ok_or(StateError::NoPart("run"))?;
        run.settings.check(&facts.run)?;
        let (content, world, pilot, observer): SavedRun = from_bytes(&run.bytes)?;
        match state.check_build() {
            Err(other) if !facts.allows_other_build => return Err(other), // after what differs by a choice
            Ok(()) if content != facts.content => return Err(StateError::OtherWorld),
            _ => {}
        }
        restore(state, &mut self.robot, &facts.settings)?;
        self.world.restore(&world).map_err(|_| StateError::Damaged)?;
        interfaces::restore(self.pilot_values(), &pilot)?;
        self.observer = observer;
        Ok(())
    }

    /// The values of the pilot and of its last command.
    fn pilot_values(&mut self) -> Values<'_> {
        let mut values = self.robot.pilot.values(&self.robot.mapper);
        values.push(value(&mut self.command));
        values
    }
}
