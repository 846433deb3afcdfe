use crate::{Belief, GoalCount, Level, Message, Permission, Pilot, StrategyState};
use agent::{Agent, Features, Goal, Stay, Travel};
use controller::{Controller, Drive, Outcome, Situation, Status};
use interfaces::{Values, value};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};

/// The next goal, and what to do there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Destination {
    /// The position of the goal, m.
    pub position: Point2<f64>,
    /// What to do at the goal.
    pub stay: Stay,
}

/// Selects goals. Implemented by the agent, by a tour, and by a reference that knows the ground truth.
pub trait GoalSelector {
    /// The next goal; `None` when no goal is left. Called when the controller has finished a goal. `travel`
    /// gives the travel time to every cell.
    fn next_goal(&mut self, belief: &Belief, travel: &mut impl Travel) -> Option<Destination>;

    /// Whether the present goal has served its purpose before the robot is there.
    fn is_obsolete(&self, _belief: &Belief) -> bool {
        false
    }

    /// Called at every reading.
    fn observe(&mut self, _belief: &Belief) {}

    /// The reason for the last goal, in a few words.
    fn reason(&self) -> String;

    /// The strategies, if the selector has any.
    fn strategies(&self, _features: Features) -> Vec<StrategyState> {
        Vec::new()
    }

    /// Everything that was selected and learned, as in [`Pilot::values`]. Empty for a selector that remembers nothing.
    fn values(&mut self, _mapper: &Mapper) -> Values<'_> {
        Vec::new()
    }
}

/// The pilot of a robot that explores: a goal selector, and a controller that drives to the goals.
#[derive(Debug)]
pub struct Autonomous<G, D: Drive> {
    selector: G,
    controller: Controller<D>,
    goals: GoalCount,
    messages: Vec<Message>,
    is_done: bool,
}

impl<G: GoalSelector, D: Drive> Autonomous<G, D> {
    /// A pilot that has no goal yet.
    pub fn new(selector: G, controller: Controller<D>) -> Self {
        Self { selector, controller, goals: GoalCount::default(), messages: Vec::new(), is_done: false }
    }

    /// The goal selector.
    pub fn selector_mut(&mut self) -> &mut G {
        &mut self.selector
    }

    /// Plans anew: the controller has not seen all changes of the map.
    pub fn forget_map(&mut self) {
        self.controller.forget_map();
    }

    fn log(&mut self, level: Level, text: String) {
        self.messages.push(Message { level, text });
    }

    /// Counts the outcome of the last goal, and selects the next one.
    fn start_next(&mut self, belief: &Belief, last: Option<Outcome>) {
        match last {
            Some(Outcome::GivenUp) => {
                self.goals.given_up += 1;
                self.log(Level::Trouble, "goal given up: no path leads nearer to it".into());
            }
            Some(Outcome::Reached) => self.goals.reached += 1,
            Some(Outcome::Nearest) => self.goals.approached += 1,
            None => {}
        }
        let mut travel = TravelTimes { controller: &mut self.controller };
        let Some(Destination { position, stay }) = self.selector.next_goal(belief, &mut travel) else {
            self.controller.cancel();
            self.is_done = true;
            return;
        };
        match stay {
            Stay::Explore => self.controller.set_goal(position),
            Stay::Watch(duration) => self.controller.watch_at(position, duration),
        }
        let reason = self.selector.reason();
        self.log(Level::Decision, format!("{reason}: to ({:.2}, {:.2})", position.x, position.y));
    }
}

impl<G: GoalSelector, D: Drive> Pilot for Autonomous<G, D> {
    type Command = D::Command;

    fn command(&mut self, belief: &Belief) -> D::Command {
        self.selector.observe(belief);
        if belief.correction.is_some() {
            self.forget_map();
        }
        let situation = situation(belief.mapper, belief.pose);
        if belief.permission != Permission::Drive {
            return self.controller.pause(&situation, belief.permission == Permission::LookAround);
        }
        let command = self.controller.drive(&situation);
        match self.controller.status() {
            Status::Idle if !self.is_done => self.start_next(belief, None),
            Status::Finished(outcome) => self.start_next(belief, Some(outcome)),
            Status::Travelling | Status::Exploring if self.selector.is_obsolete(belief) => {
                self.start_next(belief, Some(Outcome::Reached));
            }
            _ => return command,
        }
        // Drive to the new goal in the same tick. The controller already has the transitions of this reading.
        self.controller.drive(&Situation { transitions: &[], ..situation })
    }

    fn path(&self) -> &[Point2<f64>] {
        self.controller.path()
    }

    fn goal(&self) -> Option<Point2<f64>> {
        self.controller.goal().copied()
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        self.selector.strategies(features)
    }

    fn goals(&self) -> GoalCount {
        self.goals
    }

    fn take_messages(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.messages)
    }

    fn is_done(&self) -> bool {
        self.is_done
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        let mut values = self.selector.values(mapper);
        values.extend(self.controller.values(mapper.states()));
        values.extend([value(&mut self.goals), value(&mut self.messages), value(&mut self.is_done)]);
        values
    }
}

fn situation<'a>(mapper: &'a Mapper, pose: &'a Isometry2<f64>) -> Situation<'a> {
    Situation {
        time: mapper.time(),
        pose,
        map: mapper.states(),
        transitions: mapper.transitions(),
        points: mapper.points(),
    }
}

/// The travel times along the paths that the controller would plan.
struct TravelTimes<'a, D: Drive> {
    controller: &'a mut Controller<D>,
}

impl<D: Drive> Travel for TravelTimes<'_, D> {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        self.controller.travel_times(&situation(mapper, pose), times);
    }
}

impl GoalSelector for Agent {
    fn next_goal(&mut self, belief: &Belief, travel: &mut impl Travel) -> Option<Destination> {
        let Goal { cell, stay } = Agent::next_goal(self, belief.mapper, belief.pose, travel);
        Some(Destination { position: belief.mapper.frame().center(cell), stay })
    }

    fn is_obsolete(&self, belief: &Belief) -> bool {
        self.is_goal_obsolete(belief.mapper)
    }

    fn observe(&mut self, belief: &Belief) {
        Agent::watch(self, belief.features, belief.mapper.transitions());
    }

    fn reason(&self) -> String {
        match self.current().and_then(|current| Agent::strategies(self).nth(current)) {
            Some(name) => format!("{name} (last reward {:.2})", self.last_reward()),
            None => "unseen space".into(),
        }
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        Agent::values(self, mapper)
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        Agent::strategies(self)
            .zip(self.shares())
            .enumerate()
            .map(|(strategy, (name, share))| StrategyState {
                name: name.to_owned(),
                value: self.value(strategy, features),
                share,
                is_current: self.current() == Some(strategy),
            })
            .collect()
    }
}
