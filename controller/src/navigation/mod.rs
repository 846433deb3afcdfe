//! Navigation to a goal, in addition to planning: replanning, waiting, recovery, and local exploration at the goal.

use crate::driver::ControlInput;
use crate::drives::{Body, Drive, DriveScene};
use crate::dynamic_obstacles::DynamicObstacleFilter;
use crate::planner::{Costmap, Path, PlanEnd, Planner};
use interfaces::RandomStream;
use nalgebra::{Point2, Vector2};
use rand::RngExt;
use std::f64::consts::TAU;

/// The minimum time between a plan and the next one, s: if a change blocks the path, and for any other reason.
const REPLAN_BLOCKED_S: f64 = 0.2;
const REPLAN_S: f64 = 0.5;
/// The robot replans if it is farther from its path than this, m.
const OFF_PATH_M: f64 = 0.3;
/// The time that the robot waits if the path to the goal is blocked, s. Longer than a slow robot needs to pass a door.
const WAIT_S: f64 = 10.0;
/// A path that takes this much longer than one past obstacles that may go is a way round, s.
const DETOUR_S: f64 = 3.0;
/// The robot is stuck if it stays for this time, the movement time allowance, s, within this distance, the required movement
/// radius, m.
const MOVEMENT_TIME_ALLOWANCE_S: f64 = 5.0;
const REQUIRED_MOVEMENT_RADIUS_M: f64 = 0.15;
/// The maximum number of recoveries within [`SAME_POSITION_M`]; after that the goal is given up.
const MAX_RECOVERIES: u32 = 3;
/// Recoveries farther apart than this are counted separately, m.
const SAME_POSITION_M: f64 = 1.0;
/// A path that ends this much farther from the goal than an earlier path is worse, m.
const WORSE_M: f64 = 0.1;

/// What the controller computes from the map.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    pub(crate) planner: Planner,
    pub(crate) dynamic: DynamicObstacleFilter,
}

/// The inputs of one tick.
pub(crate) struct Tick<'a> {
    pub(crate) input: &'a ControlInput<'a>,
    pub(crate) surroundings: &'a mut Surroundings,
}

impl Tick<'_> {
    pub(crate) fn scene(&self) -> DriveScene<'_> {
        let Surroundings { planner, dynamic } = &*self.surroundings;
        DriveScene { input: self.input, costmap: planner.costmap(), dynamic }
    }
}

/// The progress of a navigation task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Progress<Command> {
    /// The robot is on its path; the next command.
    Underway(Command),
    /// The robot is at the end of its path.
    Arrived(PlanEnd),
    /// The robot is stuck, or the task took too long.
    GivenUp,
}

/// Whether the robot waits at an obstacle that may go.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
enum Patience {
    /// Not now.
    Rest,
    /// The robot drives to the obstacle, and waits there.
    Waits,
    /// The obstacle has not gone in time: the robot takes the way round, and waits no more.
    Over,
}

/// The navigation to one goal: plans, replans, waits, recovers, gives up.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct NavigationTask {
    goal: Point2<f64>,
    start: Point2<f64>,
    /// The task ends when the robot is this far from its start, m.
    max_distance_m: f64,
    timeout_s: f64,
    began_s: f64,
    planned_at_s: f64,
    plan: Option<PlanEnd>,
    /// The shortest distance from the end of a path to the goal, m.
    best_distance_m: f64,
    waits_until_s: Option<f64>,
    patience: Patience,
    /// The position at which progress was last detected, and the time.
    anchor: (Point2<f64>, f64),
    recoveries: u32,
    recovery_at: Point2<f64>,
    recovering_since_s: Option<f64>,
}

impl NavigationTask {
    /// A task that drives from the present position to `goal`, or until the robot is `max_distance_m` from its
    /// start. The task is given up after `timeout_s`.
    pub(crate) fn new(input: &ControlInput, goal: Point2<f64>, max_distance_m: f64, timeout_s: f64) -> Self {
        let (position, time) = (input.position(), input.time);
        Self {
            goal,
            start: position,
            max_distance_m,
            timeout_s,
            began_s: time,
            planned_at_s: f64::NEG_INFINITY,
            plan: None,
            best_distance_m: f64::INFINITY,
            waits_until_s: None,
            patience: Patience::Rest,
            anchor: (position, time),
            recoveries: 0,
            recovery_at: position,
            recovering_since_s: None,
        }
    }

    /// The goal of the task.
    pub(crate) fn goal(&self) -> &Point2<f64> {
        &self.goal
    }

    /// The time since the task began, s.
    pub(crate) fn elapsed_s(&self, input: &ControlInput) -> f64 {
        input.time - self.began_s
    }

    /// One tick: the progress, with the next command.
    pub(crate) fn drive<D: Drive>(
        &mut self,
        tick: &mut Tick,
        path: &mut Path,
        drive: &mut D,
    ) -> Progress<D::Command> {
        let (input, position) = (tick.input, tick.input.position());
        if self.elapsed_s(input) >= self.timeout_s {
            return Progress::GivenUp;
        }
        let off_path_m = path.advance(&position);
        if self.must_plan(tick, off_path_m) {
            let waits_until_s = self.waits_until_s.take_if(|_| self.patience == Patience::Waits);
            self.plan(tick, path);
            self.consider_waiting(tick, path, drive.body().speed_mps, waits_until_s);
        }
        let scene = tick.scene();
        let is_there = path.remaining_m(&position) <= drive.body().tolerance_m;
        if self.waits(input) && (is_there || self.patience != Patience::Waits) {
            self.anchor = (position, input.time);
            let may_stay = scene.costmap.is_traversable(scene.costmap.frame().cell_at(&position));
            let command = if may_stay { drive.rest(&scene) } else { drive.follow(&scene, path) };
            return Progress::Underway(command);
        }
        if let Some(end) = self.plan.filter(|_| is_there) {
            return Progress::Arrived(end);
        }
        if !self.keeps_trying(input) {
            return Progress::GivenUp;
        }
        if let Some(since_s) = self.recovering_since_s {
            if let Some(command) = drive.recover(&scene, input.time - since_s) {
                return Progress::Underway(command);
            }
            self.recovering_since_s = None;
            self.anchor = (position, input.time);
            // A recovery moves the robot off its path: plan from the new position.
            self.planned_at_s = f64::NEG_INFINITY;
            self.plan = None;
        }
        Progress::Underway(drive.follow(&scene, path))
    }

    /// Whether the robot waits for the path to become free. When the wait is over, the robot drives as near to the
    /// goal as possible.
    fn waits(&mut self, input: &ControlInput) -> bool {
        let waits = self.waits_until_s.is_some_and(|until_s| input.time < until_s);
        if !waits && self.waits_until_s.take().is_some() {
            self.best_distance_m = self.plan.map_or(f64::INFINITY, |end| end.distance_to_goal_m);
            if self.patience == Patience::Waits {
                (self.patience, self.plan) = (Patience::Over, None);
            }
        }
        waits
    }

    fn must_plan(&self, tick: &Tick, off_path_m: f64) -> bool {
        let planner = &tick.surroundings.planner;
        let since_s = tick.input.time - self.planned_at_s;
        let is_lost = self.plan.is_none() || off_path_m > OFF_PATH_M;
        planner.path_blocked() && since_s >= REPLAN_BLOCKED_S
            || (is_lost || planner.goal_cleared()) && since_s >= REPLAN_S
    }

    fn plan(&mut self, tick: &mut Tick, path: &mut Path) {
        let Tick { input, surroundings } = tick;
        let position = input.position();
        self.planned_at_s = input.time;
        self.plan = surroundings.planner.plan(input.map, &position, &self.goal, path);
        path.truncate((self.max_distance_m - (position - self.start).norm()).max(0.0));
        let Some(end) = self.plan else { return };
        if end.distance_to_goal_m <= self.best_distance_m + WORSE_M {
            self.waits_until_s = None;
            self.best_distance_m = self.best_distance_m.min(end.distance_to_goal_m);
        } else if self.waits_until_s.is_none() && self.max_distance_m.is_infinite() {
            // The obstacle may move away again. A step of local exploration is not worth the wait.
            self.waits_until_s = Some(input.time + WAIT_S);
        }
    }

    /// Plans to an obstacle that may go instead, and to wait there, if the robot is expected to be at the goal earlier so than on the way
    /// round that was planned. `waits_until_s`: it waits there already.
    fn consider_waiting(
        &mut self,
        tick: &mut Tick,
        path: &mut Path,
        speed_mps: f64,
        waits_until_s: Option<f64>,
    ) {
        let Tick { input, surroundings: Surroundings { planner, .. } } = tick;
        let may_wait = self.patience != Patience::Over && self.max_distance_m.is_infinite();
        let Some(known) = input.obstacles.filter(|_| may_wait) else { return };
        let position = input.position();
        self.patience = Patience::Rest;
        let round_m = match self.plan {
            Some(end) if end.is_goal => path.remaining_m(&position),
            _ => f64::INFINITY,
        };
        let detour_s = |way_m: f64| (round_m - way_m) / speed_mps;
        let blocked =
            if detour_s((self.goal - position).norm()) > DETOUR_S { known.cells() } else { Vec::new() };
        if blocked.is_empty() {
            return;
        }
        let past = planner.plan_past(input.map, &position, &self.goal, &blocked, path);
        let longest_s = 0.5 * (self.timeout_s - self.elapsed_s(input));
        let patience_s = past.map_or(0.0, |(way_m, at)| match detour_s(way_m) {
            detour_s if detour_s > DETOUR_S => {
                // Cells of the same obstacle can belong to nothing yet.
                let near = blocked.iter().filter(|cell| planner.is_near(&at, **cell));
                near.map(|cell| known.patience(*cell, detour_s)).fold(0.0, f64::max).min(longest_s)
            }
            _ => 0.0,
        });
        if patience_s <= 0.0 {
            self.plan = planner.plan(input.map, &position, &self.goal, path);
            planner.look_for_better();
            return;
        }
        let until_s = input.time + path.remaining_m(&position) / speed_mps + patience_s;
        self.waits_until_s = Some(waits_until_s.unwrap_or(until_s));
        self.patience = Patience::Waits;
    }

    /// Checks the progress, and starts a recovery if the robot is stuck. Returns false after too many recoveries.
    fn keeps_trying(&mut self, input: &ControlInput) -> bool {
        let position = input.position();
        if (position - self.anchor.0).norm() > REQUIRED_MOVEMENT_RADIUS_M {
            self.anchor = (position, input.time);
        }
        let is_stuck = input.time - self.anchor.1 >= MOVEMENT_TIME_ALLOWANCE_S;
        if self.recovering_since_s.is_some() || !is_stuck {
            return true;
        }
        if (position - self.recovery_at).norm() > SAME_POSITION_M {
            self.recoveries = 0;
        }
        self.recovery_at = position;
        self.recoveries += 1;
        self.recovering_since_s = Some(input.time);
        self.recoveries <= MAX_RECOVERIES
    }
}

/// The maximum number of consecutive random steps: in the paper fewer than 2.
const MAX_RANDOM_STEPS: u32 = 1;

/// Local exploration (paper, section 2): each step goes toward the centroid of the last change, or in a random
/// direction if nothing changed. Counts the steps.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct LocalExploration {
    steps: u32,
    random_steps_in_a_row: u32,
}

impl LocalExploration {
    /// The target of the next step; `None` after `max_steps` steps. `change` is the centroid of the last
    /// change, `random` the target of a random step.
    pub(crate) fn next(
        &mut self,
        max_steps: u32,
        change: Option<Point2<f64>>,
        random: impl FnOnce() -> Point2<f64>,
    ) -> Option<Point2<f64>> {
        if self.steps >= max_steps {
            return None;
        }
        let target = match change {
            Some(change) => {
                self.random_steps_in_a_row = 0;
                change
            }
            None if self.random_steps_in_a_row >= MAX_RANDOM_STEPS => return None,
            None => {
                self.random_steps_in_a_row += 1;
                random()
            }
        };
        self.steps += 1;
        Some(target)
    }
}

/// The point one step away in a random traversable direction; `here` if there is none. Always draws one random
/// number.
pub(crate) fn random_step(
    body: &Body,
    costmap: &Costmap,
    here: &Point2<f64>,
    rng: &mut RandomStream,
) -> Point2<f64> {
    let cell = |point: &Point2<f64>| costmap.frame().cell_at(point);
    let step = |direction: u32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(direction) / f64::from(body.directions));
        here + Vector2::new(cos, sin) * body.step_m
    };
    let is_traversable = |target: &Point2<f64>| costmap.line_cost(cell(here), cell(target)).is_some();
    let targets: Vec<_> = (0..body.directions).map(step).filter(is_traversable).collect();
    let draw: u32 = rng.random_range(0..body.directions.max(1));
    // The first traversable direction from a random one on would favor those after a gap.
    let index = u64::from(draw) * targets.len() as u64 / u64::from(body.directions.max(1));
    targets.get(index as usize).copied().unwrap_or(*here)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{costmap, find};
    use crate::{CellDrive, Drive};
    use interfaces::Purpose;

    const HERE: Point2<f64> = Point2::new(1.0, 1.0);
    const CHANGE: Option<Point2<f64>> = Some(Point2::new(5.0, 5.0));

    #[test]
    fn it_makes_fewer_than_two_random_steps_in_a_row() {
        let mut exploration = LocalExploration::default();
        assert_eq!(exploration.next(42, None, || HERE), Some(HERE));
        assert_eq!(exploration.next(42, CHANGE, || HERE), CHANGE);
        assert_eq!(exploration.next(42, None, || HERE), Some(HERE));
        assert_eq!(exploration.next(42, None, || HERE), None);
    }

    #[test]
    fn random_steps_lead_to_every_open_side_and_no_other() {
        let rows = ["....", "#R..", ".#.."];
        let map = costmap(&rows);
        let body = CellDrive.body();
        let robot = find(&rows, 'R');
        let here = map.frame().center(robot);
        let mut rng = RandomStream::new(1, Purpose::Controller);
        let mut steps: Vec<_> =
            (0..100).map(|_| map.frame().cell_at(&random_step(&body, &map, &here, &mut rng))).collect();
        steps.sort();
        steps.dedup();
        let [right, up, ..] = robot.neighbours4();
        assert_eq!(steps, [up, right]);
        let walls = costmap(&["###", "#R#", "###"]);
        let inside = Point2::new(1.5, 1.5);
        assert_eq!(random_step(&body, &walls, &inside, &mut rng), inside);
    }
}
