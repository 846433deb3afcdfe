//! The robot in a tiny world, and with parts that only write down what they are asked.

use crate::{
    Autonomous, Belief, ExactPoses, GoalCount, GoalSelector, Localization, Permission, Pilot, Robot,
};
use agent::{Agent, AgentSettings, Features, Goal, Policy, Travel};
use controller::{CellDrive, Controller, Driver};
use interfaces::{
    Cell, CellReading, GridFrame, LaserReading, Purpose, RandomStream, Scan, Step, ValueError, World,
};
use localizer::{Correction, PoseEstimate, PoseState};
use mapper::{Mapper, MapperSettings, NoReturn, ReadingError, ScanFilter, ScanFilterSettings};
use nalgebra::{Isometry2, Matrix3, Point2};
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

/// What the parts were asked, in order.
type Calls = Arc<Mutex<Vec<String>>>;

fn note(calls: &Calls, call: impl Into<String>) {
    calls.lock().unwrap().push(call.into());
}

fn taken(calls: &Calls) -> Vec<String> {
    std::mem::take(&mut *calls.lock().unwrap())
}

/// Gives the readings these states, one after the other, and closes a loop with the last of them.
struct Scripted {
    states: Vec<PoseState>,
    calls: Calls,
}

impl Localization<LaserReading> for Scripted {
    fn localize(&mut self, mut reading: LaserReading, mapper: &mut Mapper) -> (LaserReading, Belief) {
        let silent = reading.scan.ranges_m.iter().filter(|range_m| range_m.is_infinite()).count();
        let (time_s, mapped) = (reading.time_s, mapper.readings());
        note(&self.calls, format!("localize {time_s:.1} s, {silent} silent, {mapped} mapped"));
        reading.pose = interfaces::pose(5.0, 5.0, 0.0);
        let state = self.states.remove(0);
        let estimate = PoseEstimate { pose: reading.pose, covariance: Matrix3::zeros(), support: 1.0, state };
        let correction =
            self.states.is_empty().then_some(Correction { places: 1, readings: 1, largest_m: 1.0 });
        let permission = if state == PoseState::Lost { Permission::LookAround } else { Permission::Drive };
        let belief = Belief { pose: reading.pose, estimate: Some(estimate), permission, correction };
        (reading, belief)
    }

    fn snapshot(&mut self) -> Vec<u8> {
        Vec::new()
    }

    fn restore(&mut self, _: &[u8]) -> Result<(), ValueError> {
        Ok(())
    }

    fn begin_session(&mut self) {
        note(&self.calls, "begin session");
    }
}

/// Gives the number of readings in the map as its command.
struct Counting(Calls);

impl Pilot for Counting {
    type Command = usize;

    fn command(&mut self, belief: &Belief, _: Features, mapper: &Mapper) -> usize {
        note(&self.0, format!("command {:?}, {:?}", belief.permission, belief.state()));
        mapper.readings()
    }

    fn forget_map(&mut self) {
        note(&self.0, "forget map");
    }
}

/// A scan of 180 beams, of which a quarter has no return.
fn reading(time_s: f64) -> LaserReading {
    let mut ranges_m = vec![2.0; 180];
    ranges_m[..45].fill(f32::INFINITY);
    let scan = Scan { angle_increment_rad: TAU / 180.0, range_max_m: 4.0, ranges_m, ..Scan::default() };
    LaserReading { time_s, scan, ..LaserReading::default() }
}

fn mapper(cells: usize, resolution_m: f64) -> Mapper {
    let frame = GridFrame::new(Point2::origin(), resolution_m, cells, cells).unwrap();
    Mapper::new(&MapperSettings::default(), frame).unwrap()
}

fn scripted(states: &[PoseState]) -> (Robot<LaserReading, Counting>, Calls) {
    let calls = Calls::default();
    let localization = Scripted { states: states.to_vec(), calls: calls.clone() };
    (Robot::new(Box::new(localization), mapper(100, 0.1), Counting(calls.clone())), calls)
}

const CERTAIN: PoseState = PoseState::Tracking;

#[test]
fn a_step_filters_localizes_maps_and_decides_in_this_order() {
    let (robot, calls) = scripted(&[CERTAIN, CERTAIN, PoseState::Lost, CERTAIN]);
    let settings = ScanFilterSettings { no_return: NoReturn::Ignore, ..ScanFilterSettings::default() };
    let mut robot = robot.with_filter(ScanFilter::new(&settings).unwrap());
    let turn = robot.step(reading(0.0)).unwrap();
    // The filter comes before the localization, the map before the decision.
    assert_eq!(taken(&calls), ["localize 0.0 s, 0 silent, 0 mapped", "command Drive, Tracking"]);
    assert_eq!((turn.command, turn.reading.pose), (1, interfaces::pose(5.0, 5.0, 0.0)));
    robot.step(reading(0.1)).unwrap();
    let seen = |robot: &Robot<LaserReading, Counting>| {
        (0..10_000).filter(|cell| robot.mapper.was_ever_seen(*cell)).count()
    };
    let before = seen(&robot);
    assert!(before > 50, "{before}");
    taken(&calls);
    // What is not certain does not enter the map.
    let mut far = reading(0.2);
    far.scan.ranges_m.fill(3.5);
    robot.step(far).unwrap();
    assert_eq!(taken(&calls), ["localize 0.2 s, 0 silent, 2 mapped", "command LookAround, Lost"]);
    assert_eq!((seen(&robot), robot.mapper.time()), (before, 0.2));
    // The pilot learns that the map is another one before it decides.
    robot.step(reading(0.3)).unwrap();
    assert_eq!(taken(&calls)[1..], ["forget map", "command Drive, Tracking"]);
}

#[test]
fn a_reading_that_is_refused_gives_no_command() {
    let (mut robot, calls) = scripted(&[CERTAIN, CERTAIN]);
    robot.step(reading(1.0)).unwrap();
    taken(&calls);
    assert!(matches!(robot.step(reading(0.5)), Err(ReadingError::Time { .. })));
    assert_eq!(taken(&calls).len(), 1);
    assert_eq!(robot.mapper.time(), 1.0);
}

#[test]
fn a_session_goes_on_after_the_map_whatever_its_clock_says() {
    let (mut robot, calls) = scripted(&[CERTAIN; 5]);
    robot.step(reading(100.0)).unwrap();
    // The clock has started anew.
    robot.begin_session(3.0, Some(60.0));
    robot.step(reading(3.0)).unwrap();
    robot.step(reading(3.1)).unwrap();
    assert!((robot.mapper.time() - 160.1).abs() < 1e-9);
    assert_eq!(taken(&calls)[2], "begin session");
    // Without a known gap: as the clock says, or a second.
    robot.begin_session(500.0, None);
    robot.step(reading(500.0)).unwrap();
    assert_eq!(robot.mapper.time(), 500.0);
    robot.begin_session(0.0, None);
    robot.step(reading(0.0)).unwrap();
    assert_eq!(robot.mapper.time(), 501.0);
}

#[test]
fn nothing_was_in_view_between_readings_that_are_far_apart() {
    let watched = |max_step_s: f64| {
        let (mut robot, _) = scripted(&[CERTAIN; 4]);
        robot.session_mut().max_step_s = max_step_s;
        for time_s in [0.0, 0.1, 0.2, 60.0] {
            robot.step(reading(time_s)).unwrap();
        }
        (0..10_000).map(|cell| robot.mapper.statistics(cell).watched_free).fold(0.0, f64::max)
    };
    assert!(watched(2.0) < 1.0 && watched(f64::INFINITY) > 59.0);
}

/// A room of 7 × 7 cells with a wall around it; something stands in the middle in every second ten steps.
struct Room {
    time: f64,
    at: Cell,
}

impl World for Room {
    type Reading = CellReading;
    type Command = Step;

    fn sense(&mut self) -> CellReading {
        let is_there = self.time as u64 / 10 % 2 == 1 && self.at != Cell::new(3, 3);
        let is_blocked =
            |x, y| x == 0 || y == 0 || x == 6 || y == 6 || is_there && Cell::new(x, y) == Cell::new(3, 3);
        let cells = (0..49).map(|cell| (Cell::new(cell % 7, cell / 7), is_blocked(cell % 7, cell / 7)));
        let pose = interfaces::pose(f64::from(self.at.x) + 0.5, f64::from(self.at.y) + 0.5, 0.0);
        CellReading { time: self.time, pose, cells: cells.collect() }
    }

    fn poses_are_exact(&self) -> bool {
        true
    }

    fn act(&mut self, command: &Step) {
        let to = command.target(self.at);
        if (1..6).contains(&to.x) && (1..6).contains(&to.y) {
            self.at = to;
        }
        self.time += 1.0;
    }
}

type Explorer = Robot<CellReading, Autonomous<Agent, Controller<CellDrive>>>;

fn explorer(policy: &str) -> Explorer {
    let stream = |purpose| RandomStream::new(1, purpose);
    let policy = policy.parse::<Policy>().unwrap();
    let agent = Agent::new(&AgentSettings::default(), &policy, stream(Purpose::GridAgent)).unwrap();
    let controller = Controller::new(CellDrive, 42, stream(Purpose::GridController));
    Robot::new(Box::new(ExactPoses), mapper(7, 1.0), Autonomous::new(agent, controller))
}

/// The commands of some turns.
fn commands(world: &mut Room, robot: &mut Explorer, turns: usize) -> Vec<Step> {
    let mut command = None;
    let commands = (0..turns).map(|_| crate::turn(world, robot, &mut command).unwrap().command).collect();
    command.iter().for_each(|last| world.act(last));
    commands
}

#[test]
fn a_robot_that_is_restored_goes_on_bit_for_bit() {
    for policy in ["curious", "information-gain", "fresh-map"] {
        let (mut world, mut robot) = (Room { time: 0.0, at: Cell::new(1, 1) }, explorer(policy));
        commands(&mut world, &mut robot, 157);
        let learned = robot.mapper.snapshot();
        let pilot = interfaces::snapshot(robot.pilot.values(&robot.mapper));
        let mut other = explorer(policy);
        other.mapper.restore(&learned).unwrap();
        interfaces::restore(other.pilot.values(&other.mapper), &pilot).unwrap();
        let mut same = Room { ..world };
        let went = commands(&mut world, &mut robot, 300);
        assert!(policy != "curious" || went.iter().any(|step| *step != Step::Stay));
        assert_eq!(commands(&mut same, &mut other, 300), went, "{policy}");
        assert!(robot.mapper.snapshot() == other.mapper.snapshot());
    }
}

/// Reaches every goal at once, or none, and writes down what it is asked.
#[derive(Default)]
struct Jumping {
    is_slow: bool,
    goal: Option<Point2<f64>>,
    asked: Vec<&'static str>,
}

impl Driver for Jumping {
    type Command = ();

    fn set_goal(&mut self, goal: Point2<f64>, _: Option<f64>) {
        self.goal = Some(goal);
        self.asked.push("goal");
    }

    fn cancel(&mut self) {
        self.goal = None;
        self.asked.push("cancel");
    }

    fn view(&self) -> controller::DriverView<'_> {
        let status = match self.goal {
            Some(_) if self.is_slow => controller::Status::Travelling,
            Some(_) => controller::Status::Finished(controller::Outcome::Reached),
            None => controller::Status::Idle,
        };
        controller::DriverView { path: &[], goal: self.goal, status, trouble: "" }
    }

    fn drive(&mut self, _: &controller::ControlInput) {
        self.asked.push("drive");
    }

    fn pause(&mut self, _: &controller::ControlInput, looks_around: bool) {
        self.asked.push(if looks_around { "look around" } else { "rest" });
    }

    fn travel_times(&mut self, _: &controller::ControlInput, _: &mut Vec<f64>) {}

    fn forget_map(&mut self) {
        self.asked.push("forget map");
    }

    fn values(&mut self, _: &interfaces::Grid<interfaces::CellState>) -> interfaces::Values<'_> {
        Vec::new()
    }
}

#[test]
fn permissions_hold_for_every_driver() {
    let mut pilot = Autonomous::new(Ended::default(), Jumping::default());
    let map = mapper(7, 1.0);
    for permission in [Permission::Rest, Permission::LookAround, Permission::Drive] {
        let belief = Belief { permission, ..Belief::exact(Isometry2::identity()) };
        pilot.command(&belief, Features::default(), &map);
    }
    pilot.forget_map();
    assert_eq!(pilot.driver.asked, ["rest", "look around", "drive", "goal", "drive", "forget map"]);
    assert_eq!(pilot.view().goals.reached, 0);
    pilot.command(&Belief::exact(Isometry2::identity()), Features::default(), &map);
    assert_eq!(pilot.view().goals.reached, 1);
}

/// Goes to the origin, and notes the ends of its goals.
#[derive(Default)]
struct Ended(usize);

impl GoalSelector for Ended {
    fn next_goal(&mut self, _: &Isometry2<f64>, _: &Mapper, _: &mut impl Travel) -> Option<Goal> {
        Some(Goal { position: Point2::origin(), stay: agent::Stay::Explore })
    }

    fn end_goal(&mut self, _: &Isometry2<f64>, _: &Mapper) {
        self.0 += 1;
    }

    fn reason(&self) -> String {
        String::new()
    }
}

#[test]
fn goals_that_a_rest_ends_have_no_outcome() {
    let belief = Belief::exact(Isometry2::identity());
    let (map, features) = (mapper(7, 1.0), Features::default());
    let mut pilot = Autonomous::new(Ended::default(), Jumping::default());
    pilot.command(&belief, features, &map);
    pilot.rest(&belief.pose, features, &map);
    pilot.rest(&belief.pose, features, &map);
    pilot.command(&belief, features, &map);
    let goes = ["drive", "goal", "drive"];
    assert_eq!(pilot.driver.asked, [&goes[..], &["cancel", "rest", "rest"], &goes].concat());
    assert_eq!((pilot.view().goals, pilot.selector.0), (GoalCount::default(), 1));
    // The goal is replaced on the way.
    let driver = Jumping { is_slow: true, ..Jumping::default() };
    let mut pilot = Autonomous::new(Ended::default(), driver);
    for _ in 0..2 {
        pilot.go(&belief, features, &map, true, |goals, travel| {
            Some((goals.next_goal(&belief.pose, &map, travel)?, goals.reason()))
        });
    }
    assert_eq!(pilot.driver.asked, [goes, goes].concat());
    assert_eq!(pilot.view().goals, GoalCount::default());
}
