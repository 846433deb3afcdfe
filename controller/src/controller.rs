use crate::driver::{ControlInput, Driver, DriverView, Outcome, Status};
use crate::drives::Drive;
use crate::dynamic_obstacles::DynamicObstacleFilter;
use crate::navigation::{LocalExploration, NavigationTask, Progress, Surroundings, Tick, random_step};
use crate::planner::{Path, Planner};
use interfaces::{CellState, Grid, RandomStream, Values, values};
use nalgebra::Point2;

/// Drives the robot to a goal and explores around it (paper, section 2).
///
/// [`drive`](Driver::drive) is called once per tick and returns no error. The [`Drive`] defines the type of the
/// commands. All random numbers come from the stream given at construction.
#[derive(Clone, Debug)]
pub struct Controller<D: Drive> {
    drive: D,
    /// The maximum number of steps of local exploration.
    max_steps: u32,
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
    /// A goal that was set since the last tick; with `watch`, the robot stops there for this duration, s (steps in a grid world).
    New {
        goal: Point2<f64>,
        watch: Option<f64>,
    },
    Travelling {
        task: NavigationTask,
        watch: Option<f64>,
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

/// A goal, and the outcome of the navigation to it.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct Done {
    goal: Point2<f64>,
    outcome: Outcome,
}

impl<D: Drive> Controller<D> {
    /// A controller without a goal, with at most this number of steps of local exploration at a goal; 42 in the paper.
    pub fn new(drive: D, max_steps: u32, rng: RandomStream) -> Self {
        let (state, path) = (State::Idle, Path::default());
        Self { drive, max_steps, rng, surroundings: None, state, path, last_change: None }
    }
}

impl<D: Drive> Driver for Controller<D> {
    type Command = D::Command;

    fn set_goal(&mut self, goal: Point2<f64>, watch: Option<f64>) {
        self.state = State::New { goal, watch: watch.map(|duration| duration.max(0.0)) };
        self.path.clear();
    }

    fn cancel(&mut self) {
        self.state = State::Idle;
        self.path.clear();
    }

    fn view(&self) -> DriverView<'_> {
        let (goal, status) = match &self.state {
            State::Idle => (None, Status::Idle),
            State::New { goal, .. } => (Some(*goal), Status::Travelling),
            State::Travelling { task, .. } => (Some(*task.goal()), Status::Travelling),
            State::Exploring { done, .. } | State::Watching { done, .. } => {
                (Some(done.goal), Status::Exploring)
            }
            State::Finished(done) => (Some(done.goal), Status::Finished(done.outcome)),
        };
        DriverView { path: self.path.points(), goal, status, trouble: "no path leads nearer to it" }
    }

    fn drive(&mut self, input: &ControlInput) -> D::Command {
        if let Some(change) = input.change() {
            self.last_change = Some((change, input.time));
        }
        let mut surroundings = self.update_surroundings(input);
        let tick = &mut Tick { input, surroundings: &mut surroundings };
        let command = match std::mem::replace(&mut self.state, State::Idle) {
            State::Idle => self.drive.rest(&tick.scene()),
            State::New { goal, watch } => {
                let task = NavigationTask::new(input, goal, f64::INFINITY, self.drive.body().goal_timeout_s);
                self.travel(tick, task, watch)
            }
            State::Travelling { task, watch } => self.travel(tick, task, watch),
            State::Exploring { done, exploration, step } => self.explore(tick, done, exploration, step),
            State::Watching { done, until } => self.watch(tick, done, until),
            State::Finished(done) => self.finish(tick, done),
        };
        self.surroundings = Some(surroundings);
        command
    }

    fn pause(&mut self, input: &ControlInput, looks_around: bool) -> D::Command {
        let mut surroundings = self.update_surroundings(input);
        let tick = Tick { input, surroundings: &mut surroundings };
        let rests = if looks_around { D::look_around } else { D::rest };
        let command = rests(&mut self.drive, &tick.scene());
        self.surroundings = Some(surroundings);
        command
    }

    fn travel_times(&mut self, input: &ControlInput, times: &mut Vec<f64>) {
        let body = self.drive.body();
        times.clear();
        times.resize(input.map.frame().len(), f64::INFINITY);
        if let Some(surroundings) = &mut self.surroundings {
            surroundings.planner.lengths_m(input.map, &input.position(), times);
            times.iter_mut().for_each(|time| *time /= body.speed_mps);
        }
    }

    fn forget_map(&mut self) {
        (self.surroundings, self.last_change) = (None, None);
        self.path.clear();
        self.state = match std::mem::replace(&mut self.state, State::Idle) {
            State::Travelling { task, watch } => State::New { goal: *task.goal(), watch },
            State::Exploring { done, .. } => State::Finished(done),
            other => other,
        };
    }

    fn values(&mut self, map: &Grid<CellState>) -> Values<'_> {
        let surroundings = self.surroundings.take().unwrap_or_else(|| self.surroundings_of(map));
        let surroundings = self.surroundings.insert(surroundings);
        let dynamic = surroundings.dynamic.value();
        let mut values =
            values![self.rng, self.state, self.path, self.last_change; surroundings.planner, self.drive];
        values.push(dynamic);
        values
    }
}

impl<D: Drive> Controller<D> {
    /// Applies the changes of the map. Reads the whole map at the first tick, and when the frame of the map has
    /// changed.
    fn update_surroundings(&mut self, input: &ControlInput) -> Surroundings {
        let map = input.map;
        let known = self.surroundings.take().filter(|known| known.planner.costmap().frame() == map.frame());
        let mut surroundings = match known {
            Some(mut known) => {
                known.planner.update(input.transitions);
                known
            }
            None => self.surroundings_of(map),
        };
        surroundings.dynamic.update(input);
        surroundings
    }

    fn surroundings_of(&self, map: &Grid<CellState>) -> Surroundings {
        let body = self.drive.body();
        let planner = Planner::new(&body.inflation, body.radius_m, body.moves, map);
        Surroundings { planner, dynamic: DynamicObstacleFilter::new(map) }
    }

    fn travel(&mut self, tick: &mut Tick, mut task: NavigationTask, watch: Option<f64>) -> D::Command {
        let outcome = match task.drive(tick, &mut self.path, &mut self.drive) {
            Progress::Underway(command) => {
                self.state = State::Travelling { task, watch };
                return command;
            }
            Progress::Arrived(end) if end.is_goal => Outcome::Reached,
            Progress::Arrived(_) => Outcome::Nearest,
            Progress::GivenUp => Outcome::GivenUp,
        };
        let done = Done { goal: *task.goal(), outcome };
        match watch {
            _ if outcome == Outcome::GivenUp => self.finish(tick, done),
            None => self.step(tick, done, LocalExploration::default()),
            Some(duration) => self.watch(tick, done, tick.input.time + duration),
        }
    }

    fn watch(&mut self, tick: &Tick, done: Done, until: f64) -> D::Command {
        if tick.input.time >= until {
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
        let has_lasted = step.elapsed_s(tick.input) >= self.drive.body().step_s;
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
        let (body, input) = (self.drive.body(), tick.input);
        let is_new = |(_, time): &(_, f64)| input.time - time < body.step_s;
        let change = self.last_change.filter(is_new).map(|(change, _)| change);
        let costmap = tick.surroundings.planner.costmap();
        let random = || random_step(&body, costmap, &input.position(), &mut self.rng);
        let Some(target) = exploration.next(self.max_steps, change, random) else {
            return self.finish(tick, done);
        };
        let mut step = NavigationTask::new(input, target, body.step_m, body.step_limit_s);
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
