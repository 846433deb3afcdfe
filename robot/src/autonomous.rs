use crate::planning_map::PlanningMap;
use crate::{Belief, GoalCount, Level, Message, Pilot, StrategyState};
use agent::{Agent, Features, Goal, Stay, Travel};
use controller::{Controller, Drive, Outcome, Situation, Status};
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
}

/// The pilot of a robot that explores: a goal selector, and a controller that drives to the goals.
#[derive(Debug)]
pub struct Autonomous<G, D: Drive> {
    selector: G,
    controller: Controller<D>,
    goals: GoalCount,
    messages: Vec<Message>,
    is_done: bool,
    /// Whether paths lead through what is probably open again.
    tries_again: bool,
    planning_map: Option<PlanningMap>,
}

impl<G: GoalSelector, D: Drive> Autonomous<G, D> {
    /// A pilot that has no goal yet.
    pub fn new(selector: G, controller: Controller<D>) -> Self {
        Self {
            selector,
            controller,
            goals: GoalCount::default(),
            messages: Vec::new(),
            is_done: false,
            tries_again: false,
            planning_map: None,
        }
    }

    /// The same pilot, whose paths also lead through cells that were last seen blocked, but were probably free since
    /// then by what the mapper knows of their changes: a closed door is tried again.
    pub fn trying_again(self) -> Self {
        Self { tries_again: true, ..self }
    }

    /// The goal selector.
    pub fn selector_mut(&mut self) -> &mut G {
        &mut self.selector
    }

    fn log(&mut self, level: Level, text: String) {
        self.messages.push(Message { level, text });
    }

    /// Counts the outcome of the last goal, and selects the next one.
    fn start_next(&mut self, belief: &Belief, situation: &Situation, last: Option<Outcome>) {
        match last {
            Some(Outcome::GivenUp) => {
                self.goals.given_up += 1;
                self.log(Level::Trouble, "goal given up: no path leads nearer to it".into());
            }
            Some(Outcome::Reached) => self.goals.reached += 1,
            Some(Outcome::Nearest) => self.goals.approached += 1,
            None => {}
        }
        let mut travel = TravelTimes { controller: &mut self.controller, situation };
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

    /// The map for planning with the last reading; `None` to plan on the map as last seen.
    fn update_planning_map(&mut self, mapper: &Mapper) -> Option<PlanningMap> {
        let known = self.planning_map.take().filter(|known| known.map().frame() == mapper.frame());
        let Some(mut known) = known else { return self.tries_again.then(|| PlanningMap::new(mapper)) };
        known.update(mapper);
        Some(known)
    }

    fn decide(&mut self, belief: &Belief, situation: &Situation) -> D::Command {
        let command = self.controller.drive(situation);
        match self.controller.status() {
            Status::Idle if !self.is_done => self.start_next(belief, situation, None),
            Status::Finished(outcome) => self.start_next(belief, situation, Some(outcome)),
            Status::Travelling | Status::Exploring if self.selector.is_obsolete(belief) => {
                self.start_next(belief, situation, Some(Outcome::Reached));
            }
            _ => return command,
        }
        // Drive to the new goal in the same tick. The controller already has the transitions of this reading.
        self.controller.drive(&Situation { transitions: &[], ..*situation })
    }
}

impl<G: GoalSelector, D: Drive> Pilot for Autonomous<G, D> {
    type Command = D::Command;

    fn command(&mut self, belief: &Belief) -> D::Command {
        self.selector.observe(belief);
        let planning_map = self.update_planning_map(belief.mapper);
        let situation = situation(belief, planning_map.as_ref());
        let command = self.decide(belief, &situation);
        self.planning_map = planning_map;
        command
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
}

fn situation<'a>(belief: &Belief<'a>, planning_map: Option<&'a PlanningMap>) -> Situation<'a> {
    let Belief { pose, mapper, .. } = *belief;
    let (map, transitions) = match planning_map {
        Some(planning_map) => (planning_map.map(), planning_map.transitions()),
        None => (mapper.states(), mapper.transitions()),
    };
    Situation { time: mapper.time(), pose, map, transitions, points: mapper.points() }
}

/// The travel times along the paths that the controller would plan.
struct TravelTimes<'a, D: Drive> {
    controller: &'a mut Controller<D>,
    situation: &'a Situation<'a>,
}

impl<D: Drive> Travel for TravelTimes<'_, D> {
    fn times(&mut self, _mapper: &Mapper, _pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        self.controller.travel_times(self.situation, times);
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
