mod glass;
mod lifecycle;
mod loops;
mod one_map;
mod same_robot;
mod seating;
mod storm;

use super::*;
use crate::link::Navigation;
use crate::message::{Message, Twist as TwistMessage, TwistStamped};
use crate::parameters::{Mode, Navigator};
use crate::service::wire::Trigger;
use crate::service::{Call, Reply, Service};
use crate::simulated::{SimulatedRobot, SimulationSettings};
use crate::tests::fake::FakeLink;
use interfaces::{CellState, Grid};
use nalgebra::{Isometry2, Point2};
use ros::Vector;
use sim::physics::WorldSpec;
use std::sync::{Arc, Mutex};

/// A simulated robot, a node, and all that goes between them.
struct Pair {
    sim: SimulatedRobot<FakeLink>,
    robot: FakeLink,
    node: CuriousNode<FakeLink>,
    others: FakeLink,
    said: Arc<Mutex<Vec<String>>>,
}

fn parameters(mode: Mode) -> Parameters {
    Parameters { mode, map_size_m: 40.0, max_vel_x_mps: 0.4, robot_radius_m: 0.2, ..Parameters::default() }
}

fn node(
    parameters: &Parameters,
    state: Option<&Path>,
) -> (CuriousNode<FakeLink>, FakeLink, Arc<Mutex<Vec<String>>>) {
    let (others, said) = (FakeLink::default(), Arc::new(Mutex::new(Vec::new())));
    let to = said.clone();
    let output = Box::new(move |text: &str| to.lock().unwrap().push(text.to_owned()));
    let node = CuriousNode::new(others.clone(), parameters, state, output).unwrap();
    (node, others, said)
}

/// Why there is no node.
fn refused(parameters: &Parameters, state: Option<&Path>) -> String {
    let node = CuriousNode::new(FakeLink::default(), parameters, state, Box::new(|_| ()));
    format!("{:#}", node.err().unwrap())
}

impl Pair {
    fn new(parameters: &Parameters, begin_s: i64, state: Option<&Path>) -> Self {
        Self::in_world(&worldfile::shipped::load("house").unwrap(), parameters, begin_s, state)
    }

    fn in_world(world: &WorldSpec, parameters: &Parameters, begin_s: i64, state: Option<&Path>) -> Self {
        let robot = FakeLink::default();
        let settings = SimulationSettings { seed: 1, speed: 1.0, begin_ns: begin_s * 1_000_000_000 };
        let sim = SimulatedRobot::new(robot.clone(), world, settings);
        let (node, others, said) = node(parameters, state);
        Self { sim, robot, node, others, said }
    }

    /// Runs for some simulated time.
    fn run(&mut self, duration_s: f64) {
        let end_s = self.sim.time_s() + duration_s;
        while self.sim.time_s() < end_s {
            self.sim.step();
            let sent = self.robot.others(|others| std::mem::take(&mut others.heard));
            for (topic, message) in sent {
                if !matches!(topic, Topic::Clock | Topic::GroundTruth) {
                    self.others.sends(topic, message);
                    self.node.turn(Duration::ZERO);
                }
            }
            self.orders()
                .into_iter()
                .for_each(|message| self.sim.take(Event::Message(Topic::StampedVelocity, message)));
        }
    }

    /// Takes the orders of the node so far.
    fn orders(&mut self) -> Vec<Message> {
        self.others.others(|others| {
            let orders = others.heard.extract_if(.., |(topic, _)| *topic == Topic::StampedVelocity);
            orders.map(|(_, message)| message).collect()
        })
    }

    /// Calls a service, and waits for its answer.
    fn call(&mut self, service: Service, call: Call) -> Reply {
        self.others.calls(1, service, call);
        loop {
            self.node.turn(Duration::ZERO);
            if let Some((_, reply)) = self.others.answer() {
                return reply;
            }
        }
    }

    /// Saves the state by the service.
    fn save(&mut self) -> Trigger {
        let reply = self.call(Service::SaveState, Call::Nothing);
        let Reply::Trigger(answer) = reply else { panic!("{reply:?}") };
        answer
    }

    /// Drives by velocities, as another node would.
    fn drive(&mut self, linear_mps: f64, angular_radps: f64) {
        let linear = Vector { x: linear_mps, ..Vector::default() };
        let angular = Vector { z: angular_radps, ..Vector::default() };
        self.sim.take(Event::Message(Topic::Velocity, Message::Twist(TwistMessage { linear, angular })));
    }

    fn explore(&mut self, is_on: bool) {
        self.others.sends(Topic::Resume, Message::Bool(is_on));
    }

    fn is_said(&self, words: &str) -> bool {
        self.said.lock().unwrap().iter().any(|text| text.contains(words))
    }
}

fn known(map: &Grid<CellState>) -> usize {
    map.cells().iter().filter(|state| **state != CellState::Unknown).count()
}

#[test]
fn a_robot_that_someone_else_drives_is_mapped() {
    let mut pair = Pair::new(&parameters(Mode::Map), 0, None);
    pair.run(5.0);
    let report = pair.node.report();
    // The last scan waits for a later pose.
    assert!(report.scans.received - report.readings <= 1, "{report:?}");
    let received = report.scans.received;
    assert_eq!(report.scans, ScanCount { received, ..ScanCount::default() });
    assert_eq!(report.readings, report.mapped);
    assert!(report.readings >= 48, "{report:?}");
    assert!(known(pair.node.robot.mapper.states()) > 1000);
    assert_eq!(pair.others.heard(Topic::StampedVelocity), []);
    let maps = pair.others.heard(Topic::Map);
    let Some(Message::Grid(map)) = maps.first() else { panic!("no map") };
    assert_eq!(map.header.frame_id, "map");
    let transforms = pair.others.heard(Topic::Transforms);
    let Some(Message::Transforms(last)) = transforms.last() else { panic!("no transform") };
    let (stamp, found) = (last.transforms[0].header.stamp, &last.transforms[0]);
    assert_eq!((found.header.frame_id.as_str(), found.child_frame_id.as_str()), ("map", "odom"));
    // The robot starts at the origin of the map, and stands: the transform undoes its pose by odometry.
    let at = found.transform.isometry().unwrap();
    let start = worldfile::shipped::load("house").unwrap().driven().pose;
    let back = start.inverse();
    assert!((at.translation.x - back.translation.x).abs() < 0.01, "{at} {back}");
    assert!((at.translation.y - back.translation.y).abs() < 0.01, "{at} {back}");
    assert!(stamp.ns() > 4_900_000_000, "{stamp:?}");
}

#[test]
fn a_robot_explores_and_waits() {
    let mut pair = Pair::new(&parameters(Mode::Explore), 1_700_000_000, None);
    pair.run(4.0);
    let before = known(pair.node.robot.mapper.states());
    pair.run(60.0);
    let after = known(pair.node.robot.mapper.states());
    assert!(after > before + 5000, "{before}, {after}");
    let report = pair.node.report();
    assert!(report.mapped * 10 >= report.readings * 9, "{report:?}");
    assert!(pair.is_said("to ("), "no goal");
    assert!(!pair.others.heard(Topic::Path).is_empty());
    pair.explore(false);
    pair.others.others(|others| others.heard.clear());
    let mut orders = Vec::new();
    for _ in 0..30 {
        pair.sim.step();
        for (topic, message) in pair.robot.others(|others| std::mem::take(&mut others.heard)) {
            pair.others.sends(topic, message);
            pair.node.turn(Duration::ZERO);
        }
        orders.extend(pair.orders());
    }
    // One order to stop; then a joystick can drive the robot.
    assert_stops(&orders);
    assert!(pair.is_said("exploring is paused"));
}

#[track_caller]
fn assert_stops(orders: &[Message]) {
    let [Message::TwistStamped(TwistStamped { twist, .. })] = orders else { panic!("{orders:?}") };
    assert_eq!((twist.linear.x, twist.angular.z), (0.0, 0.0));
}

#[test]
fn what_was_learned_survives_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    let map = parameters(Mode::Map);
    let mut pair = Pair::new(&map, 1_700_000_000, Some(&path));
    let early = pair.save();
    assert_eq!(
        (early.is_done, &early.text[..]),
        (false, "there is nothing to save before the first reading")
    );
    pair.run(5.0);
    let answer = pair.save();
    assert!(answer.is_done, "{}", answer.text);
    let learned = pair.node.robot.mapper.clone();
    let error = refused(&map, Some(&path));
    assert!(error.ends_with("house.state: cannot use it: another run uses it; wait for its end, or give another file by --state"), "{error}");
    drop(pair);

    // An hour later, at the same place.
    let mut again = Pair::new(&map, 1_700_003_600, Some(&path));
    assert!(again.is_said("the map goes on from"));
    assert_eq!(again.others.heard(Topic::Map).len(), 1);
    assert_eq!(again.node.robot.mapper.states(), learned.states());
    again.run(5.0);
    let time_s = again.node.robot.mapper.time();
    assert!((time_s - learned.time() - 3600.0).abs() < 6.0, "{time_s} {}", learned.time());
    assert!(again.node.report().mapped > 30, "{:?}", again.node.report());

    let coarse = Parameters { resolution_m: 0.1, ..map };
    drop(again);
    let error = refused(&coarse, Some(&path));
    assert!(error.contains("`resolution_m` is `0.05` there, and `0.1` here"), "{error}");
}

#[test]
fn without_a_file_nothing_is_saved() {
    let answer = Pair::new(&parameters(Mode::Map), 0, None).save();
    assert_eq!(answer.text, "there is no state file: start the node with --state FILE");
}

#[test]
fn nav2_gets_goals_one_after_the_other() {
    let nav2 = Parameters { navigator: Navigator::Nav2, ..parameters(Mode::Explore) };
    let mut pair = Pair::new(&nav2, 0, None);
    pair.run(4.0);
    let goals = |pair: &Pair| pair.others.others(|others| others.goals.clone());
    let first = goals(&pair);
    assert_eq!(first.len(), 1, "{first:?}");
    assert_eq!(first[0].as_ref().unwrap().header.frame_id, "map");
    let tells = |pair: &Pair, navigation| {
        pair.others.others(|others| others.events.push_back(Event::Navigation(navigation)));
    };
    tells(&pair, Navigation::Accepted);
    pair.run(1.0);
    assert_eq!(goals(&pair).len(), 1);
    tells(&pair, Navigation::GivenUp);
    pair.run(1.0);
    assert_eq!(goals(&pair).len(), 2);
    // A goal that is refused is followed by another one, but not at once.
    tells(&pair, Navigation::Refused);
    pair.run(3.0);
    assert_eq!(goals(&pair).len(), 2);
    pair.run(3.0);
    assert_eq!(goals(&pair).len(), 3);
    pair.explore(false);
    pair.run(1.0);
    assert_eq!(goals(&pair).last(), Some(&None));
    pair.explore(true);
    pair.run(1.0);
    assert!(goals(&pair).last().unwrap().is_some());
    // The robot does not move: after a while, the goal is given up.
    tells(&pair, Navigation::Accepted);
    pair.run(32.0);
    assert!(pair.is_said("the robot comes no nearer to the goal"));
}

#[test]
fn a_robot_that_falls_silent_is_stopped() {
    let mut pair = Pair::new(&parameters(Mode::Explore), 0, None);
    pair.run(8.0);
    pair.others.others(|others| others.heard.clear());
    std::thread::sleep(BLIND);
    pair.node.turn(Duration::ZERO);
    assert_stops(&pair.orders());
}

#[test]
fn a_map_that_was_not_sent_is_sent_again() {
    let mut pair = Pair::new(&Parameters { map_update_interval_s: 0.1, ..parameters(Mode::Map) }, 0, None);
    pair.others.others(|others| others.is_slow = true);
    pair.run(1.0);
    assert_eq!(pair.others.heard(Topic::Map), []);
    pair.others.others(|others| others.is_slow = false);
    std::thread::sleep(Duration::from_millis(100));
    pair.run(0.3);
    assert!(!pair.others.heard(Topic::Map).is_empty());
}

#[test]
fn a_state_of_simulated_time_goes_on_in_the_time_of_a_robot() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    let mut simulated = Pair::new(&parameters(Mode::Map), 0, Some(&path));
    simulated.run(3.0);
    simulated.node.run(&Signals { stop: Arc::new(true.into()), ..Signals::default() }).unwrap();
    drop(simulated);
    let mut real = Pair::new(&parameters(Mode::Map), 1_700_000_000, Some(&path));
    real.run(3.0);
    let time_s = real.node.robot.mapper.time();
    assert!((4.0..9.0).contains(&time_s), "{time_s} s");
    assert!(real.is_said("one of the two is simulated"));
}

/// Hours of exploring, as fast as the machine can: memory, the size of the state, and the error of the pose against the
/// truth. See docs/robots.md.
#[test]
#[ignore = "takes minutes per hour; HOURS=8"]
fn a_house_for_hours() {
    let hours = std::env::var("HOURS").map_or(8.0, |hours| hours.parse::<f64>().unwrap());
    let mut pair = Pair::new(&parameters(Mode::Explore), 0, None);
    let start = worldfile::shipped::load("house").unwrap().driven().pose;
    for minutes in 1..=(hours * 60.0) as u64 {
        let mut worst_m = 0.0_f64;
        for _ in 0..60 {
            pair.run(1.0);
            let [truth, odometry] = pair.sim.poses().unwrap();
            let truth = start.inverse() * truth;
            let found = pair.node.published.map_to_odom.unwrap() * odometry;
            worst_m = worst_m.max((truth.translation.vector - found.translation.vector).norm());
            pair.others.others(|others| others.heard.clear());
        }
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let memory = status.lines().find(|line| line.starts_with("VmRSS")).unwrap_or_default();
        let said = std::mem::take(&mut *pair.said.lock().unwrap());
        let lost = said.iter().filter(|text| text.contains("not known")).count();
        let report = pair.node.report();
        assert!(worst_m < 0.1 && report.mapped * 100 >= report.readings * 99, "{worst_m} m, {report:?}");
        println!(
            "{minutes} min: error up to {worst_m:.3} m, lost {lost} times, {} of {} readings mapped, known {}, {memory}",
            report.mapped,
            report.readings,
            known(pair.node.robot.mapper.states())
        );
    }
}
