//! A fleet at its start: what is the same for every seed, built once and shared.

use super::Fleet;
use super::slide::Sliding;
use crate::physics::bodies::Bodies;
use crate::physics::convex;
use crate::physics::free_space::{FreePoses, divide, fits};
use crate::physics::ground_truth::cover::box_cells;
use crate::physics::ground_truth::start::walls_cover;
use crate::physics::obstacles::Obstacle;
use crate::physics::past::Past;
use crate::physics::rays::{Disc, Scene};
use crate::physics::report::Body;
use crate::physics::robot::SimulatedRobot;
use crate::physics::sensors::SharedBeams;
use crate::physics::shape::{Rectangle, grid_corners};
use crate::physics::spec::{FleetSpec, RobotSpec};
use interfaces::{GridFrame, TrueState};
use nalgebra::{Isometry2, Point2};
use std::collections::VecDeque;
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

/// Everything at the start that does not depend on the seed.
pub(super) struct Start {
    pub(super) spec: FleetSpec,
    bodies: Bodies,
    /// With random streams that every fleet replaces by its own.
    obstacles: Vec<Obstacle>,
    scene: Scene,
    beams: SharedBeams,
    /// The rooms whose doors wait for robots.
    pub(super) rooms: Rooms,
    /// Where each robot that is carried away can be set down.
    pub(super) carried: Vec<Option<FreePoses>>,
    /// The robots that have corners.
    cornered: Vec<usize>,
}

impl Start {
    pub(super) fn new(spec: &FleetSpec) -> Self {
        let mut bodies = Bodies::new(spec);
        for (index, wall) in spec.walls.iter().enumerate() {
            bodies.add_box(Body::Wall(index), wall);
        }
        for robot in &spec.robots {
            bodies.add_robot(robot, spec.step_s);
        }
        let poses: Vec<_> = (0..spec.robots.len()).map(|index| bodies.pose(index)).collect();
        let obstacles = spec.obstacles.iter().enumerate();
        let obstacles =
            obstacles.map(|(index, obstacle)| Obstacle::new(obstacle, index, spec.starts_s, &mut bodies));
        let obstacles: Vec<Obstacle> = obstacles.collect();
        // A robot with corners is a disc of radius 0, and a polygon after those of the obstacles.
        let discs = spec.robots.iter().zip(&poses).map(|(robot, pose)| Disc {
            center: pose.translation.vector.into(),
            radius_m: if robot.corners.is_empty() { robot.radius_m } else { 0.0 },
        });
        let cornered = spec.robots.iter().enumerate().filter(|(_, robot)| !robot.corners.is_empty());
        let cornered: Vec<usize> = cornered.map(|(index, _)| index).collect();
        let range_m = spec.robots.iter().map(RobotSpec::range_m).fold(0.0, f64::max);
        let polygons = spec.obstacles.len() + cornered.len();
        let mut scene =
            Scene::new(grid_corners(&spec.frame), &spec.walls, discs.collect(), polygons, range_m);
        obstacles.iter().enumerate().for_each(|(index, obstacle)| show_obstacle(&mut scene, index, obstacle));
        let carried = spec.robots.iter().enumerate().map(|(index, robot)| {
            robot.odometry.carried?;
            FreePoses::reachable(spec, index)
        });
        let mut start = Self {
            spec: spec.clone(),
            bodies,
            obstacles,
            scene,
            beams: SharedBeams::default(),
            rooms: Rooms::new(spec),
            carried: carried.collect(),
            cornered,
        };
        let mut scene = start.scene.clone();
        poses.iter().enumerate().for_each(|(index, pose)| start.show_robot(&mut scene, index, pose));
        start.scene = scene;
        // Robots with the same sensors share beams, which are computed here and in no fleet.
        let mut beams = SharedBeams::default();
        start.robots(0, &mut beams);
        start.beams = beams;
        start
    }

    fn robots(&self, seed: u64, beams: &mut SharedBeams) -> Vec<SimulatedRobot> {
        let robots = self.spec.robots.iter().enumerate();
        let robots = robots.map(|(index, robot)| {
            SimulatedRobot::new(robot, index, self.bodies.pose(index), self.spec.step_s, seed, beams)
        });
        robots.collect()
    }

    /// Updates a robot in a scene that lasers see.
    pub(super) fn show_robot(&self, scene: &mut Scene, index: usize, pose: &Isometry2<f64>) {
        scene.move_disc(index, pose.translation.vector.into());
        if let Ok(polygon) = self.cornered.binary_search(&index) {
            let corners = self.spec.robots[index].corners.iter().map(|corner| pose * corner);
            scene.set_polygon(self.obstacles.len() + polygon, Some(index), corners);
        }
    }
}

/// Updates an obstacle in a scene that lasers see.
pub(super) fn show_obstacle(scene: &mut Scene, index: usize, obstacle: &Obstacle) {
    let corners = obstacle.shape.corners();
    let corners: &[Point2<f64>] = if obstacle.is_standing() { &corners } else { &[] };
    scene.set_polygon(index, None, corners.iter().copied());
}

impl Fleet {
    /// The fleet at its start, with the random streams of a seed.
    pub(super) fn begin(start: Arc<Start>, seed: u64) -> Self {
        let obstacles = start.obstacles.iter().enumerate();
        Self {
            seed,
            step: 0,
            bodies: start.bodies.clone(),
            robots: start.robots(seed, &mut start.beams.clone()),
            obstacles: obstacles
                .map(|(index, obstacle)| obstacle.reseeded(index, start.spec.starts_s, seed))
                .collect(),
            scene: start.scene.clone(),
            past: Past::new(&start.spec),
            contacts: Vec::new(),
            moved: Vec::new(),
            before: Vec::new(),
            sliding: Sliding::default(),
            parallel_lasers: false,
            start,
        }
    }
}

// Rooms that are not closed while a robot must get out of them, or into them.

/// How far beside a closed leaf a free cell is looked for, m.
const BESIDE_M: f64 = 0.5;

/// The rooms between the doors that wait for robots, and the doors on the way from each room to the dock of each robot.
pub(super) struct Rooms {
    frame: GridFrame,
    /// The room of each cell while all of these doors are closed; a doorway belongs to the room farther from the docks.
    rooms: Vec<Option<usize>>,
    /// For each robot with a dock: the doors on the way with the fewest doors, by room.
    ways: Vec<(usize, Vec<Vec<usize>>)>,
}

/// A door between two rooms.
struct Passage {
    obstacle: usize,
    rooms: [usize; 2],
}

impl Rooms {
    fn new(spec: &FleetSpec) -> Self {
        let frame = spec.frame;
        let waiting = spec.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.waits_for_robots());
        let leaves: Vec<(usize, Rectangle)> = waiting.map(|(index, door)| (index, door.shape)).collect();
        if leaves.is_empty() || spec.docks().next().is_none() {
            return Self { frame, rooms: Vec::new(), ways: Vec::new() };
        }
        let (mut rooms, count) = separate(spec, &leaves);
        let room_at = |rooms: &[Option<usize>], at: &Point2<f64>| {
            frame.index(frame.cell_at(at)).and_then(|cell| rooms[cell])
        };
        let passages = leaves.iter().filter_map(|(obstacle, leaf)| {
            let beside = |side: f64| {
                let steps = (0..).map(|step| leaf.half_m.y + f64::from(step) * frame.resolution_m());
                let mut near = steps.take_while(|from_m| *from_m <= leaf.half_m.y + BESIDE_M);
                near.find_map(|from_m| room_at(&rooms, &(leaf.pose * Point2::new(0.0, side * from_m))))
            };
            Some(Passage { obstacle: *obstacle, rooms: [beside(-1.0)?, beside(1.0)?] })
        });
        let passages: Vec<Passage> = passages.collect();
        let ways = spec
            .docks()
            .filter_map(|(robot, dock)| Some((robot, ways_to(room_at(&rooms, &dock)?, count, &passages))));
        let ways: Vec<(usize, Vec<Vec<usize>>)> = ways.collect();
        for passage in &passages {
            let doors = |room: &usize| ways.iter().map(|(_, ways)| ways[*room].len()).sum::<usize>();
            let far = passage.rooms.into_iter().max_by_key(doors);
            box_cells(&frame, &spec.obstacles[passage.obstacle].shape, |cell, _| {
                rooms[cell] = rooms[cell].or(far);
            });
        }
        Self { frame, rooms, ways }
    }

    /// Whether a robot is where it needs this door to get to its dock.
    pub(super) fn is_needed(&self, obstacle: usize, robots: &[SimulatedRobot]) -> bool {
        self.ways.iter().any(|(robot, ways)| {
            let cell = self.frame.index(self.frame.cell_at(&robots[*robot].at()));
            let room = cell.and_then(|cell| self.rooms[cell]);
            room.is_some_and(|room| ways[room].contains(&obstacle))
        })
    }
}

/// The room of each free cell, and the number of rooms: where the smallest robot with a dock could drive while all leaves are closed, and
/// all other obstacles away. A cell where it does not fit, as in the gap beside a leaf, belongs to the room that is nearest.
fn separate(spec: &FleetSpec, leaves: &[(usize, Rectangle)]) -> (Vec<Option<usize>>, usize) {
    let frame = &spec.frame;
    let boxes: Vec<Rectangle> = spec.walls.iter().chain(leaves.iter().map(|leaf| &leaf.1)).copied().collect();
    let states = walls_cover(frame, &boxes);
    let is_free: Vec<bool> = states.iter().map(|state| *state == TrueState::Free).collect();
    let inner_m = spec.docks().map(|(robot, _)| inner_m(&spec.robots[robot])).fold(f64::INFINITY, f64::min);
    // A robot that fits somewhere is at most half a diagonal from the center of its cell.
    let radius_m = (inner_m - FRAC_1_SQRT_2 * frame.resolution_m()).max(0.0);
    let mut is_open = fits(frame, &boxes, radius_m);
    is_open.iter_mut().zip(&is_free).for_each(|(open, free)| *open &= free);
    let mut rooms = vec![None; frame.len()];
    let count = divide(frame, &is_open, &mut rooms, 0).len();
    let mut reached: VecDeque<usize> = (0..frame.len()).filter(|cell| is_open[*cell]).collect();
    while let Some(cell) = reached.pop_front() {
        for beside in frame.beside(cell) {
            if is_free[beside] && rooms[beside].is_none() {
                rooms[beside] = rooms[cell];
                reached.push_back(beside);
            }
        }
    }
    // Rooms without a place for a robot, as between two doors.
    let narrow = divide(frame, &is_free, &mut rooms, count).len();
    (rooms, count + narrow)
}

/// The radius of a disc that lies within the body of a robot, m.
fn inner_m(robot: &RobotSpec) -> f64 {
    if robot.corners.is_empty() { robot.radius_m } else { convex::inner_m(&robot.corners) }
}

/// For each room, the doors on the way to a room with the fewest doors.
fn ways_to(dock: usize, count: usize, passages: &[Passage]) -> Vec<Vec<usize>> {
    let mut ways: Vec<Option<Vec<usize>>> = vec![None; count];
    ways[dock] = Some(Vec::new());
    let mut reached = vec![dock];
    let mut next = 0;
    while let Some(room) = reached.get(next).copied() {
        next += 1;
        for Passage { obstacle, rooms: [one, other] } in passages {
            for (from, to) in [(*one, *other), (*other, *one)] {
                if from == room && ways[to].is_none() {
                    let mut way = ways[room].clone().unwrap_or_default();
                    way.push(*obstacle);
                    ways[to] = Some(way);
                    reached.push(to);
                }
            }
        }
    }
    ways.into_iter().map(Option::unwrap_or_default).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::spec::WorldSpec;
    use ::calendar::Kind;
    use std::collections::BTreeMap;

    /// Generated leaves leave no gap: the rooms are what free cells connect.
    #[test]
    fn rooms_without_gaps_are_what_free_cells_connect() {
        let kinds = [Kind::Home, Kind::Office, Kind::Warehouse, Kind::Clinic];
        let mut with_doors = 0;
        for (kind, seed) in kinds.into_iter().flat_map(|kind| (0..6).map(move |seed| (kind, seed))) {
            let spec = WorldSpec::generate_calendar(kind, seed);
            let (spec, frame) = (spec.fleet(), spec.frame);
            let doors = spec.obstacles.iter().enumerate().filter(|(_, door)| door.waits_for_robots());
            let leaves: Vec<(usize, Rectangle)> = doors.map(|(index, door)| (index, door.shape)).collect();
            with_doors += usize::from(!leaves.is_empty());
            let (rooms, count) = separate(spec, &leaves);
            let boxes: Vec<Rectangle> =
                spec.walls.iter().chain(leaves.iter().map(|leaf| &leaf.1)).copied().collect();
            let states = walls_cover(&frame, &boxes);
            let is_free: Vec<bool> = states.iter().map(|state| *state == TrueState::Free).collect();
            let mut connected = vec![None; frame.len()];
            assert_eq!(divide(&frame, &is_free, &mut connected, 0).len(), count, "{kind:?} {seed}");
            let pairs: BTreeMap<_, _> = connected.iter().zip(&rooms).collect();
            assert!(connected.iter().zip(&rooms).all(|(connected, room)| pairs[connected] == room));
        }
        assert!(with_doors > 12, "{with_doors}");
    }
}
