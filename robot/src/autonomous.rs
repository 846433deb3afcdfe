use crate::pilot::{Belief, GoalCount, Level, Message, Permission, Pilot, PilotView};
use agent::{Features, Goal, GoalSelector, Stay, StrategyState, Travel};
use controller::{ControlInput, Driver, DriverView, Outcome, Status};
use interfaces::{Obstacles, Values, values};
use mapper::Mapper;
use nalgebra::Isometry2;

/// The pilot of a robot that explores: a goal selector, and a driver to the goals.
#[derive(Debug)]
pub struct Autonomous<G, D> {
    /// The goal selector.
    pub selector: G,
    /// The driver.
    pub driver: D,
    goals: GoalCount,
    messages: Vec<Message>,
    is_done: bool,
    is_patient: bool,
}

impl<G: GoalSelector, D: Driver> Autonomous<G, D> {
    /// A pilot that has no goal yet.
    pub fn new(selector: G, driver: D) -> Self {
        let (goals, messages) = (GoalCount::default(), Vec::new());
        Self { selector, driver, goals, messages, is_done: false, is_patient: false }
    }

    /// Lets the robot wait for an obstacle that blocks its path, for as long as the map expects that to be faster than the way round.
    /// Otherwise it takes the way round at once, as the paper's.
    pub fn patient(self) -> Self {
        Self { is_patient: true, ..self }
    }

    fn log(&mut self, level: Level, text: String) {
        self.messages.push(Message { level, text });
    }

    /// Processes one reading: drives to the goal, and at its end to the next one, which `next` selects, with the reason.
    /// `breaks_off`: the robot has to leave its goal on the way, and the goal has no outcome.
    pub(crate) fn go(
        &mut self,
        belief: &Belief,
        features: Features,
        mapper: &Mapper,
        breaks_off: bool,
        next: impl FnOnce(&mut G, &mut TravelTimes<'_, D>) -> Option<(Goal, String)>,
    ) -> D::Command {
        self.selector.observe(features, mapper.transitions());
        let obstacles = self.is_patient.then_some(mapper as &dyn Obstacles);
        let input = ControlInput { obstacles, ..input(mapper, &belief.pose) };
        match belief.permission {
            Permission::Rest => return self.driver.pause(&input, false),
            Permission::LookAround => return self.driver.pause(&input, true),
            Permission::Drive => {}
        }
        let command = self.driver.drive(&input);
        let DriverView { status, trouble, .. } = self.driver.view();
        match status {
            Status::Idle if !self.is_done => {}
            Status::Finished(Outcome::GivenUp) => {
                self.goals.given_up += 1;
                self.log(Level::Trouble, format!("goal given up: {trouble}"));
            }
            Status::Finished(Outcome::Reached) => self.goals.reached += 1,
            Status::Finished(Outcome::Nearest) => self.goals.approached += 1,
            Status::Travelling | Status::Exploring if breaks_off => {}
            Status::Travelling | Status::Exploring if self.selector.is_obsolete(mapper) => {
                self.goals.reached += 1;
            }
            _ => return command,
        }
        match next(&mut self.selector, &mut TravelTimes { driver: &mut self.driver }) {
            None => {
                self.driver.cancel();
                self.is_done = true;
            }
            Some((Goal { position, stay }, reason)) => {
                let watch = match stay {
                    Stay::Explore => None,
                    Stay::Watch(duration) => Some(duration),
                };
                self.driver.set_goal(position, watch);
                self.log(Level::Decision, format!("{reason}: to ({:.2}, {:.2})", position.x, position.y));
            }
        }
        // Drive to the new goal in the same tick. The driver already has the transitions of this reading.
        self.driver.drive(&ControlInput { transitions: &[], ..input })
    }

    /// Processes one reading of a robot that rests: it leaves its goal, which has no outcome.
    pub(crate) fn rest(&mut self, pose: &Isometry2<f64>, features: Features, mapper: &Mapper) -> D::Command {
        self.selector.observe(features, mapper.transitions());
        if self.driver.view().goal.is_some() {
            // The time of a goal goes on while the robot rests, until the driver gives the goal up.
            self.driver.cancel();
            self.selector.end_goal(pose, mapper);
        }
        self.driver.pause(&input(mapper, pose), false)
    }
}

impl<G: GoalSelector, D: Driver> Pilot for Autonomous<G, D> {
    type Command = D::Command;

    fn command(&mut self, belief: &Belief, features: Features, mapper: &Mapper) -> D::Command {
        self.go(belief, features, mapper, false, |selector, travel| {
            let goal = selector.next_goal(&belief.pose, mapper, travel)?;
            Some((goal, selector.reason()))
        })
    }

    fn forget_map(&mut self) {
        self.driver.forget_map();
    }

    fn view(&self) -> PilotView<'_> {
        let DriverView { path, goal, .. } = self.driver.view();
        PilotView { path, goal, goals: self.goals, is_done: self.is_done }
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        self.selector.strategies(features)
    }

    fn take_messages(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.messages)
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        let mut values = self.selector.values(mapper);
        values.extend(self.driver.values(mapper.states()));
        values.extend(values![self.goals, self.messages, self.is_done]);
        values
    }
}

fn input<'a>(mapper: &'a Mapper, pose: &'a Isometry2<f64>) -> ControlInput<'a> {
    ControlInput {
        time: mapper.time(),
        pose,
        map: mapper.states(),
        transitions: mapper.transitions(),
        points: mapper.points(),
        obstacles: None,
    }
}

/// The travel times along the paths that the driver would take.
pub(crate) struct TravelTimes<'a, D> {
    driver: &'a mut D,
}

impl<D: Driver> Travel for TravelTimes<'_, D> {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        self.driver.travel_times(&input(mapper, pose), times);
    }
}
