//! A robot with a battery is back at its dock in time, wherever its goals are.

use agent::{Features, Goal, Stay, Travel};
use calendar::{DAY_S, Hours, WEEK_S};
use controller::{ControlInput, Driver, DriverView, Outcome, Status};
use interfaces::{CellReading, CellState, Grid, GridFrame, Values};
use mapper::{Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2};
use robot::{Autonomous, Belief, DaySettings, DayTotals, GoalSelector, PatrolDay, Permission, Pilot};
use std::cell::Cell;
use std::rc::Rc;

const FULL_SPEED_MPS: f64 = 0.8;
/// A robot that turns, waits and goes round others.
const SPEED_MPS: f64 = 0.5;

/// The corners of a place of 30 m × 20 m, one after the other.
struct Corners {
    count: usize,
    /// Whether the robot is on its way to a corner.
    has_goal: Rc<Cell<bool>>,
}

impl GoalSelector for Corners {
    fn next_goal(&mut self, _: &Isometry2<f64>, _: &Mapper, _: &mut impl Travel) -> Option<Goal> {
        self.count += 1;
        self.has_goal.set(true);
        let position = [[29.0, 1.0], [29.0, 19.0], [1.0, 19.0], [1.0, 1.0]][self.count % 4].into();
        Some(Goal { position, stay: Stay::Watch(0.0) })
    }

    fn end_goal(&mut self, _: &Isometry2<f64>, _: &Mapper) {
        self.has_goal.set(false);
    }

    fn reason(&self) -> String {
        "a corner".to_owned()
    }
}

/// The reachable cell that is farthest away.
struct Farthest;

impl GoalSelector for Farthest {
    fn next_goal(
        &mut self,
        pose: &Isometry2<f64>,
        mapper: &Mapper,
        travel: &mut impl Travel,
    ) -> Option<Goal> {
        let mut times = Vec::new();
        travel.times(mapper, pose, &mut times);
        let reachable = (0..times.len()).filter(|cell| times[*cell].is_finite());
        let cell = reachable.max_by(|one, other| times[*one].total_cmp(&times[*other]))?;
        let position = mapper.frame().center(mapper.frame().cell(cell));
        Some(Goal { position, stay: Stay::Watch(0.0) })
    }

    fn reason(&self) -> String {
        "the farthest cell".to_owned()
    }
}

/// Drives straight to its goals, without a map.
#[derive(Default)]
struct Straight {
    goal: Option<Point2<f64>>,
    is_there: bool,
}

impl Driver for Straight {
    type Command = ();

    fn set_goal(&mut self, goal: Point2<f64>, _: Option<f64>) {
        (self.goal, self.is_there) = (Some(goal), false);
    }

    fn cancel(&mut self) {
        self.goal = None;
    }

    fn view(&self) -> DriverView<'_> {
        let status = match self.goal {
            None => Status::Idle,
            Some(_) if self.is_there => Status::Finished(Outcome::Reached),
            Some(_) => Status::Travelling,
        };
        DriverView { path: &[], goal: self.goal, status, trouble: "" }
    }

    fn drive(&mut self, input: &ControlInput) {
        let away_m = |goal: Point2<f64>| (goal.coords - input.pose.translation.vector).norm();
        self.is_there = self.goal.is_some_and(|goal| away_m(goal) < SPEED_MPS);
    }

    fn pause(&mut self, _: &ControlInput, _: bool) {}

    fn travel_times(&mut self, input: &ControlInput, times: &mut Vec<f64>) {
        let frame = input.map.frame();
        let way_m = |index| (frame.center(frame.cell(index)).coords - input.pose.translation.vector).norm();
        *times = (0..frame.len()).map(|index| way_m(index) / FULL_SPEED_MPS).collect();
    }

    fn forget_map(&mut self) {}

    fn values(&mut self, _: &Grid<CellState>) -> Values<'_> {
        Vec::new()
    }
}

/// What a robot with a day did in a week.
struct Week {
    totals: DayTotals,
    /// The time out in its busy hours, s.
    busy_s: f64,
    /// The goals that it reached, without its dock.
    reached: u32,
}

/// An empty map of 30 m × 20 m.
fn mapper() -> Mapper {
    let frame = GridFrame::new(Point2::origin(), 1.0, 30, 20).unwrap();
    Mapper::new(&MapperSettings::default(), frame).unwrap()
}

/// Where a robot believes to be in the map after a reading.
fn look(mapper: &mut Mapper, time: f64, at: Point2<f64>) -> (Belief, Features) {
    let pose = Isometry2::translation(at.x, at.y);
    mapper.update(&CellReading { time, pose, cells: Vec::new() }).unwrap();
    (Belief::exact(pose), Features::of(mapper))
}

/// A week of a robot; `check` receives at each step on patrol whether it goes to a goal, not to the dock.
fn week_with(goals: impl GoalSelector, share: f64, battery_s: f64, busy: &str, check: impl Fn(bool)) -> Week {
    let mut hours = Hours::never();
    hours.add(busy).unwrap();
    let dock = Point2::new(2.0, 10.0);
    let settings = DaySettings { dock, battery_s, share, busy: hours.clone(), starts_s: 0.0 };
    let mut day = PatrolDay::new(Autonomous::new(goals, Straight::default()), settings);
    let (mut mapper, mut time_s, mut at, mut busy_s, mut reached) = (mapper(), 0.0, dock, 0.0, 0);
    while time_s < WEEK_S {
        let (belief, features) = look(&mut mapper, time_s, at);
        let before = day.view().goal;
        day.command(&belief, features, &mapper);
        if let Some(until_s) = day.battery().rests_until_s() {
            assert!(until_s > time_s && until_s <= time_s + DAY_S);
            assert!((at - dock).norm() <= 0.5, "it rests at {at}");
            time_s = until_s;
            continue;
        }
        busy_s += f64::from(u8::from(hours.is_active(time_s)));
        reached += u32::from(before.is_some_and(|goal| goal != dock && (goal - at).norm() < SPEED_MPS));
        let goal = day.view().goal.unwrap();
        check(goal != dock);
        at += (goal - at).cap_magnitude(SPEED_MPS);
        time_s += 1.0;
    }
    Week { totals: day.battery().totals(), busy_s, reached }
}

/// A week of a robot that goes from corner to corner.
fn week(share: f64, battery_s: f64, busy: &str) -> Week {
    let has_goal = Rc::new(Cell::new(false));
    let goals = Corners { count: 0, has_goal: Rc::clone(&has_goal) };
    week_with(goals, share, battery_s, busy, |is_out| {
        assert_eq!(has_goal.get(), is_out, "the last goal ends where the robot turns back");
    })
}

#[test]
fn a_robot_goes_no_farther_than_its_battery_lasts() {
    for battery_s in [60.0, 90.0, 120.0] {
        let Week { totals, reached, .. } = week_with(Farthest, 0.05, battery_s, "Mon 0:00-0:30", |_| {});
        let are_reached = totals.patrols > 100 && reached + 1 >= totals.patrols;
        assert!(are_reached, "{battery_s} s: {reached}, {totals:?}");
    }
}

/// The share of the time on patrol.
fn patrol_share(totals: &DayTotals) -> f64 {
    totals.patrol_s / (totals.patrol_s + totals.rest_s)
}

#[test]
fn a_robot_is_back_in_time() {
    for (share, battery_s) in [(0.05, 300.0), (0.05, 1800.0), (0.01, 600.0), (0.5, 240.0)] {
        let Week { totals, .. } = week(share, battery_s, "Mon 0:00-0:30");
        assert_eq!(totals.flat, 0, "{share}, {battery_s} s: {totals:?}");
        let expected = 0.5 * share..1.01 * share + 0.003;
        assert!(expected.contains(&patrol_share(&totals)), "{share}, {battery_s} s: {totals:?}");
    }
}

#[test]
fn a_robot_rests_while_others_use_it() {
    let Week { totals, busy_s, .. } = week(1.0, 1800.0, "Mon-Fri 9:00-17:00");
    // On each of the five days the way back, at most 30 m at this speed.
    assert!(busy_s <= 5.0 * 62.0, "{busy_s} s");
    let free = 1.0 - 5.0 * 8.0 / 168.0;
    assert!((patrol_share(&totals) - free).abs() < 0.01, "{totals:?}");
}

#[test]
fn a_lost_robot_uses_its_battery_and_rests_when_it_is_flat() {
    let dock = Point2::new(2.0, 10.0);
    let settings = DaySettings { dock, battery_s: 300.0, share: 0.05, busy: Hours::never(), starts_s: 0.0 };
    let mut day = PatrolDay::new(Autonomous::new(Farthest, Straight::default()), settings);
    let (mut mapper, mut time_s, mut rests) = (mapper(), 0.0, Vec::new());
    while time_s < DAY_S {
        // Where it takes itself to be says nothing.
        let (belief, features) = look(&mut mapper, time_s, dock);
        let lost = Belief { permission: Permission::LookAround, ..belief };
        day.command(&lost, features, &mapper);
        time_s = match day.battery().rests_until_s() {
            Some(until_s) => {
                rests.push((time_s, until_s));
                until_s
            }
            None => time_s + 1.0,
        };
    }
    let totals = day.battery().totals();
    assert_eq!((rests[0], totals.flat, totals.patrols), ((300.0, 6000.0), 15, 15), "{totals:?}");
    assert!((totals.patrol_s - 15.0 * 300.0).abs() < 1.0, "{totals:?}");
}
