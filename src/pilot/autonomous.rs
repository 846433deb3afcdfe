use super::{GoalCount, Now, Pilot, StrategyState};
use crate::view::{Level, Message};
use agent::Agent;
use controller::{Controller, Drive, Outcome, Situation, Status};
use geometry::Cell;
use mapper::Features;
use nalgebra::Point2;

/// Says where to go next.
pub trait Guide {
    /// The next goal, m; `None` when there is none left. Asked when the controller has handed back.
    fn next_goal(&mut self, now: &Now) -> Option<Point2<f64>>;

    /// Told at every reading.
    fn watch(&mut self, _now: &Now) {}

    /// Whether to explore around a goal that was reached.
    fn explores(&self) -> bool;

    /// One sentence on the goal just given.
    fn reason(&self) -> String;

    /// Its strategies, for one that has some.
    fn strategies(&self, _features: Features) -> Vec<StrategyState> {
        Vec::new()
    }
}

/// A guide that says where to go, and a controller that gets there.
#[derive(Debug)]
pub struct Autonomous<G, D: Drive> {
    guide: G,
    controller: Controller<D>,
    goals: GoalCount,
    messages: Vec<Message>,
    is_done: bool,
}

impl<G: Guide, D: Drive> Autonomous<G, D> {
    /// A pilot without a goal yet.
    pub fn new(guide: G, controller: Controller<D>) -> Self {
        Self { guide, controller, goals: GoalCount::default(), messages: Vec::new(), is_done: false }
    }

    fn say(&mut self, level: Level, text: String) {
        self.messages.push(Message { level, text });
    }

    /// Counts how the last goal ended, and asks for the next.
    fn start_next(&mut self, now: &Now, last: Option<Outcome>) {
        match last {
            Some(Outcome::GivenUp) => {
                self.goals.given_up += 1;
                self.say(Level::Trouble, "goal given up: no way to get nearer".into());
            }
            Some(outcome) => {
                self.goals.reached += 1;
                self.goals.nearest += u32::from(outcome == Outcome::Nearest);
            }
            None => {}
        }
        let Some(goal) = self.guide.next_goal(now) else {
            self.controller.cancel();
            self.is_done = true;
            return;
        };
        if self.guide.explores() {
            self.controller.set_goal(goal);
        } else {
            self.controller.go_to(goal);
        }
        let reason = self.guide.reason();
        self.say(Level::Decision, format!("{reason}: to ({:.2}, {:.2})", goal.x, goal.y));
    }
}

impl<G: Guide, D: Drive> Pilot for Autonomous<G, D> {
    type Command = D::Command;

    fn command(&mut self, now: &Now) -> D::Command {
        self.guide.watch(now);
        match self.controller.status() {
            Status::Idle if !self.is_done => self.start_next(now, None),
            Status::Finished(outcome) => self.start_next(now, Some(outcome)),
            _ => {}
        }
        self.controller.drive(&Situation {
            time: now.mapper.time(),
            pose: now.pose,
            map: now.mapper.states(),
            transitions: now.mapper.transitions(),
            points: now.mapper.points(),
        })
    }

    fn path(&self) -> &[Point2<f64>] {
        self.controller.path()
    }

    fn goal(&self) -> Option<Point2<f64>> {
        self.controller.goal().copied()
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        self.guide.strategies(features)
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

impl Guide for Agent {
    fn next_goal(&mut self, now: &Now) -> Option<Point2<f64>> {
        let cell: Cell = Agent::next_goal(self, now.mapper, now.pose);
        Some(now.mapper.frame().center(cell))
    }

    fn watch(&mut self, now: &Now) {
        Agent::watch(self, now.features, now.mapper.transitions());
    }

    fn explores(&self) -> bool {
        true
    }

    fn reason(&self) -> String {
        let name = self.current().and_then(|current| Agent::strategies(self).nth(current));
        format!("{} (last reward {:.2})", name.unwrap_or("none"), self.last_reward())
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        Agent::strategies(self)
            .zip(self.shares())
            .enumerate()
            .map(|(strategy, (name, share))| StrategyState {
                name,
                value: self.value(strategy, features),
                share,
                is_current: self.current() == Some(strategy),
            })
            .collect()
    }
}
