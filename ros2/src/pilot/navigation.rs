//! Goals of our agent for Nav2.

use crate::link::Navigation;
use crate::order::Order;
use agent::{Agent, Stay, Travel};
use controller::{Controller, DiffDrive, Situation};
use interfaces::{Values, heading_rad};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use robot::{Belief, GoalCount, GoalSelector, Level, Message, Permission};

/// A robot that is nearer to its goal than this is there, m: Nav2's default tolerance.
const TOLERANCE_M: f64 = 0.25;
/// A goal that does not come nearer for this time is given up, s (`explore_lite`: `progress_timeout`).
const PROGRESS_S: f64 = 30.0;
/// The time until another goal after one that Nav2 has refused, s.
const RETRY_S: f64 = 5.0;

/// The goal that Nav2 has.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Target {
    at: Point2<f64>,
    /// How long the robot stays there, s.
    stay_s: f64,
    /// The shortest distance so far, m, and when it was reached, s.
    nearest_m: f64,
    nearest_s: f64,
    /// Since when the robot is there, s.
    reached_s: Option<f64>,
}

/// Selects goals, and gives them to Nav2.
pub(crate) struct NavigationPilot {
    agent: Agent,
    /// Plans travel times; it drives nothing.
    planner: Controller<DiffDrive>,
    /// Whether Nav2 answers. Otherwise the robot is watched on its way.
    has_answers: bool,
    target: Option<Target>,
    news: Option<Navigation>,
    is_paused: bool,
    /// No goal is selected before this time, s.
    not_before_s: f64,
    goals: GoalCount,
    messages: Vec<Message>,
}

impl NavigationPilot {
    pub(super) fn new(agent: Agent, planner: Controller<DiffDrive>, has_answers: bool) -> Self {
        Self {
            agent,
            planner,
            has_answers,
            target: None,
            news: None,
            is_paused: false,
            not_before_s: f64::NEG_INFINITY,
            goals: GoalCount::default(),
            messages: Vec::new(),
        }
    }

    pub(super) fn resume(&mut self, resume: bool) {
        self.is_paused = !resume;
    }

    pub(super) fn navigated(&mut self, navigation: Navigation) {
        self.news = Some(navigation);
    }

    pub(super) fn command(&mut self, belief: &Belief) -> Order {
        GoalSelector::observe(&mut self.agent, belief);
        let (news, time_s) = (self.news.take(), belief.mapper.time());
        if self.is_paused {
            return if self.target.take().is_some() { Order::Cancel } else { Order::None };
        }
        if let Some(target) = &mut self.target {
            let distance_m = (belief.pose.translation.vector - target.at.coords).norm();
            if distance_m < target.nearest_m - TOLERANCE_M / 2.0 {
                (target.nearest_m, target.nearest_s) = (distance_m, time_s);
            }
            let is_there = news == Some(Navigation::Reached) || !self.has_answers && distance_m < TOLERANCE_M;
            if is_there {
                target.reached_s.get_or_insert(time_s);
            }
            let is_over = target.reached_s.is_some_and(|reached_s| time_s - reached_s >= target.stay_s);
            let is_stuck = target.reached_s.is_none() && time_s - target.nearest_s > PROGRESS_S;
            match news {
                _ if is_over => self.goals.reached += 1,
                Some(Navigation::Refused) => {
                    self.not_before_s = time_s + RETRY_S;
                    self.log(Level::Trouble, "Nav2 has refused the goal, or is not there".to_owned());
                }
                Some(Navigation::GivenUp) => self.give_up("Nav2 has given the goal up"),
                _ if is_stuck => {
                    self.give_up("the robot comes no nearer to the goal");
                    self.target = None;
                    return Order::Cancel;
                }
                _ => return Order::None,
            }
            self.target = None;
        }
        if belief.permission != Permission::Drive || time_s < self.not_before_s {
            return Order::None;
        }
        self.next(belief, time_s)
    }

    fn next(&mut self, belief: &Belief, time_s: f64) -> Order {
        let mut travel = TravelTimes { planner: &mut self.planner };
        let Some(next) = GoalSelector::next_goal(&mut self.agent, belief, &mut travel) else {
            return Order::None;
        };
        let at = next.position;
        let stay_s = match next.stay {
            Stay::Explore => 0.0,
            Stay::Watch(duration_s) => duration_s,
        };
        let way = at.coords - belief.pose.translation.vector;
        self.target = Some(Target { at, stay_s, nearest_m: way.norm(), nearest_s: time_s, reached_s: None });
        let reason = GoalSelector::reason(&self.agent);
        self.log(Level::Decision, format!("{reason}: to ({:.2}, {:.2})", at.x, at.y));
        let heading = if way.norm() > 1e-3 { way.y.atan2(way.x) } else { heading_rad(belief.pose) };
        Order::Goal(interfaces::pose(at.x, at.y, heading))
    }

    fn give_up(&mut self, why: &str) {
        self.goals.given_up += 1;
        self.log(Level::Trouble, format!("goal given up: {why}"));
    }

    fn log(&mut self, level: Level, text: String) {
        self.messages.push(Message { level, text });
    }

    pub(super) fn goal(&self) -> Option<Point2<f64>> {
        self.target.map(|target| target.at)
    }

    pub(super) fn goals(&self) -> GoalCount {
        self.goals
    }

    pub(super) fn take_messages(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.messages)
    }

    pub(super) fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        self.agent.values(mapper)
    }
}

/// The travel times along the paths that our planner would take.
struct TravelTimes<'a> {
    planner: &'a mut Controller<DiffDrive>,
}

impl Travel for TravelTimes<'_> {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        let situation = Situation {
            time: mapper.time(),
            pose,
            map: mapper.states(),
            transitions: mapper.transitions(),
            points: mapper.points(),
        };
        self.planner.travel_times(&situation, times);
    }
}
