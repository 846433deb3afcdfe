//! How the simulated worlds are displayed.

mod grid;
mod physics;

use draw::scene::{Outline, RobotState, Scene, TimeUnit};
use draw::view::{Measured, View};
use interfaces::World;
use mapper::Mapper;
use robot::{Pilot, Turn};

/// The description of a world that can be displayed.
pub trait Displayed {
    /// The world at its start.
    fn scene(&self) -> Scene;
}

/// A world that can be displayed while a robot explores it.
pub trait Visible: World {
    /// The unit of time of the world.
    const UNIT: TimeUnit;

    /// The present states of the robots, in the order of [`Scene::robots`].
    fn robots<'a>(&'a self, reading: &'a Self::Reading) -> Vec<RobotState<'a>>;

    /// The present outlines of the obstacles, m, in the order of [`Scene::obstacles`]; `None` for an obstacle that
    /// is absent.
    fn obstacles(&self) -> Vec<Option<Outline>>;

    /// The state of the run after a turn of the robot.
    fn view<'a>(
        &'a self,
        turn: &'a Turn<Self::Reading, Self::Command>,
        mapper: &'a Mapper,
        pilot: &'a (impl Pilot<Command = Self::Command> + ?Sized),
        measured: Measured<'a>,
    ) -> View<'a> {
        let time = mapper.time();
        View {
            time,
            step: Self::UNIT.choose(mapper.readings() as u64, time as u64),
            mapper,
            features: turn.features,
            robots: self.robots(&turn.reading),
            belief: Some(&turn.belief).filter(|_| !self.poses_are_exact()),
            obstacles: self.obstacles(),
            path: pilot.path(),
            goal: pilot.goal(),
            strategies: pilot.strategies(turn.features),
            measured,
        }
    }
}
