use super::{GoalCount, Now, Pilot, StrategyState};
use crate::view::{Level, Message};
use agent::Features;
use agent::{Agent, Goal, Stay, Travel};
use controller::{Controller, Drive, Outcome, Situation, Status};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};

/// Where to go next, m, and what to do there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visit {
    /// Where to go, m.
    pub goal: Point2<f64>,
    /// What to do there.
    pub stay: Stay,
}

/// Says where to go next.
pub trait Guide {
    /// Where to go next; `None` when there is no goal left. Asked when the controller has handed
    /// back.
    fn next_goal(&mut self, now: &Now, travel: &mut impl Travel) -> Option<Visit>;

    /// Told at every reading.
    fn watch(&mut self, _now: &Now) {}

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

    /// What the guide thinks of this.
    pub fn guide_mut(&mut self) -> &mut G {
        &mut self.guide
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
        let mut ways = Ways { controller: &mut self.controller };
        let Some(Visit { goal, stay }) = self.guide.next_goal(now, &mut ways) else {
            self.controller.cancel();
            self.is_done = true;
            return;
        };
        match stay {
            Stay::Explore => self.controller.set_goal(goal),
            Stay::Watch(duration) => self.controller.watch_at(goal, duration),
        }
        let reason = self.guide.reason();
        self.say(Level::Decision, format!("{reason}: to ({:.2}, {:.2})", goal.x, goal.y));
    }
}

impl<G: Guide, D: Drive> Pilot for Autonomous<G, D> {
    type Command = D::Command;

    fn command(&mut self, now: &Now) -> D::Command {
        self.guide.watch(now);
        let situation = situation(now.mapper, now.pose);
        let command = self.controller.drive(&situation);
        match self.controller.status() {
            Status::Idle if !self.is_done => self.start_next(now, None),
            Status::Finished(outcome) => self.start_next(now, Some(outcome)),
            _ => return command,
        }
        // So that no tick is lost between two goals; the map's changes have been taken in.
        self.controller.drive(&Situation { transitions: &[], ..situation })
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

fn situation<'a>(mapper: &'a Mapper, pose: &'a Isometry2<f64>) -> Situation<'a> {
    Situation {
        time: mapper.time(),
        pose,
        map: mapper.states(),
        transitions: mapper.transitions(),
        points: mapper.points(),
    }
}

/// The ways that a controller knows.
struct Ways<'a, D: Drive> {
    controller: &'a mut Controller<D>,
}

impl<D: Drive> Travel for Ways<'_, D> {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        self.controller.travel_times(&situation(mapper, pose), times);
    }
}

impl Guide for Agent {
    fn next_goal(&mut self, now: &Now, travel: &mut impl Travel) -> Option<Visit> {
        let Goal { cell, stay } = Agent::next_goal(self, now.mapper, now.pose, travel);
        Some(Visit { goal: now.mapper.frame().center(cell), stay })
    }

    fn watch(&mut self, now: &Now) {
        Agent::watch(self, now.features, now.mapper.transitions());
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
