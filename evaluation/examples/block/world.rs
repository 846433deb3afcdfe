//! Corridors around a block, with niches and rooms on both sides.

use interfaces::{GridFrame, Purpose, RandomStream};
use nalgebra::Point2;
use sim::physics::shape::Rectangle;
use sim::physics::{FleetSpec, OdometryError, WorldSpec};

/// The width of the corridors, m.
const WIDTH_M: f64 = 2.2;
/// The thickness of the walls, m.
const WALL_M: f64 = 0.2;
/// The largest depth of a room, m.
const ROOM_M: f64 = 4.0;
/// The space around the outermost walls, m: a map that is bent must not be cut.
const MARGIN_M: f64 = 3.0;
/// The side of the cells, m.
const CELL_M: f64 = 0.05;

/// The laser of the robot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Laser {
    pub(crate) beams: usize,
    pub(crate) view_rad: f64,
    /// The time that a scan takes, s.
    pub(crate) sweep_s: f64,
}

/// The wall of one side of a corridor, from its outer corner on, and where a rectangle beside it lies in the world.
struct Side {
    corner: Point2<f64>,
    /// Whether the corridor runs along x.
    is_along_x: bool,
    /// The direction along the corridor and away from it: 1 or -1.
    along: f64,
    away: f64,
}

impl Side {
    /// The rectangle from `[begin, end]` along the wall and `[near, far]` behind its face.
    fn rectangle(&self, along_m: [f64; 2], behind_m: [f64; 2]) -> Rectangle {
        let point = |index: usize| {
            let (along, away) = (self.along * along_m[index], self.away * behind_m[index]);
            let (x, y) = if self.is_along_x { (along, away) } else { (away, along) };
            Point2::new(self.corner.x + x, self.corner.y + y)
        };
        let (a, b) = (point(0), point(1));
        Rectangle::between(a.inf(&b), a.sup(&b))
    }
}

/// Whole cells.
fn cells(m: f64) -> f64 {
    (m / CELL_M).round() * CELL_M
}

/// A wall with niches and rooms behind doors.
fn wall(side: &Side, length_m: f64, walls: &mut Vec<Rectangle>, random: &mut RandomStream) {
    let (mut last_m, mut at_m) = (0.0, 1.5);
    loop {
        let is_room = random.bernoulli(0.3);
        let depth_m = cells(if is_room { random.uniform(2.0..ROOM_M) } else { random.uniform(0.2..0.5) });
        let begin_m = at_m + cells(random.uniform(0.8..5.0));
        let end_m = begin_m + cells(random.uniform(0.9..1.6));
        // A room is wider than its door.
        let wider_m = if is_room { 0.7 } else { 0.0 };
        if end_m + wider_m + 1.5 > length_m {
            break;
        }
        let (left_m, right_m) = (begin_m - wider_m, end_m + wider_m);
        walls.push(side.rectangle([last_m, begin_m], [0.0, WALL_M]));
        walls.push(side.rectangle([left_m - WALL_M, left_m], [0.0, depth_m]));
        walls.push(side.rectangle([right_m, right_m + WALL_M], [0.0, depth_m]));
        walls.push(side.rectangle([left_m - WALL_M, right_m + WALL_M], [depth_m, depth_m + WALL_M]));
        (last_m, at_m) = (end_m, end_m + wider_m + 0.6);
    }
    walls.push(side.rectangle([last_m, length_m], [0.0, WALL_M]));
}

/// Corridors around a block of `sides_m`, measured in the middle of the corridor, with a robot whose odometry drifts hard.
pub(crate) fn block(sides_m: [f64; 2], laser: Laser, seed: u64) -> Option<WorldSpec> {
    let mut random = RandomStream::new(seed, Purpose::HouseGenerator);
    let house = WorldSpec::generate_house(seed);
    let mut robot = house.fleet().robots[house.driven_index()].clone();
    let low_m = cells(MARGIN_M + ROOM_M + WALL_M + WIDTH_M / 2.0);
    let [length_m, depth_m] = sides_m;
    let mut walls = Vec::new();
    for (by_m, away) in [(WIDTH_M / 2.0, 1.0), (-WIDTH_M / 2.0, -1.0)] {
        let (from, to) = ([low_m - by_m, low_m - by_m], [low_m + length_m + by_m, low_m + depth_m + by_m]);
        let corners = [[from[0], from[1]], [to[0], from[1]], [to[0], to[1]], [from[0], to[1]]];
        for (number, corner) in corners.into_iter().enumerate() {
            let side = Side {
                corner: corner.into(),
                is_along_x: number % 2 == 0,
                along: if number < 2 { 1.0 } else { -1.0 },
                away: away * if [0, 3].contains(&number) { -1.0 } else { 1.0 },
            };
            let along_m = if number % 2 == 0 { to[0] - from[0] } else { to[1] - from[1] };
            wall(&side, along_m, &mut walls, &mut random);
        }
    }
    robot.pose = interfaces::pose(low_m + 2.0, low_m, 0.0);
    (robot.laser.beams, robot.laser.fov_rad, robot.laser.sweep_s) =
        (laser.beams, laser.view_rad, laser.sweep_s);
    robot.laser.noise_std_m = 0.01;
    robot.odometry = OdometryError {
        distance_gain: 0.05,
        turn_gain: -0.05,
        turn_radpm: 3.0_f64.to_radians(),
        distance_noise_m: 0.05,
        turn_noise_rad: 0.05,
        ..OdometryError::default()
    };
    let [width_m, height_m] = sides_m.map(|side_m| side_m + 2.0 * low_m);
    let fleet = FleetSpec {
        name: format!("block-{seed}"),
        description: "Corridors around a block.".to_owned(),
        frame: GridFrame::covering(Point2::origin(), width_m, height_m, CELL_M)?,
        step_s: house.fleet().step_s,
        contacts: house.fleet().contacts,
        walls,
        glass: Vec::new(),
        obstacles: Vec::new(),
        robots: vec![robot],
        starts_s: None,
    };
    WorldSpec::new(fleet).ok()
}
