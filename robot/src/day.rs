//! The day of a robot: patrols on a battery, rests at its dock, and orders by others.

use crate::autonomous::Autonomous;
use crate::pilot::{Belief, Message, Permission, Pilot, PilotView};
use agent::{Features, Goal, GoalSelector, Stay, StrategyState, Travel};
use calendar::{DAY_S, Hours};
use controller::Driver;
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

/// What a robot did with its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DayTotals {
    /// The time on patrol, s.
    pub patrol_s: f64,
    /// The time at rest, s.
    pub rest_s: f64,
    /// The number of patrols.
    pub patrols: u32,
    /// How often the battery was flat before the robot was back.
    pub flat: u32,
}

/// The pilot of a robot with a battery: it lets another pilot drive while the robot is on patrol, and sends the robot to its dock
/// in time.
///
/// The robot leaves its dock when its battery is full and nobody else uses it. On the way it is never farther from the dock
/// than it could have driven since the last goal was chosen: so it turns back while the battery lasts for twice that way.
#[derive(Debug)]
pub struct PatrolDay<G, D> {
    pilot: Autonomous<G, D>,
    battery: Battery,
}

/// The battery of a robot, and its day so far.
#[derive(Debug)]
pub struct Battery {
    settings: DaySettings,
    state: State,
    /// Scratch memory: travel times to all cells, from the robot or from the dock, s.
    times_s: Vec<f64>,
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
    /// Until when the robot rests, as of the last reading, s.
    rests_until_s: Option<f64>,
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

impl Battery {
    /// Until when the robot rests where it is, s, by its last command: until then it needs no reading. `None` if it drives.
    pub fn rests_until_s(&self) -> Option<f64> {
        self.state.rests_until_s
    }

    /// What the robot did with its time.
    pub fn totals(&self) -> DayTotals {
        self.state.totals
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

    /// Until when the robot, at `pose` if it is not lost, is to rest where it is, s; `None` if it is to drive.
    fn rest(&mut self, pose: Option<&Isometry2<f64>>, now_s: f64) -> Option<f64> {
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

    /// Whether it is time to go back.
    fn must_return(&self, now_s: f64) -> bool {
        let way_s = self.state.home_s + (now_s - self.state.planned_s);
        self.is_busy(now_s) || self.charges() && self.state.left_s <= MARGIN * way_s + RESERVE_S
    }

    /// Whether the robot leaves its goal on the way.
    fn breaks_off(&self, now_s: f64) -> bool {
        self.state.phase == Phase::Patrolling && (self.state.needs_goal || self.must_return(now_s))
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

    /// The next goal of `goals` within the range of the battery, or the dock; and the reason.
    fn next_goal(
        &mut self,
        goals: &mut impl GoalSelector,
        pose: &Isometry2<f64>,
        mapper: &Mapper,
        travel: &mut impl Travel,
    ) -> Option<(Goal, String)> {
        self.plan(pose, mapper, travel);
        self.state.needs_goal = false;
        if self.state.phase == Phase::Returning || self.must_return(mapper.time()) {
            self.state.phase = Phase::Returning;
            goals.end_goal(pose, mapper);
            let dock = Goal { position: self.settings.dock, stay: Stay::Watch(WAIT_S) };
            return Some((dock, "back to the dock".to_owned()));
        }
        let goal = if self.charges() {
            let dock = Isometry2::new(self.settings.dock.coords, 0.0);
            travel.times(mapper, &dock, &mut self.times_s);
            let (from_dock_s, range_s) = (&self.times_s, self.settings.range_s());
            goals.next_goal(pose, mapper, &mut WithinRange { travel, from_dock_s, range_s })
        } else {
            goals.next_goal(pose, mapper, travel)
        };
        goal.map(|goal| (goal, goals.reason()))
    }
}

impl<G: GoalSelector, D: Driver> PatrolDay<G, D> {
    /// A robot at its dock, with a full battery. `pilot` drives on its patrols.
    pub fn new(pilot: Autonomous<G, D>, settings: DaySettings) -> Self {
        let state = State {
            phase: Phase::Resting,
            now_s: None,
            left_s: settings.battery_s,
            planned_s: 0.0,
            home_s: 0.0,
            needs_goal: false,
            rests_until_s: None,
            totals: DayTotals::default(),
        };
        Self { pilot, battery: Battery { settings, state, times_s: Vec::new() } }
    }

    /// The battery.
    pub fn battery(&self) -> &Battery {
        &self.battery
    }
}

impl<G: GoalSelector, D: Driver> Pilot for PatrolDay<G, D> {
    type Command = D::Command;

    fn command(&mut self, belief: &Belief, features: Features, mapper: &Mapper) -> D::Command {
        let Self { pilot, battery } = self;
        let (pose, now_s) = (&belief.pose, mapper.time());
        battery.pass(now_s);
        battery.state.rests_until_s = match belief.permission {
            Permission::Rest => None,
            Permission::LookAround => battery.rest(None, now_s),
            Permission::Drive => battery.rest(Some(pose), now_s),
        };
        if battery.state.rests_until_s.is_some() {
            return pilot.rest(pose, features, mapper);
        }
        let breaks_off = battery.breaks_off(now_s);
        pilot.go(belief, features, mapper, breaks_off, |goals, travel| {
            battery.next_goal(goals, pose, mapper, travel)
        })
    }

    fn forget_map(&mut self) {
        self.pilot.forget_map();
    }

    fn view(&self) -> PilotView<'_> {
        self.pilot.view()
    }

    fn strategies(&self, features: Features) -> Vec<StrategyState> {
        self.pilot.strategies(features)
    }

    fn take_messages(&mut self) -> Vec<Message> {
        self.pilot.take_messages()
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        let mut values = self.pilot.values(mapper);
        values.push(value(&mut self.battery.state));
        values
    }
}
