//! The day of a robot: patrols on a battery, rests at its dock, and orders by others.

use crate::autonomous::{Destination, GoalSelector};
use crate::day_totals::DayTotals;
use crate::pilot::StrategyState;
use agent::{Features, Stay, Travel};
use calendar::{DAY_S, Hours};
use interfaces::{Values, value};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use serde::{Deserialize, Serialize};

/// A robot that is this near to its dock is at its dock, m.
const AT_DOCK_M: f64 = 0.5;
/// A way may take this many times as long as at full speed: a robot turns, waits and goes round people.
const MARGIN: f64 = 2.0;
/// The reserve of battery on top of the return path, s: the longest wait in front of a body that may leave.
const RESERVE_S: f64 = 30.0;
/// A robot that cannot get nearer to its dock waits for this time before it plans again, s.
const WAIT_S: f64 = 5.0;

/// The day of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct DaySettings {
    /// The position of the dock in the frame of the map, m.
    pub dock: Point2<f64>,
    /// How long the robot can be on patrol with a full battery, s.
    pub battery_s: f64,
    /// The share of the time that it can be on patrol; from 1 on it need not charge.
    pub share: f64,
    /// The hours in which others use the robot: it rests at its dock.
    pub busy: Hours,
    /// The time of the week at which the map has the time 0, s since Monday 0:00.
    pub starts_s: f64,
}

impl DaySettings {
    /// The longest travel time from the dock to a goal, s at full speed: the robot may take [`MARGIN`] times as long, and then keeps
    /// [`MARGIN`] times what it took, and a reserve, to return.
    fn range_s(&self) -> f64 {
        (self.battery_s - RESERVE_S) / (MARGIN * (1.0 + MARGIN))
    }
}

/// Selects goals while the robot is on patrol, and sends it to its dock in time.
///
/// The robot leaves its dock when its battery is full and nobody else uses it. On the way it is never farther from the dock
/// than it could have driven since the last goal was chosen: so it turns back while the battery lasts for twice that way.
#[derive(Debug)]
pub struct PatrolDay<G> {
    goals: G,
    settings: DaySettings,
    state: State,
    /// Scratch memory: travel times to all cells, from the robot or from the dock, s.
    times_s: Vec<f64>,
}

/// Travel times without the cells that are too far from the dock for the battery: a robot that turned back on the way to such a
/// goal would choose it again in its next patrol.
struct WithinRange<'a, T> {
    travel: &'a mut T,
    /// From the dock; ∞ without a known way, s.
    from_dock_s: &'a [f64],
    range_s: f64,
}

impl<T: Travel> Travel for WithinRange<'_, T> {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        self.travel.times(mapper, pose, times);
        for (time_s, from_dock_s) in times.iter_mut().zip(self.from_dock_s) {
            if from_dock_s.is_finite() && *from_dock_s > self.range_s {
                *time_s = f64::INFINITY;
            }
        }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct State {
    phase: Phase,
    /// The time of the last reading, s; `None` before the first one.
    now_s: Option<f64>,
    /// The time on patrol for which the battery lasts, s.
    left_s: f64,
    /// When the last goal was chosen, s, and the travel time to the dock then, s.
    planned_s: f64,
    home_s: f64,
    /// The robot has just left its dock: the last goal is that of the patrol before.
    needs_goal: bool,
    totals: DayTotals,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// At the dock, or where the battery was flat: the robot charges.
    Resting,
    Patrolling,
    /// On the way to the dock.
    Returning,
}

impl<G: GoalSelector> PatrolDay<G> {
    /// A robot at its dock, with a full battery. `goals` selects the goals of its patrols.
    pub fn new(goals: G, settings: DaySettings) -> Self {
        let state = State {
            phase: Phase::Resting,
            now_s: None,
            left_s: settings.battery_s,
            planned_s: 0.0,
            home_s: 0.0,
            needs_goal: false,
            totals: DayTotals::default(),
        };
        Self { goals, settings, state, times_s: Vec::new() }
    }

    fn charges(&self) -> bool {
        self.settings.share < 1.0
    }

    fn is_busy(&self, time_s: f64) -> bool {
        self.settings.busy.is_active(time_s + self.settings.starts_s)
    }

    /// The time charged in a second of rest, s.
    fn charge_per_s(&self) -> f64 {
        self.settings.share / (1.0 - self.settings.share)
    }

    /// Lets the time since the last reading pass.
    fn pass(&mut self, now_s: f64) {
        let spent_s = (now_s - self.state.now_s.replace(now_s).unwrap_or(now_s)).max(0.0);
        if self.state.phase == Phase::Resting {
            self.state.totals.rest_s += spent_s;
            if self.charges() {
                self.state.left_s =
                    (self.state.left_s + spent_s * self.charge_per_s()).min(self.settings.battery_s);
            }
            return;
        }
        self.state.totals.patrol_s += spent_s;
        if self.charges() {
            self.state.left_s -= spent_s;
            if self.state.left_s <= 0.0 {
                (self.state.left_s, self.state.phase) = (0.0, Phase::Resting);
                self.state.totals.flat += 1;
            }
        }
    }

    /// The time at which a robot that rests may leave, s; at most a day ahead: it looks where it is once a day.
    fn leaves_s(&self, now_s: f64) -> f64 {
        let missing_s = self.settings.battery_s - self.state.left_s;
        // A microsecond of charge is lost by rounding.
        let is_full = !self.charges() || missing_s < 1e-6;
        let full_s = if is_full { now_s } else { now_s + missing_s / self.charge_per_s() };
        let free_s = if self.is_busy(full_s) {
            self.settings.busy.next_switch_s(full_s + self.settings.starts_s) - self.settings.starts_s
        } else {
            full_s
        };
        free_s.min(now_s + DAY_S)
    }

    /// Whether it is time to go back.
    fn must_return(&self, now_s: f64) -> bool {
        let way_s = self.state.home_s + (now_s - self.state.planned_s);
        self.is_busy(now_s) || self.charges() && self.state.left_s <= MARGIN * way_s + RESERVE_S
    }

    /// Measures the way to the dock from where the robot is.
    fn plan(&mut self, pose: &Isometry2<f64>, mapper: &Mapper, travel: &mut impl Travel) {
        let now_s = mapper.time();
        travel.times(mapper, pose, &mut self.times_s);
        let dock = mapper.frame().index(mapper.frame().cell_at(&self.settings.dock));
        let way_s = dock.and_then(|dock| self.times_s.get(dock)).copied().filter(|way_s| way_s.is_finite());
        // Without a known way: back as the robot came.
        self.state.home_s = way_s.unwrap_or(self.state.home_s + (now_s - self.state.planned_s));
        self.state.planned_s = now_s;
    }
}

impl<G: GoalSelector> GoalSelector for PatrolDay<G> {
    fn next_goal(
        &mut self,
        pose: &Isometry2<f64>,
        mapper: &Mapper,
        travel: &mut impl Travel,
    ) -> Option<Destination> {
        self.plan(pose, mapper, travel);
        self.state.needs_goal = false;
        if self.state.phase != Phase::Returning && !self.must_return(mapper.time()) {
            if !self.charges() {
                return self.goals.next_goal(pose, mapper, travel);
            }
            let dock = Isometry2::new(self.settings.dock.coords, 0.0);
            travel.times(mapper, &dock, &mut self.times_s);
            let (from_dock_s, range_s) = (&self.times_s, self.settings.range_s());
            let mut within = WithinRange { travel, from_dock_s, range_s };
            return self.goals.next_goal(pose, mapper, &mut within);
        }
        self.state.phase = Phase::Returning;
        self.goals.end_goal(pose, mapper);
        Some(Destination { position: self.settings.dock, stay: Stay::Watch(WAIT_S) })
    }

    fn is_obsolete(&self, mapper: &Mapper) -> bool {
        self.state.phase == Phase::Patrolling && self.goals.is_obsolete(mapper)
    }

    fn breaks_off(&self, mapper: &Mapper) -> bool {
        match self.state.phase {
            Phase::Resting => false,
            Phase::Returning => self.state.needs_goal,
            Phase::Patrolling => self.state.needs_goal || self.must_return(mapper.time()),
        }
    }

    fn end_goal(&mut self, pose: &Isometry2<f64>, mapper: &Mapper) {
        self.goals.end_goal(pose, mapper);
    }

    fn observe(&mut self, features: Features, mapper: &Mapper) {
        self.pass(mapper.time());
        self.goals.observe(features, mapper);
    }

    fn rests_until_s(&mut self, pose: Option<&Isometry2<f64>>, mapper: &Mapper) -> Option<f64> {
        let now_s = mapper.time();
        let from_dock_m =
            |pose: &Isometry2<f64>| (pose.translation.vector - self.settings.dock.coords).norm();
        if self.state.phase == Phase::Returning && pose.is_some_and(|pose| from_dock_m(pose) <= AT_DOCK_M) {
            self.state.phase = Phase::Resting;
        }
        if self.state.phase != Phase::Resting {
            return None;
        }
        let leaves_s = self.leaves_s(now_s);
        if leaves_s > now_s {
            return Some(leaves_s);
        }
        (self.state.phase, self.state.needs_goal) = (Phase::Patrolling, true);
        (self.state.planned_s, self.state.home_s) = (now_s, 0.0);
        self.state.totals.patrols += 1;
        None
    }

    fn day(&self) -> Option<DayTotals> {
        Some(self.state.totals)
    }

    fn reason(&self) -> String {
        match self.state.phase {
            Phase::Patrolling => self.goals.reason(),
            Phase::Resting | Phase::Returning => "back to the dock".to_owned(),
        }
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        self.goals.strategies(features)
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        let mut values = self.goals.values(mapper);
        values.push(value(&mut self.state));
        values
    }
}
