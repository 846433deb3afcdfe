//! Random buildings, each from a seed: rooms at a corridor, furniture, doors, people who walk from room to room, and a
//! robot that explores.

pub mod building_ranges;
mod calendar;
mod doors;
mod draw;
mod furniture;
mod layout;
mod plan;
mod rooms;
mod routes;

use super::shape::Rectangle;
use super::spec::{
    BehaviorSpec, ContactModel, DriveLimits, FleetSpec, Motion, ObstacleSpec, Repeat, RobotSpec, WanderSpec,
    WaypointsSpec, WorldSpec,
};
use crate::building_calendar::{self, BuildingCalendar};
use ::calendar::Kind;
use building_ranges::BuildingRanges;
use draw::{CELLS_PER_M, integer, value};
use furniture::Piece;
use interfaces::{GridFrame, Purpose, RandomStream, pose};
use layout::Layout;
use nalgebra::Point2;
use plan::Plan;
use rand::RngExt;
use routes::Routes;

/// The physics step, s.
const STEP_S: f64 = 0.05;
/// The largest number of draws until a building has a place for the explorer and a round for every person.
const MAX_DRAWS: usize = 100;
/// The number of draws until a robot has a place away from all others.
const MAX_PLACES: usize = 50;
/// The distance between two robots at the start, m.
const APART_M: f64 = 0.8;
/// The free space that a robot keeps ahead, m.
const CLEARANCE_M: f64 = 0.15;

impl WorldSpec {
    /// A random house, named `house-` and the seed, with the parameters of [`building_ranges::HOUSE`]. All rooms are
    /// connected while the doors are open; nothing is inside another thing; every round of a person keeps off walls and
    /// furniture. The same seed gives the same house, on every machine.
    pub fn generate_house(seed: u64) -> Self {
        generate(&building_ranges::HOUSE, seed, None)
    }

    /// A random office, named `office-` and the seed: as [a house](Self::generate_house), with the parameters of
    /// [`building_ranges::OFFICE`].
    pub fn generate_office(seed: u64) -> Self {
        generate(&building_ranges::OFFICE, seed, None)
    }

    /// A random building with a calendar, named `calendar-`, its kind and the seed, from Monday 0:00 on: doors, and boxes,
    /// people and parked robots that are in their places or not, have schedules drawn from frozen ranges. Nobody walks. Homes
    /// have the walls of [houses](Self::generate_house), the others those of [offices](Self::generate_office), larger ones.
    pub fn generate_calendar(kind: Kind, seed: u64) -> Self {
        let ranges = match kind {
            Kind::Home => &building_ranges::HOUSE,
            Kind::Office => &building_ranges::OFFICE,
            Kind::Warehouse => &building_ranges::WAREHOUSE,
            Kind::Clinic => &building_ranges::CLINIC,
        };
        generate(ranges, seed, Some(kind))
    }

    /// The generated building with this name, as `house-7`, `office-7`, `rooms-7`, `rooms-day-7` or `calendar-office-7`; `None` for
    /// other names.
    ///
    /// `rooms-` are 4 to 64 rooms in a grid. In a fifth to three fifths of them one to three things (boxes, discs, chairs,
    /// L-shapes, parked robots) come and go, move between two or three places, or leave for good, with mean stays of 10 s to 30 min
    /// (`rooms-day-`: to 12 h). In one of four worlds all these stays change once. Things and doors never close a room.
    pub fn generated(name: &str) -> Option<Self> {
        let (kind, seed) = name.rsplit_once('-')?;
        let seed = seed.parse().ok()?;
        match kind {
            "house" => Some(Self::generate_house(seed)),
            "office" => Some(Self::generate_office(seed)),
            "rooms" => rooms::rooms(kind, &building_calendar::ROOMS, seed),
            "rooms-day" => rooms::rooms(kind, &building_calendar::ROOMS_DAY, seed),
            _ => Some(Self::generate_calendar(kind.strip_prefix("calendar-")?.parse().ok()?, seed)),
        }
    }
}

/// The building of a seed, with the calendar of a kind if one is given.
fn generate(ranges: &BuildingRanges, seed: u64, kind: Option<Kind>) -> WorldSpec {
    let mut rng = RandomStream::new(seed, Purpose::HouseGenerator);
    let mut buildings = (0..MAX_DRAWS).filter_map(|_| draw_building(ranges, seed, kind, &mut rng));
    buildings.next().expect("with these ranges, a building fails in less than one of ten draws")
}

/// A building, unless a robot found no place in it.
fn draw_building(
    ranges: &BuildingRanges,
    seed: u64,
    kind: Option<Kind>,
    rng: &mut RandomStream,
) -> Option<WorldSpec> {
    let layout = Layout::new(ranges, rng);
    let plan = Plan { is_upright: rng.random() };
    let walls: Vec<Rectangle> = layout.solid_walls().iter().map(|wall| plan.rectangle(wall)).collect();
    let mut obstacles: Vec<ObstacleSpec> =
        furniture::furniture(&layout, rng).iter().map(|piece| standing(piece, &plan)).collect();
    obstacles.extend(doors::doors(&layout, &plan, rng));
    let solids: Vec<Rectangle> =
        walls.iter().copied().chain(obstacles.iter().map(ObstacleSpec::opened)).collect();
    let routes = Routes::new(&layout, &solids, &plan, rng);
    let mut robots = robots(&routes, rng)?;
    if let Some(kind) = kind {
        robots.truncate(1); // the explorer
        let (mut calendar, start) = (BuildingCalendar::new(kind, seed), robots[0].pose.translation.vector);
        calendar::schedule_doors(&mut calendar, &mut obstacles);
        obstacles.extend(calendar::things(&mut calendar, &routes, &plan, &start.into()));
    }
    let size = plan.point(layout.size.map(f64::from));
    let frame = GridFrame::covering(Point2::origin(), size.x, size.y, 1.0 / CELLS_PER_M);
    let count =
        |kind: fn(&Motion) -> bool| obstacles.iter().filter(|obstacle| kind(&obstacle.motion)).count();
    let doors = count(|motion| matches!(motion, Motion::Door(_)));
    let people = robots.iter().filter(|robot| matches!(robot.behavior, BehaviorSpec::Waypoints(_))).count();
    let description = format!(
        "{} rooms at a corridor, doors: {doors}, people: {people}; made at random from the seed {seed}.",
        layout.spaces.len() - 1
    );
    let name = match kind {
        Some(kind) => format!("calendar-{}-{seed}", kind.name()),
        None => format!("{}-{seed}", ranges.kind),
    };
    let contacts = ContactModel::RigidBodies;
    let (frame, step_s, glass, starts_s) = (frame?, STEP_S, Vec::new(), kind.map(|_| 0.0));
    let fleet =
        FleetSpec { name, description, frame, step_s, contacts, walls, glass, obstacles, robots, starts_s };
    WorldSpec::new(fleet).ok()
}

/// A piece of furniture as an obstacle.
fn standing(piece: &Piece, plan: &Plan) -> ObstacleSpec {
    let shape = match piece.turned {
        None => plan.rectangle(&piece.area),
        Some((side, heading_deg)) => plan.turned(&piece.area, side, f64::from(heading_deg).to_radians()),
    };
    ObstacleSpec::new(&piece.name, shape, Motion::Fixed)
}

/// The explorer, the people, and perhaps a vacuum cleaner.
fn robots(routes: &Routes, rng: &mut RandomStream) -> Option<Vec<RobotSpec>> {
    let ranges = routes.ranges;
    let mut robots = vec![robot("curious", routes.place(rng)?, BehaviorSpec::Driven, 0.2, 0.8, rng)];
    robots[0].laser.beams = 720;
    for number in 1..=integer(ranges.people, rng) {
        let mut rounds = (0..MAX_PLACES).filter_map(|_| routes.round(rng));
        let points = rounds.find(|points| is_apart(&robots, &points[0]))?;
        let speed_mps = value(ranges.person_speed_mps, rng);
        let (start, repeat) = (points[0], Repeat::Loop);
        let behavior =
            BehaviorSpec::Waypoints(WaypointsSpec { points, speed_mps, repeat, clearance_m: CLEARANCE_M });
        let radius_m = value(ranges.person_radius_m, rng);
        robots.push(robot(&format!("person {number}"), start, behavior, radius_m, 1.0, rng));
    }
    if rng.bernoulli(ranges.vacuum_cleaner_probability) {
        let start = (0..MAX_PLACES).filter_map(|_| routes.place(rng)).find(|at| is_apart(&robots, at))?;
        let behavior = BehaviorSpec::Wander(WanderSpec { speed_mps: 0.3, clearance_m: CLEARANCE_M });
        robots.push(robot("vacuum cleaner", start, behavior, 0.17, 0.4, rng));
    }
    Some(robots)
}

fn is_apart(robots: &[RobotSpec], at: &Point2<f64>) -> bool {
    robots.iter().all(|other| (other.pose.translation.vector - at.coords).norm() >= APART_M)
}

/// A round robot with two wheels and a laser all around.
fn robot(
    name: &str,
    at: Point2<f64>,
    behavior: BehaviorSpec,
    radius_m: f64,
    max_linear_mps: f64,
    rng: &mut RandomStream,
) -> RobotSpec {
    let heading_rad = f64::from(rng.random_range(-17..=18) * 10).to_radians();
    let mut robot = RobotSpec::new(name, pose(at.x, at.y, heading_rad), behavior);
    robot.radius_m = radius_m;
    robot.drive = DriveLimits {
        max_linear_mps,
        max_angular_radps: 150.0_f64.to_radians(),
        max_linear_acceleration_mps2: 1.5,
        max_angular_acceleration_radps2: 600.0_f64.to_radians(),
        ..robot.drive
    };
    if robot.behavior != BehaviorSpec::Driven {
        (robot.laser.beams, robot.laser.range_max_m) = (120, 4.0);
    }
    robot
}
