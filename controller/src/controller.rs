use crate::exploration::{Exploration, random_step};
use crate::journey::{Journey, Progress, Surroundings};
use crate::{Drive, Path, Planner, Reach, Restless, Settings, Situation};
use interfaces::{RandomStream, SettingsError};
use nalgebra::Point2;

/// What the controller is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It has never had a goal, or the goal was taken back.
    Idle,
    /// It drives to its goal.
    Travelling,
    /// It explores around its goal, or watches there.
    Exploring,
    /// It is done with its goal, rests and waits for another.
    Finished(Outcome),
}

/// How a goal ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The robot came to the goal.
    Reached,
    /// The goal is blocked or hidden; the robot came as near to it as can be reached.
    Nearest,
    /// The robot got nowhere for too long.
    GivenUp,
}

/// Takes a goal, drives the robot there and explores around it (paper, section 2).
///
/// One verb, [`drive`](Self::drive), once per tick; it never fails. What a command is, is the
/// [`Drive`]'s affair. All chance comes from the generator given at construction.
#[derive(Clone, Debug)]
pub struct Controller<D: Drive> {
    settings: Settings,
    drive: D,
    rng: RandomStream,
    surroundings: Option<Surroundings>,
    task: Task,
    path: Path,
    /// The middle of the last change, and when it was.
    last_change: Option<(Point2<f64>, f64)>,
}

/// What there is to do, with what is needed to do it.
#[derive(Clone, Debug)]
enum Task {
    None,
    /// A goal that came since the last tick.
    Start {
        goal: Point2<f64>,
        then: Then,
    },
    Travel {
        journey: Journey,
        then: Then,
    },
    Explore(Exploring),
    Watch {
        goal: Point2<f64>,
        outcome: Outcome,
        until: f64,
    },
    Done {
        goal: Point2<f64>,
        outcome: Outcome,
    },
}

/// What to do at the goal.
#[derive(Clone, Copy, Debug)]
enum Then {
    Explore,
    /// Stand there for so long.
    Watch(f64),
}

/// Local exploration around a goal that was reached, or as nearly as could be.
#[derive(Clone, Debug)]
struct Exploring {
    goal: Point2<f64>,
    outcome: Outcome,
    exploration: Exploration,
    step: Journey,
}

impl<D: Drive> Controller<D> {
    /// A controller without a goal.
    ///
    /// # Errors
    ///
    /// When a setting is not a number that makes sense, or contradicts another; the error names it.
    pub fn new(settings: Settings, drive: D, rng: RandomStream) -> Result<Self, SettingsError> {
        settings.check()?;
        let path = Path::default();
        Ok(Self { settings, drive, rng, surroundings: None, task: Task::None, path, last_change: None })
    }

    /// Gives a goal in the map's frame, m: to drive there, then explore around it. Replaces any
    /// other. A goal outside of the map counts as the nearest point in it.
    pub fn set_goal(&mut self, goal: Point2<f64>) {
        self.start(goal, Then::Explore);
    }

    /// As [`set_goal`](Self::set_goal), without local exploration: for a tour.
    pub fn go_to(&mut self, goal: Point2<f64>) {
        self.watch_at(goal, 0.0);
    }

    /// As [`set_goal`](Self::set_goal), but to stand at the goal for `duration` (s; steps in a grid
    /// world) instead of exploring around it.
    pub fn watch_at(&mut self, goal: Point2<f64>, duration: f64) {
        // What is not a number counts as no time, so that the watch ends.
        self.start(goal, Then::Watch(duration.max(0.0)));
    }

    /// Takes the goal back; the robot rests.
    pub fn cancel(&mut self) {
        self.task = Task::None;
        self.path.clear();
    }

    /// Writes how long it takes to get from the robot to each cell, in row-major order, s (steps in
    /// a grid world), at full speed along the ways that the planner prefers; ∞ where none is known.
    /// To be asked after the tick's [`drive`](Self::drive), which takes the map's changes in. Costs a
    /// wave over the whole map.
    pub fn travel_times(&mut self, situation: &Situation, times: &mut Vec<f64>) {
        let body = self.drive.body();
        times.clear();
        times.resize(situation.map.frame().len(), f64::INFINITY);
        if let Some(surroundings) = &mut self.surroundings {
            surroundings.planner.lengths_m(situation.map, &situation.position(), times);
            times.iter_mut().for_each(|time| *time /= body.speed_mps);
        }
    }

    fn start(&mut self, goal: Point2<f64>, then: Then) {
        self.task = Task::Start { goal, then };
        self.path.clear();
    }

    /// What the controller is doing since the last tick.
    pub fn status(&self) -> Status {
        match self.task {
            Task::None => Status::Idle,
            Task::Start { .. } | Task::Travel { .. } => Status::Travelling,
            Task::Explore(_) | Task::Watch { .. } => Status::Exploring,
            Task::Done { outcome, .. } => Status::Finished(outcome),
        }
    }

    /// The goal it was last given; `None` when it was taken back.
    pub fn goal(&self) -> Option<&Point2<f64>> {
        match &self.task {
            Task::None => None,
            Task::Start { goal, .. }
            | Task::Explore(Exploring { goal, .. })
            | Task::Watch { goal, .. }
            | Task::Done { goal, .. } => Some(goal),
            Task::Travel { journey, .. } => Some(journey.target()),
        }
    }

    /// The path it follows, from where it was planned to its end, m; empty without one.
    pub fn path(&self) -> &[Point2<f64>] {
        self.path.points()
    }

    /// One tick: what to do now. May be called again with the same situation, but without its
    /// transitions, when it has finished and there is another goal: no tick is lost then.
    pub fn drive(&mut self, situation: &Situation) -> D::Command {
        if let Some(change) = situation.change() {
            self.last_change = Some((change, situation.time));
        }
        let mut surroundings = self.look(situation);
        let command = match std::mem::replace(&mut self.task, Task::None) {
            Task::None => self.rest(situation, &surroundings),
            Task::Start { goal, then } => {
                let limit_s = self.settings.patience.goal_limit_s;
                let journey = Journey::new(situation, goal, f64::INFINITY, limit_s);
                self.travel(situation, &mut surroundings, journey, then)
            }
            Task::Travel { journey, then } => self.travel(situation, &mut surroundings, journey, then),
            Task::Explore(exploring) => self.explore(situation, &mut surroundings, exploring),
            Task::Watch { goal, outcome, until } => {
                self.watch(situation, &surroundings, goal, outcome, until)
            }
            done @ Task::Done { .. } => {
                self.task = done;
                self.rest(situation, &surroundings)
            }
        };
        self.surroundings = Some(surroundings);
        command
    }

    /// Follows the map; looks at all of it the first time, or if it has got another frame.
    fn look(&mut self, situation: &Situation) -> Surroundings {
        let known = self.surroundings.take();
        match known.filter(|known| known.planner.costmap().frame() == situation.map.frame()) {
            Some(mut known) => {
                known.planner.update(situation.transitions);
                known.restless.update(situation);
                known
            }
            None => {
                let body = self.drive.body();
                let (inflation, map) = (&self.settings.inflation, situation.map);
                let planner = Planner::new(inflation, body.radius_m, body.moves, map);
                let mut restless = Restless::new(map);
                restless.update(situation);
                Surroundings { planner, restless }
            }
        }
    }

    fn travel(
        &mut self,
        situation: &Situation,
        surroundings: &mut Surroundings,
        mut journey: Journey,
        then: Then,
    ) -> D::Command {
        let patience = &self.settings.patience;
        let outcome = match journey.drive(patience, situation, surroundings, &mut self.path, &mut self.drive)
        {
            Progress::Underway(command) => {
                self.task = Task::Travel { journey, then };
                return command;
            }
            Progress::Arrived(Reach { is_goal: true, .. }) => Outcome::Reached,
            Progress::Arrived(_) => Outcome::Nearest,
            Progress::GivenUp => Outcome::GivenUp,
        };
        let goal = *journey.target();
        match then {
            _ if outcome == Outcome::GivenUp => self.finish(situation, surroundings, goal, outcome),
            Then::Explore => self.step(situation, surroundings, goal, outcome, Exploration::default()),
            Then::Watch(duration) => {
                self.watch(situation, surroundings, goal, outcome, situation.time + duration)
            }
        }
    }

    fn watch(
        &mut self,
        situation: &Situation,
        surroundings: &Surroundings,
        goal: Point2<f64>,
        outcome: Outcome,
        until: f64,
    ) -> D::Command {
        if situation.time >= until {
            return self.finish(situation, surroundings, goal, outcome);
        }
        self.task = Task::Watch { goal, outcome, until };
        self.path.clear();
        self.rest(situation, surroundings)
    }

    fn explore(
        &mut self,
        situation: &Situation,
        surroundings: &mut Surroundings,
        mut exploring: Exploring,
    ) -> D::Command {
        let patience = &self.settings.patience;
        let progress =
            exploring.step.drive(patience, situation, surroundings, &mut self.path, &mut self.drive);
        let lasted = exploring.step.elapsed_s(situation) >= self.drive.body().step_s;
        match progress {
            Progress::Underway(command) => {
                self.task = Task::Explore(exploring);
                command
            }
            Progress::Arrived(_) if !lasted => {
                self.task = Task::Explore(exploring);
                self.rest(situation, surroundings)
            }
            _ => {
                let Exploring { goal, outcome, exploration, .. } = exploring;
                self.step(situation, surroundings, goal, outcome, exploration)
            }
        }
    }

    /// Begins the next step of local exploration, or finishes it.
    fn step(
        &mut self,
        situation: &Situation,
        surroundings: &mut Surroundings,
        goal: Point2<f64>,
        outcome: Outcome,
        mut exploration: Exploration,
    ) -> D::Command {
        let body = self.drive.body();
        let fresh = |(_, time): &(_, f64)| situation.time - time < body.step_s;
        let change = self.last_change.filter(fresh).map(|(change, _)| change);
        let position = situation.position();
        let random = || random_step(&body, surroundings.planner.costmap(), &position, &mut self.rng);
        let Some(target) = exploration.next(&self.settings.exploration, change, random) else {
            return self.finish(situation, surroundings, goal, outcome);
        };
        let mut step = Journey::new(situation, target, body.stride_m, body.step_limit_s);
        let patience = &self.settings.patience;
        let progress = step.drive(patience, situation, surroundings, &mut self.path, &mut self.drive);
        self.task = Task::Explore(Exploring { goal, outcome, exploration, step });
        match progress {
            Progress::Underway(command) => command,
            _ => self.rest(situation, surroundings),
        }
    }

    fn finish(
        &mut self,
        situation: &Situation,
        surroundings: &Surroundings,
        goal: Point2<f64>,
        outcome: Outcome,
    ) -> D::Command {
        self.task = Task::Done { goal, outcome };
        self.path.clear();
        self.rest(situation, surroundings)
    }

    fn rest(&mut self, situation: &Situation, surroundings: &Surroundings) -> D::Command {
        self.drive.rest(&surroundings.scene(situation))
    }
}
