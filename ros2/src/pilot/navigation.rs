//! Goals of our agent for another navigation: Nav2, or whatever listens to `goal_pose`.

use crate::link;
use controller::{ControlInput, DriverView, Outcome, Status};
use interfaces::{Twist, heading_rad};
use nalgebra::{Isometry2, Point2};

/// What the node asks of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Order {
    /// Nothing.
    #[default]
    None,
    /// To drive at a velocity until the next order.
    Velocity(Twist),
    /// To drive to a pose in the frame of the map.
    Goal(Isometry2<f64>),
    /// To give up the goal.
    Cancel,
}

/// A robot that is nearer to its goal than this is there, m: Nav2's default tolerance.
const TOLERANCE_M: f64 = 0.25;
/// A goal that does not come nearer for this time is given up, s (`explore_lite`: `progress_timeout`).
const PROGRESS_S: f64 = 30.0;
/// The time until another goal after one that Nav2 has refused, s.
const RETRY_S: f64 = 5.0;
/// A robot that is lost turns in place by this angle, rad, once in this time, s.
const LOOK_RAD: f64 = 2.0;
const LOOK_S: f64 = 5.0;

/// A goal.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Target {
    at: Point2<f64>,
    /// How long the robot stays there, s.
    stay_s: f64,
    /// Whether the navigation has it.
    is_sent: bool,
    /// The shortest distance so far, m, and when it was reached, s.
    nearest_m: f64,
    nearest_s: f64,
    /// Since when the robot is there, s.
    reached_s: Option<f64>,
    outcome: Option<Outcome>,
}

/// Gives goals to another navigation, and watches what becomes of them.
pub(super) struct Navigation {
    /// Whether it answers. Otherwise the robot is watched on its way.
    has_answers: bool,
    target: Option<Target>,
    news: Option<link::Navigation>,
    /// Whether it still has a goal that is none any more.
    must_cancel: bool,
    /// No goal is sent before this time, s.
    not_before_s: f64,
    /// Until this time, a robot that is lost has a turn to do, s.
    looks_until_s: f64,
    trouble: &'static str,
}

impl Navigation {
    pub(super) fn new(has_answers: bool) -> Self {
        Self {
            has_answers,
            target: None,
            news: None,
            must_cancel: false,
            not_before_s: f64::NEG_INFINITY,
            looks_until_s: f64::NEG_INFINITY,
            trouble: "",
        }
    }

    pub(super) fn navigated(&mut self, news: link::Navigation) {
        self.news = Some(news);
    }

    pub(super) fn set_goal(&mut self, at: Point2<f64>, watch_s: Option<f64>) {
        self.cancel();
        let stay_s = watch_s.unwrap_or(0.0);
        let [nearest_m, nearest_s] = [f64::INFINITY, f64::NEG_INFINITY];
        let (is_sent, reached_s, outcome) = (false, None, None);
        self.target = Some(Target { at, stay_s, is_sent, nearest_m, nearest_s, reached_s, outcome });
    }

    pub(super) fn cancel(&mut self) {
        let target = self.target.take();
        self.must_cancel |= target.is_some_and(|target| target.is_sent && target.outcome.is_none());
    }

    /// As [`controller::Driver::view`], with the path of our controller.
    pub(super) fn view<'a>(&self, path: &'a [Point2<f64>]) -> DriverView<'a> {
        let status = match self.target {
            None => Status::Idle,
            Some(Target { outcome: Some(outcome), .. }) => Status::Finished(outcome),
            Some(Target { reached_s: Some(_), .. }) => Status::Exploring,
            Some(_) => Status::Travelling,
        };
        DriverView { path, goal: self.target.map(|target| target.at), status, trouble: self.trouble }
    }

    /// What the navigation is asked on the way to the goal.
    pub(super) fn drive(&mut self, input: &ControlInput) -> Order {
        let (news, time_s) = (self.news.take(), input.time);
        let Some(target) = &mut self.target else { return self.withdraw() };
        if target.outcome.is_some() {
            return Order::None;
        }
        let way = target.at - input.position();
        if !target.is_sent {
            if time_s < self.not_before_s {
                return Order::None;
            }
            (target.is_sent, self.must_cancel) = (true, false);
            (target.nearest_m, target.nearest_s) = (way.norm(), time_s);
            let heading_rad =
                if way.norm() > 1e-3 { libm::atan2(way.y, way.x) } else { heading_rad(input.pose) };
            return Order::Goal(interfaces::pose(target.at.x, target.at.y, heading_rad));
        }
        self.watch(way.norm(), time_s, news);
        Order::None
    }

    /// Decides whether the goal is reached, or must be given up.
    fn watch(&mut self, distance_m: f64, time_s: f64, news: Option<link::Navigation>) {
        let Some(target) = &mut self.target else { return };
        if distance_m < target.nearest_m - TOLERANCE_M / 2.0 {
            (target.nearest_m, target.nearest_s) = (distance_m, time_s);
        }
        let is_near = !self.has_answers && distance_m < TOLERANCE_M;
        if news == Some(link::Navigation::Reached) || is_near {
            target.reached_s.get_or_insert(time_s);
        }
        let is_stuck = target.reached_s.is_none() && time_s - target.nearest_s > PROGRESS_S;
        let trouble = match news {
            Some(link::Navigation::Refused) => {
                self.not_before_s = time_s + RETRY_S;
                Some("Nav2 has refused the goal, or is not there")
            }
            Some(link::Navigation::GivenUp) => Some("Nav2 has given the goal up"),
            _ if is_stuck => Some("the robot comes no nearer to the goal"),
            _ => None,
        };
        if target.reached_s.is_some_and(|reached_s| time_s >= reached_s + target.stay_s) {
            target.outcome = Some(Outcome::Reached);
        } else if let Some(trouble) = trouble {
            (self.trouble, target.outcome) = (trouble, Some(Outcome::GivenUp));
            self.must_cancel = is_stuck;
        }
    }

    /// What the navigation is asked while the robot must not drive to its goal: a robot that is lost turns in place.
    pub(super) fn pause(&mut self, input: &ControlInput, looks_around: bool) -> Order {
        if !looks_around {
            return self.withdraw();
        }
        if input.time < self.looks_until_s {
            return Order::None;
        }
        self.looks_until_s = input.time + LOOK_S;
        self.withdraw();
        self.must_cancel = true;
        Order::Goal(input.pose * interfaces::pose(0.0, 0.0, LOOK_RAD))
    }

    /// Takes the goal back until the robot may drive again.
    pub(super) fn withdraw(&mut self) -> Order {
        if let Some(target) = &mut self.target {
            self.must_cancel |= std::mem::take(&mut target.is_sent) && target.outcome.is_none();
        }
        if std::mem::take(&mut self.must_cancel) { Order::Cancel } else { Order::None }
    }
}

#[cfg(test)]
mod tests;
