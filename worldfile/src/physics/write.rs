//! A world as the text of its file.

use super::behavior::REPEATS;
use super::check::CONTACTS;
use crate::schedule::write_schedule;
use crate::toml_value::{degrees, heading, lines, number, point};
use nalgebra::{Isometry2, Point2};
use sim::physics::{
    BehaviorSpec, ContactModel, DoorSpec, DriveKind, DriveLimits, FleetSpec, LaserSpec, Leaf, Motion,
    ObstacleSpec, Opening, PatrolDaySpec, Rectangle, RobotSpec,
};
use toml::Value;

/// The keys of a table with their values.
type Keys = Vec<(&'static str, Value)>;

/// The text of a world file that describes `spec`: [`super::parse_fleet`] reads the same spec from it. `None` for a
/// world with parts that generated buildings do not have: this function writes upright walls, obstacles that stand still, or
/// come and go by a schedule, doors that open periodically or at random, and round robots with a differential drive and one laser, which are
/// driven, walk along waypoints or wander.
pub fn to_toml(spec: &FleetSpec) -> Option<String> {
    let (frame, mut text) = (&spec.frame, String::new());
    if !spec.glass.is_empty()
        || frame.center(interfaces::Cell::new(0, 0)).coords
            != nalgebra::Vector2::from([frame.resolution_m() / 2.0; 2])
    {
        return None; // a world that was turned
    }
    let mut table = |header: &str, keys: Keys| {
        text += header;
        text += &lines(keys);
    };
    let mut head =
        vec![("name", spec.name.as_str().into()), ("description", spec.description.as_str().into())];
    head.extend(spec.starts_s.map(|starts_s| ("starts", Value::from(calendar::moment(starts_s)))));
    table("", head);
    let size_m = [frame.width(), frame.height()].map(|cells| number(cells as f64 * frame.resolution_m()));
    table("\n[map]\n", vec![("size_m", size_m.to_vec().into()), ("cell_m", number(frame.resolution_m()))]);
    let mut physics = vec![("step_s", number(spec.step_s))];
    if spec.contacts != ContactModel::default() {
        let word = CONTACTS.iter().find(|(_, contacts)| *contacts == spec.contacts);
        physics.extend(word.map(|(word, _)| ("contacts", Value::from(*word))));
    }
    table("\n[physics]\n", physics);
    for wall in &spec.walls {
        table("\n[[wall]]\n", upright(wall)?);
    }
    for obstacle in &spec.obstacles {
        let thing = obstacle.part.map(|part| &spec.obstacles[part.thing]).filter(|thing| *thing != obstacle);
        table("\n[[obstacle]]\n", self::obstacle(obstacle, thing)?);
        if let Some(schedule) = obstacle.schedule().filter(|_| thing.is_none()) {
            table("\n[obstacle.schedule]\n", write_schedule(schedule));
        }
    }
    for robot in &spec.robots {
        table("\n[[robot]]\n", body(robot)?);
        table("\n[robot.drive]\n", drive(robot)?);
        table("\n[robot.laser]\n", laser(&robot.laser)?);
        table("\n[robot.behavior]\n", behavior(&robot.behavior)?);
        if let Some(day) = &robot.patrol {
            table("\n[robot.patrol]\n", patrol(day));
        }
    }
    Some(text)
}

/// An obstacle, which can be a part of a thing.
fn obstacle(obstacle: &ObstacleSpec, thing: Option<&ObstacleSpec>) -> Option<Keys> {
    let ObstacleSpec { name, shape, motion, appears_s: None, disappears_s: None, .. } = obstacle else {
        return None;
    };
    let mut keys: Keys = vec![("name", name.as_str().into())];
    keys.extend(match motion {
        Motion::Fixed | Motion::Scheduled(_) => upright(shape).unwrap_or_else(|| turned(shape)),
        Motion::Door(spec) => door(shape, spec)?,
        Motion::Pushed(_) | Motion::Path(_) => return None,
    });
    if let Some(thing) = thing {
        keys.push(("part_of", thing.name.as_str().into()));
        keys.push(("place", (obstacle.place() as i64 + 1).into()));
    }
    Some(keys)
}

fn upright(shape: &Rectangle) -> Option<Keys> {
    let (low, high) = shape.bounds();
    let keys = || vec![("min_m", point(&low)), ("max_m", point(&high))];
    (shape.pose.rotation.im == 0.0 && shape.pose.rotation.re > 0.0).then(keys)
}

fn turned(shape: &Rectangle) -> Keys {
    let size = shape.half_m * 2.0;
    vec![
        ("center_m", point(&shape.pose.translation.vector.into())),
        ("size_m", point(&size.into())),
        ("heading_deg", heading(&shape.pose)),
    ]
}

fn door(shape: &Rectangle, spec: &DoorSpec) -> Option<Keys> {
    let ends = [-shape.half_m.x, shape.half_m.x].map(|x| point(&(shape.pose * Point2::new(x, 0.0))));
    let [from, to] = ends;
    let kind = match spec.leaf {
        Leaf::Hinged { .. } => "hinged_door",
        Leaf::Sliding { .. } => "sliding_door",
    };
    let mut keys: Keys = vec![("kind", kind.into()), ("from_m", from), ("to_m", to)];
    keys.push(("thickness_m", number(2.0 * shape.half_m.y)));
    match spec.leaf {
        Leaf::Hinged { open_rad, .. } => keys.push(("open_deg", degrees(open_rad))),
        // By its length, as it is without the key.
        Leaf::Sliding { by_m } if (by_m.norm() - 2.0 * shape.half_m.x).abs() < 1e-9 => {}
        Leaf::Sliding { .. } => return None,
    }
    let times = |opening: &str, [closed_s, open_s]: [f64; 2]| {
        [("opening", opening.into()), ("closed_s", number(closed_s)), ("open_s", number(open_s))]
    };
    match spec.opening {
        Opening::Scheduled { waits_for_robots: true, .. } => keys.push(("waits_for_robots", true.into())),
        Opening::Scheduled { .. } => {}
        Opening::Periodic { closed_s, open_s } => keys.extend(times("periodic", [closed_s, open_s])),
        Opening::Random { closed_s, open_s } => keys.extend(times("random", [closed_s, open_s])),
        Opening::Scripted { .. } => return None,
    }
    keys.push(("move_s", number(spec.move_s)));
    if !matches!(spec.opening, Opening::Scheduled { .. }) {
        keys.push(("starts_open", spec.starts_open.into()));
    }
    Some(keys)
}

fn body(robot: &RobotSpec) -> Option<Keys> {
    let is_plain = robot.corners.is_empty()
        && robot.mass_kg.is_none()
        && robot.odometry.is_exact()
        && (robot.more_lasers.is_empty() && robot.sonars.is_empty())
        && robot.bumper.is_none();
    let keys = || {
        vec![
            ("name", robot.name.as_str().into()),
            ("radius_m", number(robot.radius_m)),
            ("pose_m", point(&robot.pose.translation.vector.into())),
            ("heading_deg", heading(&robot.pose)),
        ]
    };
    is_plain.then(keys)
}

fn patrol(day: &PatrolDaySpec) -> Keys {
    let mut keys = vec![("share", number(day.share)), ("battery_s", number(day.battery_s))];
    keys.extend(day.dock.map(|dock| ("dock_m", point(&dock))));
    let busy = day.busy.texts();
    if !busy.is_empty() {
        keys.push(("busy", busy.into()));
    }
    keys
}

fn drive(robot: &RobotSpec) -> Option<Keys> {
    let drive = &robot.drive;
    let keys = || {
        vec![
            ("max_linear_mps", number(drive.max_linear_mps)),
            ("max_angular_degps", degrees(drive.max_angular_radps)),
            ("max_linear_acceleration_mps2", number(drive.max_linear_acceleration_mps2)),
            ("max_angular_acceleration_degps2", degrees(drive.max_angular_acceleration_radps2)),
        ]
    };
    (drive.kind == DriveKind::Differential && drive.lateral_grip == DriveLimits::LATERAL_GRIP).then(keys)
}

fn laser(laser: &LaserSpec) -> Option<Keys> {
    let sweep = (laser.sweep_s > 0.0).then(|| ("sweep_s", number(laser.sweep_s)));
    let width = (laser.beam_width_rad > 0.0).then(|| ("beam_width_deg", degrees(laser.beam_width_rad)));
    let keys = || {
        let keys = vec![
            ("beams", Value::from(laser.beams as i64)),
            ("fov_deg", degrees(laser.fov_rad)),
            ("range_min_m", number(laser.range_min_m)),
            ("range_max_m", number(laser.range_max_m)),
            ("rate_hz", number(laser.rate_hz)),
            ("noise_std_m", number(laser.noise_std_m)),
            ("dropout", number(laser.dropout)),
        ];
        keys.into_iter().chain(sweep).chain(width).collect()
    };
    (laser.mount == Isometry2::identity()).then(keys)
}

fn behavior(behavior: &BehaviorSpec) -> Option<Keys> {
    let moving = |kind: &str, speed_mps, clearance_m| {
        vec![("kind", kind.into()), ("speed_mps", number(speed_mps)), ("clearance_m", number(clearance_m))]
    };
    Some(match behavior {
        BehaviorSpec::Driven => vec![("kind", "driven".into())],
        BehaviorSpec::Wander(wander) => moving("wander", wander.speed_mps, wander.clearance_m),
        BehaviorSpec::Waypoints(way) => {
            let mut keys = moving("waypoints", way.speed_mps, way.clearance_m);
            keys.push(("points_m", way.points.iter().map(point).collect::<Vec<Value>>().into()));
            let (name, _) = REPEATS.iter().find(|(_, repeat)| *repeat == way.repeat)?;
            keys.push(("repeat", (*name).into()));
            keys
        }
        BehaviorSpec::Standing | BehaviorSpec::Circle(_) | BehaviorSpec::WallPatrol(_) => return None,
    })
}
