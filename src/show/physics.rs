//! A run in the physics world, as the recording and the pictures show it.

use crate::recording::{Recorder, RecordingError};
use crate::view::{ObstacleView, Outline, RobotView, Scene, Sight, StrategyView, TimeUnit, Trail, View};
use evaluation::observer::Observer;
use interfaces::Twist;
use robot::{Belief, Pilot};
use sim::physics::PhysicsWorld;

/// Shows a run to a recorder, and keeps the trails of the robots.
pub struct PhysicsShow {
    recorder: Option<Recorder>,
    trails: Vec<Trail>,
    /// Of every obstacle in the world file, present or not.
    outlines: Vec<Outline>,
}

impl PhysicsShow {
    /// Shows a run in `world` to `recorder`, if there is one.
    pub fn new(world: &PhysicsWorld, recorder: Option<Recorder>) -> Self {
        let obstacles = world.spec().obstacles().iter();
        Self {
            recorder,
            trails: world.robots().map(|robot| Trail::new(robot.name, robot.is_driven)).collect(),
            outlines: obstacles.map(|obstacle| obstacle.shape.corners().to_vec()).collect(),
        }
    }

    /// What stays the same for a whole run in this world.
    pub fn scene(world: &PhysicsWorld) -> Scene {
        Scene {
            title: world.spec().name().to_owned(),
            place: "house",
            unit: TimeUnit::Second,
            walls: world.walls().map(|corners| corners.to_vec()).collect(),
        }
    }

    /// Shows one tick, after `observer` has measured it.
    ///
    /// # Errors
    ///
    /// When the recording cannot go on.
    pub fn show(
        &mut self,
        world: &PhysicsWorld,
        belief: &Belief,
        pilot: &impl Pilot<Command = Twist>,
        observer: &Observer,
    ) -> Result<(), RecordingError> {
        for (trail, robot) in self.trails.iter_mut().zip(world.robots()) {
            trail.push(robot.pose.translation.vector.into());
        }
        let Some(mut recorder) = self.recorder.take() else { return Ok(()) };
        let result = self.with_view(world, belief, pilot, observer, |view| recorder.log(view));
        self.recorder = Some(recorder);
        result
    }

    /// Where the robots have been.
    pub fn trails(&self) -> &[Trail] {
        &self.trails
    }

    /// Why a viewer is not shown the run, or not any more.
    pub fn live_problem(&self) -> Option<String> {
        self.recorder.as_ref().and_then(Recorder::live_problem)
    }

    /// Closes the recording.
    ///
    /// # Errors
    ///
    /// When not all of it could be written.
    pub fn finish(
        &mut self,
        world: &PhysicsWorld,
        belief: &Belief,
        pilot: &impl Pilot<Command = Twist>,
        observer: &Observer,
    ) -> Result<(), RecordingError> {
        match self.recorder.take() {
            Some(recorder) => self.with_view(world, belief, pilot, observer, |view| recorder.finish(view)),
            None => Ok(()),
        }
    }

    /// Puts together what the run looks like now.
    fn with_view<T>(
        &self,
        world: &PhysicsWorld,
        belief: &Belief,
        pilot: &impl Pilot<Command = Twist>,
        observer: &Observer,
        log: impl FnOnce(&View) -> T,
    ) -> T {
        let robots: Vec<RobotView> = world
            .robots()
            .map(|robot| RobotView {
                name: robot.name,
                pose: robot.pose,
                radius_m: robot.radius_m,
                is_curious: robot.is_driven,
                sight: robot.sweep.map(|sweep| Sight::Laser(&sweep.reading)),
            })
            .collect();
        // Those that are there, where they are now; the others, where they were or will be.
        let mut outlines = self.outlines.clone();
        let mut present = vec![false; outlines.len()];
        for obstacle in world.obstacles() {
            outlines[obstacle.index] = obstacle.corners.to_vec();
            present[obstacle.index] = true;
        }
        let obstacles: Vec<ObstacleView> = world
            .spec()
            .obstacles()
            .iter()
            .zip(outlines.iter().zip(present))
            .map(|(obstacle, (outline, is_present))| ObstacleView {
                name: &obstacle.name,
                outline,
                is_present,
            })
            .collect();
        let states = pilot.strategies(belief.features);
        let strategies: Vec<StrategyView> = states.iter().map(StrategyView::from).collect();
        log(&View {
            time: belief.mapper.time(),
            step: belief.mapper.readings() as u64,
            mapper: belief.mapper,
            features: belief.features,
            robots: &robots,
            obstacles: &obstacles,
            path: pilot.path(),
            goal: pilot.goal(),
            scores: observer.scores(),
            rate_errors: None,
            strategies: &strategies,
            messages: observer.messages(),
        })
    }
}
