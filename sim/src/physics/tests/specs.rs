//! Worlds for the tests, built in code.

use super::*;
use interfaces::{GridFrame, LaserReading, Twist, pose};
use nalgebra::{Point2, Vector2};
use std::f64::consts::TAU;

/// The walls of the four rooms by their lower left and upper right corners, m.
const ROOMS: [[f64; 4]; 11] = [
    [0.0, 0.0, 12.0, 0.1],
    [0.0, 11.9, 12.0, 12.0],
    [0.0, 0.1, 0.1, 11.9],
    [11.9, 0.1, 12.0, 11.9],
    [5.95, 0.1, 6.05, 2.5],
    [5.95, 3.5, 6.05, 8.5],
    [5.95, 9.5, 6.05, 11.9],
    [0.1, 5.95, 2.5, 6.05],
    [3.5, 5.95, 5.95, 6.05],
    [6.05, 5.95, 8.5, 6.05],
    [9.5, 5.95, 11.9, 6.05],
];

/// The walls of four rooms whose lower left corner is at (`x`, `y`), m.
pub(super) fn rooms(x: f64, y: f64) -> impl Iterator<Item = Rectangle> {
    ROOMS.into_iter().map(move |[left, bottom, right, top]| {
        Rectangle::between(Point2::new(left + x, bottom + y), Point2::new(right + x, top + y))
    })
}

/// A laser of `beams` over a full turn, up to 10 m.
fn laser(beams: usize) -> LaserSpec {
    LaserSpec { beams, ..RobotSpec::new("", pose(0.0, 0.0, 0.0), BehaviorSpec::Standing).laser }
}

/// The four rooms with these robots and obstacles.
fn house(robots: Vec<RobotSpec>, obstacles: Vec<ObstacleSpec>) -> FleetSpec {
    let frame = GridFrame::covering(Point2::origin(), 12.0, 12.0, 0.05).unwrap();
    let walls = rooms(0.0, 0.0).collect();
    FleetSpec {
        name: "house".into(),
        description: String::new(),
        frame,
        step_s: 0.05,
        contacts: ContactModel::default(),
        walls,
        glass: Vec::new(),
        obstacles,
        robots,
        starts_s: None,
    }
}

/// The four rooms with the driven robot and the dummy robot, which stands still here.
pub(super) fn four_rooms() -> FleetSpec {
    let curious = RobotSpec::new("curious", pose(2.0, 2.0, 0.0), BehaviorSpec::Driven);
    let dummy = RobotSpec::new("dummy", pose(7.2, 11.5, 0.0), BehaviorSpec::Standing);
    house(
        vec![RobotSpec { laser: laser(720), ..curious }, RobotSpec { laser: laser(180), ..dummy }],
        Vec::new(),
    )
}

/// Wandering robots in all rooms.
pub(super) fn crowd() -> FleetSpec {
    let robot = |i: u32| {
        let at = [1.0 + 2.0 * f64::from(i % 6), 1.0 + 2.0 * f64::from(i / 6)];
        let heading_rad = f64::from((40 * i) % 360).to_radians();
        let wander = BehaviorSpec::Wander(WanderSpec { speed_mps: 0.4, clearance_m: 0.15 });
        let robot = RobotSpec::new(&format!("r{i}"), pose(at[0], at[1], heading_rad), wander);
        RobotSpec { laser: LaserSpec { noise_std_m: 0.005, ..laser(90) }, ..robot }
    };
    house((0..36).map(robot).collect(), Vec::new())
}

/// A box of 0.3 m that can be pushed.
fn pushed(center: Point2<f64>, heading_deg: f64, mass_kg: f64, friction: f64) -> ObstacleSpec {
    let shape = Rectangle::around(center, Vector2::repeat(0.3), heading_deg.to_radians());
    ObstacleSpec::new("box", shape, Motion::Pushed(PushedSpec { mass_kg, friction }))
}

/// A heavy robot at [1, 2] that drives along x, and twelve boxes ahead of it.
pub(super) fn heap() -> FleetSpec {
    let driver = RobotSpec::new("driver", pose(1.0, 2.0, 0.0), BehaviorSpec::Driven);
    let boxes = (0..12_u32).map(|i| {
        let center = Point2::new(1.6 + 0.31 * f64::from(i % 4), 1.6 + 0.32 * f64::from(i / 4));
        pushed(center, 0.0, 0.3, 0.02 * f64::from(i % 3))
    });
    house(vec![RobotSpec { mass_kg: Some(20.0), ..driver }], boxes.collect())
}

/// A block that moves repeatedly along these points at 0.7 m/s.
fn block(size_m: [f64; 2], points: &[[f64; 2]]) -> ObstacleSpec {
    let points: Vec<Point2<f64>> = points.iter().map(|point| Point2::from(*point)).collect();
    let mut keys = vec![(0.0, points[0])];
    for at in points[1..].iter().chain(&points[..1]) {
        let (time_s, before) = keys[keys.len() - 1];
        keys.push((time_s + (at - before).norm() / 0.7, *at));
    }
    let shape = Rectangle::around(points[0], Vector2::from(size_m), 15.0_f64.to_radians());
    ObstacleSpec::new("block", shape, Motion::Path(PathSpec { keys, is_loop: true }))
}

/// The leaf of a door from one point to the other that opens and closes at random.
fn door(from: [f64; 2], to: [f64; 2], is_hinged: bool) -> ObstacleSpec {
    let (from, to) = (Point2::from(from), Point2::from(to));
    let leaf = match is_hinged {
        true => Leaf::Hinged { hinge: from, open_rad: TAU / 4.0 },
        false => Leaf::Sliding { by_m: from - to },
    };
    let opening = Opening::Random { closed_s: 1.0, open_s: 1.5 };
    let door = DoorSpec { leaf, opening, move_s: 1.0, starts_open: false };
    ObstacleSpec::new("door", Rectangle::along(from, to, 0.04), Motion::Door(door))
}

/// The four rooms with everything that moves, and robots that push.
pub(super) fn busy() -> FleetSpec {
    let places = [[2.0, 2.0], [9.0, 3.0], [3.0, 9.0], [9.5, 9.0]];
    let robot = |[x, y]: [f64; 2]| {
        let robot = RobotSpec::new("pusher", pose(x, y, 30.0_f64.to_radians()), BehaviorSpec::Driven);
        let laser = LaserSpec { noise_std_m: 0.005, ..laser(90) };
        let mut robot = RobotSpec { mass_kg: Some(20.0), laser, ..robot };
        // One of them is not round.
        if x > 9.2 {
            let corners = [[-0.3, -0.15], [0.3, -0.1], [0.3, 0.1], [-0.3, 0.15]].map(Point2::from);
            robot.radius_m = corners[0].coords.norm();
            robot.corners = corners.to_vec();
        }
        robot
    };
    let mut things = Vec::new();
    for [x, y] in places {
        for (k, (dx, dy)) in [(0.6, 0.0), (0.0, 0.7), (-0.6, 0.3)].into_iter().enumerate() {
            let k = k as f64;
            things.push(pushed(Point2::new(x + dx, y + dy), 20.0 * k, 0.5 + k, 0.1 * k));
        }
    }
    things.push(block([1.6, 0.1], &[[4.5, 1.5], [4.0, 4.5]]));
    things.push(block([0.2, 0.3], &[[7.0, 1.0], [11.0, 1.0], [11.0, 5.0]]));
    things.push(door([6.0, 2.5], [6.0, 3.5], true));
    things.push(door([8.5, 6.0], [9.5, 6.0], false));
    things.push(door([2.5, 6.0], [3.5, 6.0], true));
    house(places.map(robot).to_vec(), things)
}

/// Robots that ignore their sensors and drive in wild curves.
pub(super) fn reckless(robot: &RobotView<'_>, reading: &LaserReading) -> Twist {
    let phase = reading.time_s * (0.3 + 0.1 * robot.index as f64);
    Twist { linear_mps: 0.5 * libm::cos(phase * 0.7), angular_radps: 1.5 * libm::sin(phase) }
}
