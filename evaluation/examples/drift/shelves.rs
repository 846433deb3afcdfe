//! Rooms in which most of the view shifts at once.

use interfaces::{GridFrame, Purpose, RandomStream};
use nalgebra::{Point2, Vector2};
use sim::physics::shape::Rectangle;
use sim::physics::{FleetSpec, Motion, ObstacleSpec, PathSpec, WorldSpec};

/// The thickness of the walls, m.
const WALL_M: f64 = 0.1;
/// The distance of the shelves from the wall: they never touch it, m.
const CLEARANCE_M: f64 = 0.12;
/// The time from one shift to the next, s.
const STAY_S: f64 = 30.0;
/// The duration of a shift, s: one step of the simulation.
const SHIFT_S: f64 = 0.05;
/// The shelves shift for this long, min.
const MAX_MINUTES: f64 = 60.0;

/// A room of random size with shelves along its walls. Every half minute all of them shift by the same 4 to 8 cm, or back.
/// The robot is that of the generated house of this seed, in the middle of the room.
pub(crate) fn room(seed: u64) -> Option<WorldSpec> {
    let house = WorldSpec::generate_house(seed);
    let mut robot = house.fleet().robots[house.driven_index()].clone();
    let mut random = RandomStream::new(seed, Purpose::HouseGenerator);
    let size = Vector2::new(random.uniform(5.0..8.0), random.uniform(4.0..6.0));
    robot.pose = interfaces::pose(size.x / 2.0, size.y / 2.0, random.uniform(-3.0..3.0));
    let walls = [
        ([0.0, 0.0], [size.x, WALL_M]),
        ([0.0, size.y - WALL_M], [size.x, size.y]),
        ([0.0, WALL_M], [WALL_M, size.y - WALL_M]),
        ([size.x - WALL_M, WALL_M], [size.x, size.y - WALL_M]),
    ];
    let walls = walls.map(|(min, max)| Rectangle::between(min.into(), max.into())).to_vec();
    let shifts: Vec<Vector2<f64>> = (0..(MAX_MINUTES * 60.0 / STAY_S) as usize)
        .map(|number| {
            let shift =
                interfaces::rotation(random.uniform(-3.0..3.0)) * Vector2::x() * random.uniform(0.04..0.08);
            if number % 2 == 0 { shift } else { Vector2::zeros() }
        })
        .collect();
    let obstacles = shelves(&size, &shifts, &mut random);
    let fleet = FleetSpec {
        name: format!("shelves-{seed}"),
        description: "A room with shelves that shift.".to_owned(),
        frame: GridFrame::covering(Point2::origin(), size.x, size.y, 0.05)?,
        step_s: house.fleet().step_s,
        contacts: house.fleet().contacts,
        walls,
        glass: Vec::new(),
        obstacles,
        robots: vec![robot],
        starts_s: None,
    };
    WorldSpec::new(fleet).ok()
}

/// Shelves along the four walls, with gaps between them.
fn shelves(size: &Vector2<f64>, shifts: &[Vector2<f64>], random: &mut RandomStream) -> Vec<ObstacleSpec> {
    let mut obstacles = Vec::new();
    for side in 0..4 {
        let (length_m, is_along_x) = if side % 2 == 0 { (size.x, true) } else { (size.y, false) };
        let mut at_m = WALL_M + CLEARANCE_M + 0.4;
        loop {
            let (shelf_m, depth_m) = (random.uniform(1.0..2.0), random.uniform(0.25..0.4));
            let end_m = at_m + shelf_m;
            if end_m > length_m - WALL_M - CLEARANCE_M - 0.4 {
                break;
            }
            let out_m = WALL_M + CLEARANCE_M + depth_m / 2.0;
            let across_m = match side {
                0 | 3 => out_m,
                1 => size.x - out_m,
                _ => size.y - out_m,
            };
            let (center, sides) = if is_along_x {
                (Point2::new(at_m.midpoint(end_m), across_m), Vector2::new(shelf_m, depth_m))
            } else {
                (Point2::new(across_m, at_m.midpoint(end_m)), Vector2::new(depth_m, shelf_m))
            };
            obstacles.push(shelf(format!("shelf {}", obstacles.len() + 1), center, sides, shifts));
            at_m = end_m + random.uniform(0.3..1.0);
        }
    }
    obstacles
}

/// Whether the shelves shift within a second.
pub(crate) fn is_near_shift(time_s: f64) -> bool {
    (time_s + 1.0) % STAY_S < 2.0
}

fn shelf(name: String, center: Point2<f64>, sides: Vector2<f64>, shifts: &[Vector2<f64>]) -> ObstacleSpec {
    let (mut keys, mut before) = (vec![(0.0, center)], center);
    for (number, shift) in shifts.iter().enumerate() {
        let time_s = STAY_S * (number + 1) as f64;
        keys.push((time_s, before));
        before = center + shift;
        keys.push((time_s + SHIFT_S, before));
    }
    let motion = Motion::Path(PathSpec { keys, is_loop: false });
    ObstacleSpec::new(&name, Rectangle::around(center, sides, 0.0), motion)
}
