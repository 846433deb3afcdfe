use crate::drives::Drive;
use crate::dynamic_obstacles::DynamicObstacleFilter;
use crate::navigation::{LocalExploration, NavigationTask, Progress, Surroundings, Tick, random_step};
use crate::planner::{Path, Planner};
use crate::settings::Settings;
use crate::situation::Situation;
use interfaces::{CellState, Grid, RandomStream, SettingsError, Values, values};
use nalgebra::Point2;

/// The state of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// There was no goal yet, or the goal was canceled.
    Idle,
    /// The robot drives to the goal.
    Travelling,
    /// The robot explores around the goal, or observes at the goal.
    Exploring,
    /// The goal is finished; the robot stops until the next goal.
    Finished(Outcome),
}

/// The outcome of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
pub enum Outcome {
    /// The robot reached the goal.
    Reached,
    /// The goal is blocked or hidden; the robot reached the nearest point that can be reached.
    Nearest,
    /// The goal was given up, because the robot was stuck for too long.
    GivenUp,
}

/// Drives the robot to a goal and explores around it (paper, section 2).
///
/// [`drive`](Self::drive) is called once per tick and returns no error. The [`Drive`] defines the type of the
/// commands. All random numbers come from the stream given at construction.
#[derive(Clone, Debug)]
pub struct Controller<D: Drive> {
    settings: Settings,
    drive: D,
    rng: RandomStream,
    surroundings: Option<Surroundings>,
    state: State,
    path: Path,
    /// The centroid of the last change, and its time.
    last_change: Option<(Point2<f64>, f64)>,
}

/// The present activity, with its data.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
enum State {
    Idle,
    /// A goal that was set since the last tick.
    New {
        goal: Point2<f64>,
        at_goal: AtGoal,
    },
    Travelling {
        task: NavigationTask,
        at_goal: AtGoal,
    },
    Exploring {
        done: Done,
        exploration: LocalExploration,
        step: NavigationTask,
    },
    Watching {
        done: Done,
        until: f64,
    },
    Finished(Done),
}

/// What the robot does at the goal.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
enum AtGoal {
    Explore,
    /// Stop for this duration, s (steps in a grid world).
    Watch(f64),
}

/// A goal, and the outcome of the navigation to it.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct Done {
    goal: Point2<f64>,
    outcome: Outcome,
}

impl<D: Drive> Controller<D> {
    /// A controller without a goal.
    ///
    /// # Errors
    ///
    /// When a setting is out of range or contradicts another; the error names it.
    pub fn new(settings: Settings, drive: D, rng: RandomStream) -> Result<Self, SettingsError> {
        settings.check()?;
        let (state, path) = (State::Idle, Path::default());
        Ok(Self { settings, drive, rng, surroundings: None, state, path, last_change: None })
    }

    /// Sets a goal in the frame of the map, m: the robot drives there, then explores around it. Replaces any other
    /// goal. A goal outside of the map is replaced by the nearest point in the map.
    pub fn set_goal(&mut self, goal: Point2<f64>) {
        self.start(goal, AtGoal::Explore);
    }

    /// Sets a goal as [`set_goal`](Self::set_goal) does, but without local exploration: for a tour.
    pub fn go_to(&mut self, goal: Point2<f64>) {
        self.watch_at(goal, 0.0);
    }

    /// Sets a goal as [`set_goal`](Self::set_goal) does, but with a stop of `duration` at the goal (s; steps in a
    /// grid world) instead of local exploration. A duration that is NaN counts as 0.
    pub fn watch_at(&mut self, goal: Point2<f64>, duration: f64) {
        self.start(goal, AtGoal::Watch(duration.max(0.0)));
    }

    fn start(&mut self, goal: Point2<f64>, at_goal: AtGoal) {
        self.state = State::New { goal, at_goal };
        self.path.clear();
    }

    /// Cancels the goal; the robot stops.
    pub fn cancel(&mut self) {
        self.state = State::Idle;
        self.path.clear();
    }

    /// Forgets the map: the next one is not the last one with some changes. A path to the goal is planned anew; a local
    /// exploration ends.
    pub fn forget_map(&mut self) {
        (self.surroundings, self.last_change) = (None, None);
        self.path.clear();
        self.state = match std::mem::replace(&mut self.state, State::Idle) {
            State::Travelling { task, at_goal } => State::New { goal: *task.goal(), at_goal },
            State::Exploring { done, .. } => State::Finished(done),
            other => other,
        };
    }

    /// Writes the travel time from the robot to each cell at full speed, in row-major order, s (steps in a grid
    /// world); ∞ where no path is known. Call it after [`drive`](Self::drive), which applies the changes of the
    /// map. The computing time is that of one wave over the whole map.
    pub fn travel_times(&mut self, situation: &Situation, times: &mut Vec<f64>) {
        let body = self.drive.body();
        times.clear();
        times.resize(situation.map.frame().len(), f64::INFINITY);
        if let Some(surroundings) = &mut self.surroundings {
            surroundings.planner.lengths_m(situation.map, &situation.position(), times);
            times.iter_mut().for_each(|time| *time /= body.speed_mps);
        }
    }

    /// The state after the last tick.
    pub fn status(&self) -> Status {
        match self.state {
            State::Idle => Status::Idle,
            State::New { .. } | State::Travelling { .. } => Status::Travelling,
            State::Exploring { .. } | State::Watching { .. } => Status::Exploring,
            State::Finished(done) => Status::Finished(done.outcome),
        }
    }

    /// The last goal; `None` before the first goal, and after the goal was canceled.
    pub fn goal(&self) -> Option<&Point2<f64>> {
        match &self.state {
            State::Idle => None,
            State::New { goal, .. } => Some(goal),
            State::Travelling { task, .. } => Some(task.goal()),
            State::Exploring { done, .. } | State::Watching { done, .. } | State::Finished(done) => {
                Some(&done.goal)
            }
        }
    }

    /// The present path, from the position where it was planned to its end, m; empty without a path.
    pub fn path(&self) -> &[Point2<f64>] {
        self.path.points()
    }

    /// Returns the command for this tick. After a new goal was set, the method may be called again in the same
    /// tick, with the same situation but without its transitions; the robot then starts without delay.
    pub fn drive(&mut self, situation: &Situation) -> D::Command {
        if let Some(change) = situation.change() {
            self.last_change = Some((change, situation.time));
        }
        let mut surroundings = self.update_surroundings(situation);
        let settings = self.settings.navigation;
        let tick = &mut Tick { settings: &settings, situation, surroundings: &mut surroundings };
        let command = match std::mem::replace(&mut self.state, State::Idle) {
            State::Idle => self.drive.rest(&tick.scene()),
            State::New { goal, at_goal } => {
                let task = NavigationTask::new(situation, goal, f64::INFINITY, settings.goal_timeout_s);
                self.travel(tick, task, at_goal)
            }
            State::Travelling { task, at_goal } => self.travel(tick, task, at_goal),
            State::Exploring { done, exploration, step } => self.explore(tick, done, exploration, step),
            State::Watching { done, until } => self.watch(tick, done, until),
            State::Finished(done) => self.finish(tick, done),
        };
        self.surroundings = Some(surroundings);
        command
    }

    /// Returns the command for a tick in which the robot does not drive to its goal: it rests, or looks around.
    pub fn pause(&mut self, situation: &Situation, looks_around: bool) -> D::Command {
        let mut surroundings = self.update_surroundings(situation);
        let settings = self.settings.navigation;
        let scene = Tick { settings: &settings, situation, surroundings: &mut surroundings };
        let scene = &scene.scene();
        let command = if looks_around { self.drive.look_around(scene) } else { self.drive.rest(scene) };
        self.surroundings = Some(surroundings);
        command
    }

    /// Applies the changes of the map. Reads the whole map at the first tick, and when the frame of the map has
    /// changed.
    fn update_surroundings(&mut self, situation: &Situation) -> Surroundings {
        let map = situation.map;
        let known = self.surroundings.take().filter(|known| known.planner.costmap().frame() == map.frame());
        let mut surroundings = match known {
            Some(mut known) => {
                known.planner.update(situation.transitions);
                known
            }
            None => self.surroundings_of(map),
        };
        surroundings.dynamic.update(situation);
        surroundings
    }

    fn surroundings_of(&self, map: &Grid<CellState>) -> Surroundings {
        let body = self.drive.body();
        let planner = Planner::new(&self.settings.inflation, body.radius_m, body.moves, map);
        Surroundings { planner, dynamic: DynamicObstacleFilter::new(map) }
    }

    /// Everything that a tick changes and a later tick needs: what a state file holds of the controller. `map` is the map
    /// of the last tick; what follows from it is not in the list.
    pub fn values(&mut self, map: &Grid<CellState>) -> Values<'_> {
        let surroundings = self.surroundings.take().unwrap_or_else(|| self.surroundings_of(map));
        let surroundings = self.surroundings.insert(surroundings);
        let mut values = values![self.rng, self.state, self.path, self.last_change];
        values.extend([surroundings.planner.value(), surroundings.dynamic.value()]);
        values.extend(self.drive.values());
        values
    }

    fn travel(&mut self, tick: &mut Tick, mut task: NavigationTask, at_goal: AtGoal) -> D::Command {
        let outcome = match task.drive(tick, &mut self.path, &mut self.drive) {
            Progress::Underway(command) => {
                self.state = State::Travelling { task, at_goal };
                return command;
            }
            Progress::Arrived(end) if end.is_goal => Outcome::Reached,
            Progress::Arrived(_) => Outcome::Nearest,
            Progress::GivenUp => Outcome::GivenUp,
        };
        let done = Done { goal: *task.goal(), outcome };
        match at_goal {
            _ if outcome == Outcome::GivenUp => self.finish(tick, done),
            AtGoal::Explore => self.step(tick, done, LocalExploration::default()),
            AtGoal::Watch(duration) => self.watch(tick, done, tick.situation.time + duration),
        }
    }

    fn watch(&mut self, tick: &Tick, done: Done, until: f64) -> D::Command {
        if tick.situation.time >= until {
            return self.finish(tick, done);
        }
        self.state = State::Watching { done, until };
        self.path.clear();
        self.drive.rest(&tick.scene())
    }

    fn explore(
        &mut self,
        tick: &mut Tick,
        done: Done,
        exploration: LocalExploration,
        mut step: NavigationTask,
    ) -> D::Command {
        let progress = step.drive(tick, &mut self.path, &mut self.drive);
        let has_lasted = step.elapsed_s(tick.situation) >= self.drive.body().step_s;
        let command = match progress {
            Progress::Underway(command) => command,
            Progress::Arrived(_) if !has_lasted => self.drive.rest(&tick.scene()),
            _ => return self.step(tick, done, exploration),
        };
        self.state = State::Exploring { done, exploration, step };
        command
    }

    /// Begins the next step of local exploration, or finishes the goal.
    fn step(&mut self, tick: &mut Tick, done: Done, mut exploration: LocalExploration) -> D::Command {
        let (body, situation) = (self.drive.body(), tick.situation);
        let is_new = |(_, time): &(_, f64)| situation.time - time < body.step_s;
        let change = self.last_change.filter(is_new).map(|(change, _)| change);
        let costmap = tick.surroundings.planner.costmap();
        let random = || random_step(&body, costmap, &situation.position(), &mut self.rng);
        let Some(target) = exploration.next(&self.settings.exploration, change, random) else {
            return self.finish(tick, done);
        };
        let mut step = NavigationTask::new(situation, target, body.step_m, body.step_limit_s);
        let command = match step.drive(tick, &mut self.path, &mut self.drive) {
            Progress::Underway(command) => command,
            _ => self.drive.rest(&tick.scene()),
        };
        self.state = State::Exploring { done, exploration, step };
        command
    }

    fn finish(&mut self, tick: &Tick, done: Done) -> D::Command {
        self.state = State::Finished(done);
        self.path.clear();
        self.drive.rest(&tick.scene())
    }
}
