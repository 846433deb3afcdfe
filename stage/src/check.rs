//! What the physics cannot do, reported at the line of the Stage file.

use super::sources::Sources;
use super::to_toml::{STEER_DEG, is_upright};
use super::{Drive, StageRobot, StageWall, StageWorld, fastest};
use sim::physics::shape::TOUCH_M;
use sim::physics::{BoxTree, Form, Rectangle};
use std::f64::consts::PI;
use std::ops::RangeInclusive;
use worldfile::Severity;
use worldfile::physics::{MAX_OUT_M, MAX_PIECES};
use worldfile::toml_value::short;

/// The maximum number of lasers of a robot, and of sonars.
const MAX_SENSORS: usize = 100;
/// The minimum field of view of a laser or a fiducial finder, rad: 1°.
const MIN_FOV_RAD: f64 = PI / 180.0;
/// The maximum side of a map, m.
const MAX_MAP_M: f64 = 1000.0;
/// The sides of a wall, m; upright ones may be of any length.
const SIDE_M: RangeInclusive<f64> = 0.001..=100.0;

/// Adds an error for everything that the physics cannot simulate, and a warning for everything that it simulates
/// differently.
pub(super) fn check(sources: &mut Sources<'_>, world: &StageWorld) {
    let pieces: usize = world.walls.iter().map(|wall| wall.rectangles.len()).sum();
    if pieces > MAX_PIECES {
        let what = format!("the walls of this world are of {pieces} pieces");
        let help = format!("{MAX_PIECES} are the most: take coarser pictures, or blocks with fewer corners");
        return sources.add_file(Severity::Error, what, help);
    }
    let size_m = world.map().size_m;
    if size_m.max() > MAX_MAP_M {
        let what = format!("this world is {:.0} × {:.0} m large", size_m.x, size_m.y);
        let help = format!("its robots and walls must lie within {MAX_MAP_M} × {MAX_MAP_M} m");
        sources.add_file(Severity::Error, what, help);
    }
    check_walls(sources, world);
    let room = Room::new(world);
    for (index, robot) in world.robots.iter().enumerate() {
        check_figures(sources, robot);
        warn_of_drive(sources, robot);
        check_sensors(sources, robot);
        room.check(sources, index);
    }
}

fn check_walls(sources: &mut Sources<'_>, world: &StageWorld) {
    let help = format!(
        "what stands is {} m thick or more, and what is turned or has a tag {} m or less",
        SIDE_M.start(),
        SIDE_M.end()
    );
    for wall in &world.walls {
        let sides = wall.rectangles.iter().map(|rectangle| (rectangle, 2.0 * rectangle.half_m));
        let thin = sides.clone().find(|(_, sides)| short(sides.min()) < *SIDE_M.start());
        let thick = sides.clone().find(|(rectangle, sides)| {
            let side_m = if wall.tag.is_some() { sides.max() } else { sides.min() };
            (wall.tag.is_some() || !is_upright(rectangle)) && short(side_m) > *SIDE_M.end()
        });
        if let Some((_, sides)) = thin.or(thick) {
            let (x, y) = (short(sides.x), short(sides.y));
            sources.error(wall.at, format!("`{}` has a part of {x} × {y} m", wall.name), &help);
        }
    }
}

/// A figure of a robot: the key that gives it, what it says, its value, its unit, and its range.
type Figure = (&'static str, &'static str, f64, &'static str, RangeInclusive<f64>);

/// Whether the figures of a robot are in the ranges of the physics.
fn check_figures(sources: &mut Sources<'_>, robot: &StageRobot) {
    let velocity = &robot.velocity;
    let mut figures: Vec<Figure> = vec![
        ("velocity_bounds", "drives at", fastest(velocity.x), " m/s", 0.001..=5.0),
        ("velocity_bounds", "turns at", fastest(velocity.turn).to_degrees(), " °/s", 0.1..=3600.0),
        ("odom_error", "errs along by", robot.odometry.distance_gain, "", -0.5..=0.5),
        ("odom_error", "errs in turns by", robot.odometry.turn_gain, "", -0.5..=0.5),
        ("size", "has a radius of", robot.radius_m(), " m", 0.02..=10.0),
    ];
    figures.extend(robot.mass_kg.map(|mass_kg| ("mass", "weighs", mass_kg, " kg", 0.001..=1e5)));
    if let Some(bounds) = &robot.acceleration {
        let turn_degps2 = fastest(bounds.turn).to_degrees();
        figures.push(("acceleration_bounds", "gains", fastest(bounds.x), " m/s²", 0.001..=100.0));
        figures.push(("acceleration_bounds", "gains", turn_degps2, " °/s²", 0.1..=100_000.0));
    }
    match robot.drive {
        Drive::Differential => {}
        Drive::Omni => {
            figures.push(("velocity_bounds", "drives sideways at", fastest(velocity.y), " m/s", 0.001..=5.0));
            let gain = robot.acceleration.map(|bounds| fastest(bounds.y));
            let figure = |gain| ("acceleration_bounds", "gains sideways", gain, " m/s²", 0.001..=100.0);
            figures.extend(gain.map(figure));
        }
        Drive::Car { wheelbase_m } => {
            figures.push(("wheelbase", "has a wheelbase of", wheelbase_m, " m", 0.01..=10.0));
        }
    }
    for (key, what, value, unit, range) in figures {
        // As it will be written.
        let value = short(value);
        if !range.contains(&value) {
            let help = format!("it must be {} to {}{unit}; see `{key}`", range.start(), range.end());
            sources.error(robot.key(key), format!("`{}` {what} {value}{unit}", robot.name), help);
        }
    }
}

fn warn_of_drive(sources: &mut Sources<'_>, robot: &StageRobot) {
    let name = &robot.name;
    let is_lopsided = |[least, most]: [f64; 2]| -least != most;
    let (velocity, is_omni) = (&robot.velocity, robot.drive == Drive::Omni);
    if is_lopsided(velocity.x) || is_lopsided(velocity.turn) || is_omni && is_lopsided(velocity.y) {
        let what = format!("`{name}` may drive or turn faster one way than the other");
        sources.warning(robot.key("velocity_bounds"), what, "here the larger bound holds both ways");
    }
    if let Drive::Car { .. } = robot.drive {
        let what = format!("Stage does not bound how far the wheels of `{name}` turn");
        let help = format!("here they turn by up to {STEER_DEG}°, and the car obeys commands");
        sources.warning(robot.at, what, help);
    }
}

/// Whether the figures of the sensors of a robot are in the ranges of the physics.
fn check_sensors(sources: &mut Sources<'_>, robot: &StageRobot) {
    let (radius_m, name) = (robot.radius_m(), &robot.name);
    for (kind, sensor) in robot.sensors() {
        let off_m = sensor.mount.translation.vector.norm() - radius_m;
        if off_m > MAX_OUT_M {
            let what = format!("a {kind} of `{name}` is mounted {off_m:.3} m off its robot");
            let help = format!(
                "here it is moved back, straight towards the point that the robot turns about, to {MAX_OUT_M} m from \
                 the circle about the body: it measures from there"
            );
            sources.warning(robot.at, what, help);
        }
        let is_range_valid = (0.01..=1000.0).contains(&sensor.range_m[1]);
        if !is_range_valid || sensor.fov_rad < MIN_FOV_RAD || sensor.noise_std_m > 1.0 {
            let help = "it sees over 1° or more, up to 0.01 to 1000 m, with a noise of at most 1 m";
            sources.error(sensor.at, format!("a {kind} of `{name}` is out of range"), help);
        }
    }
    for (kind, count) in [("lasers", robot.lasers.len()), ("sonars", robot.sonars.len())] {
        if count > MAX_SENSORS {
            let help = format!("{MAX_SENSORS} are the most");
            sources.error(robot.at, format!("`{name}` has {count} {kind}"), help);
        }
    }
    if robot.lasers.is_empty() {
        let help =
            "every robot has one here: it is given a laser of 180 beams over 180°, up to 8 m, at 10 Hz";
        sources.warning(robot.at, format!("`{name}` has no laser"), help);
    }
}

/// The walls and the robots of a world, in trees: not every pair is compared.
struct Room<'a> {
    /// The pieces of all walls, each with its wall.
    pieces: Vec<(&'a StageWall, &'a Rectangle)>,
    tree_of_pieces: BoxTree,
    robots: &'a [StageRobot],
    /// The area that each robot covers at its start.
    forms: Vec<Form>,
    tree_of_forms: BoxTree,
}

impl<'a> Room<'a> {
    fn new(world: &'a StageWorld) -> Self {
        let pieces =
            world.walls.iter().flat_map(|wall| wall.rectangles.iter().map(move |piece| (wall, piece)));
        let pieces: Vec<_> = pieces.collect();
        let forms: Vec<Form> = world.robots.iter().map(StageRobot::form).collect();
        Self {
            tree_of_pieces: BoxTree::new(pieces.iter().map(|(_, piece)| piece.bounds())),
            pieces,
            robots: &world.robots,
            tree_of_forms: BoxTree::new(forms.iter().map(Form::bounds)),
            forms,
        }
    }

    /// Adds an error if a robot stands in a wall or in an earlier robot.
    fn check(&self, sources: &mut Sources<'_>, index: usize) {
        let (robot, form) = (&self.robots[index], &self.forms[index]);
        let holds = |piece: &Rectangle| form.gap_m(&piece.corners()) < -TOUCH_M;
        let wall = self.tree_of_pieces.first_below(usize::MAX, holds, |i| holds(self.pieces[i].1));
        if let Some((wall, _)) = wall.map(|i| self.pieces[i]) {
            let what = format!("the robot `{}` stands in `{}`", robot.name, wall.name);
            sources.error(robot.at, what, format!("it may touch, but not overlap, {}", wall.place));
        }
        let overlaps = |i: usize| form.apart_m(&self.forms[i]) < -TOUCH_M;
        if let Some(other) = self.tree_of_forms.first_below(index, holds, overlaps).map(|i| &self.robots[i]) {
            let what = format!("the robots `{}` and `{}` overlap", other.name, robot.name);
            let help = format!("they may touch, but not overlap; the other one is at {}", other.place);
            sources.error(robot.at, what, help);
        }
    }
}
