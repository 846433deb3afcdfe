//! The description of physics worlds and floor plans.

use super::Content;
use calendar::moment;
use draw::scene::Scene;
use evaluation::scenes::Displayed;
use interfaces::{GridFrame, printable};
use nalgebra::Point2;
use sim::physics::{
    BehaviorSpec, DriveKind, FleetSpec, Leaf, Motion, ObstacleSpec, Opening, Rectangle, RobotSpec,
};
use std::path::Path;
use worldfile::floor_plan::FloorPlan;

/// The minimum side of the cells of a floor plan's frame, m.
const PLAN_CELL_M: f64 = 0.05;

pub(super) fn content(kind: &'static str, world: &FleetSpec) -> Content {
    let frame = world.frame;
    let cell_m = frame.resolution_m();
    let [width_m, height_m] = [frame.width(), frame.height()].map(|cells| cells as f64 * cell_m);
    let mut lines = vec![
        (
            "size",
            format!(
                "{} × {} m, {} × {} cells of {cell_m} m",
                short(width_m),
                short(height_m),
                frame.width(),
                frame.height()
            ),
        ),
        ("time", format!("physics steps of {} s", world.step_s)),
        ("walls", format!("{}", world.walls.len())),
    ];
    lines.extend(
        world.starts_s.map(|starts_s| ("calendar", format!("the world starts on {}", moment(starts_s)))),
    );
    for (index, obstacle) in world.obstacles.iter().enumerate() {
        let parts = world.obstacles.iter().enumerate().filter(|(part, other)| other.thing(*part) == index);
        match parts.filter(|(_, part)| part.place() == 0).count() {
            0 => {}
            parts => lines.push(("thing", thing_line(obstacle, parts))),
        }
    }
    lines.extend(robot_lines(&world.robots));
    Content { kind, description: world.description.to_owned(), lines, scene: world.scene() }
}

/// A floor plan alone; none if it has no area.
pub(super) fn floor_plan(path: &Path, plan: &FloorPlan) -> Option<Content> {
    let size = plan.size_m();
    let corners = [(0.0, 0.0), (size.x, 0.0), (size.x, size.y), (0.0, size.y)];
    let corners = corners.map(|(x, y)| plan.origin * Point2::new(x, y));
    let low = corners.iter().fold(corners[0], |low, corner| low.inf(corner));
    let high = corners.iter().fold(corners[0], |high, corner| high.sup(corner));
    let rectangles: Vec<Rectangle> = plan.rectangles().collect();
    let bitmap = &plan.bitmap;
    let name = printable(&path.file_stem().unwrap_or_default().to_string_lossy()).into_owned();
    Some(Content {
        kind: "floor plan",
        description: String::new(),
        lines: vec![
            ("size", format!("{} × {} m", short(size.x), short(size.y))),
            (
                "picture",
                format!("{} × {} pixels of {} m", bitmap.width(), bitmap.height(), short(plan.pixel_m.x)),
            ),
            ("walls", format!("{} rectangles", rectangles.len())),
        ],
        scene: Scene {
            title: name,
            is_grid: false,
            frame: GridFrame::covering(low, high.x - low.x, high.y - low.y, PLAN_CELL_M.max(plan.pixel_m.x))?,
            walls: rectangles.iter().map(|wall| wall.corners().to_vec()).collect(),
            obstacles: Vec::new(),
            robots: Vec::new(),
        },
    })
}

/// A line about an obstacle, and the other parts of its thing if there is more than one.
fn thing_line(obstacle: &ObstacleSpec, parts: usize) -> String {
    let size = obstacle.shape.half_m * 2.0;
    let what = match &obstacle.motion {
        Motion::Fixed => "a fixed box".to_owned(),
        Motion::Scheduled(_) => {
            let boxes = if parts == 1 { "a box".to_owned() } else { format!("a thing of {parts} boxes") };
            let places = obstacle.part.map_or(1, |part| part.places);
            let places = if places == 1 { String::new() } else { format!(" at one of {places} places") };
            format!("{boxes} that comes and goes{places} by a schedule")
        }
        Motion::Pushed(pushed) => format!("a box of {} kg that can be pushed", short(pushed.mass_kg)),
        Motion::Path(path) => {
            let (last_s, _) = path.keys.last().copied().unwrap_or_default();
            let again = if path.is_loop { "repeated" } else { "once" };
            format!("a block on a path of {} points, {} s long, {again}", path.keys.len(), short(last_s))
        }
        Motion::Door(door) => {
            let leaf = if matches!(door.leaf, Leaf::Hinged { .. }) { "hinged" } else { "sliding" };
            let opening = match &door.opening {
                Opening::Periodic { closed_s, open_s } => {
                    format!("closed {} s, open {} s", short(*closed_s), short(*open_s))
                }
                Opening::Random { closed_s, open_s } => {
                    format!("at random closed {} s, open {} s in the mean", short(*closed_s), short(*open_s))
                }
                Opening::Scheduled { waits_for_robots, .. } => {
                    let waits = if *waits_for_robots {
                        "; open while a robot needs it to get to its dock"
                    } else {
                        ""
                    };
                    format!("by a schedule{waits}")
                }
                Opening::Scripted { switches_s } => format!("moved {} times, as written", switches_s.len()),
            };
            format!("a {leaf} door, {opening}")
        }
    };
    let when = [("from", obstacle.appears_s), ("until", obstacle.disappears_s)];
    let when = when.into_iter().filter_map(|(word, at_s)| Some(format!(", {word} {} s", short(at_s?))));
    format!(
        "`{}`: {what}, {}{} × {} m{}",
        obstacle.name,
        if parts > 1 { "one of them " } else { "" },
        short(size.x),
        short(size.y),
        when.collect::<String>()
    )
}

/// A line for each robot; consecutive robots that differ only in name and pose share a line.
fn robot_lines(robots: &[RobotSpec]) -> impl Iterator<Item = (&'static str, String)> {
    robots.chunk_by(|one, next| robot_line(one) == robot_line(next)).map(|alike| {
        let (first, last, what) = (&alike[0], &alike[alike.len() - 1], robot_line(&alike[0]));
        match alike.len() {
            1 => ("robot", format!("`{}` {what}", first.name)),
            number => ("robots", format!("{number}, `{}` to `{}`, each {what}", first.name, last.name)),
        }
    })
}

fn robot_line(robot: &RobotSpec) -> String {
    let does = match &robot.behavior {
        BehaviorSpec::Driven => "is driven",
        BehaviorSpec::Standing => "stands",
        BehaviorSpec::Circle(_) => "drives a circle",
        BehaviorSpec::Wander(_) => "wanders",
        BehaviorSpec::Waypoints(_) => "drives from point to point",
        BehaviorSpec::WallPatrol(_) => "follows a wall back and forth",
    };
    let body = match robot.corners.len() {
        0 => format!("radius {} m", short(robot.radius_m)),
        corners => format!("{corners} corners, at most {} m away", short(robot.radius_m)),
    };
    let drive = match robot.drive.kind {
        DriveKind::Differential => "on two wheels",
        DriveKind::Omni { .. } => "in every direction",
        DriveKind::Car { .. } => "as a car",
    };
    let mut parts = vec![format!("{does}, {body}, {drive} up to {} m/s", short(robot.drive.max_linear_mps))];
    parts.extend(robot.lasers().map(|laser| {
        format!(
            "laser of {} beams over {}°, {} m, {} Hz, noise {} m",
            laser.beams,
            short(laser.fov_rad.to_degrees()),
            short(laser.range_max_m),
            short(laser.rate_hz),
            short(laser.noise_std_m),
        )
    }));
    let poses = if robot.odometry.is_exact() { "poses are exact" } else { "its odometry drifts" };
    parts.push(poses.to_owned());
    let others = [(robot.sonars.len(), "sonar"), (usize::from(robot.bumper.is_some()), "bumper")];
    parts.extend(
        others.into_iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{what} × {count}")),
    );
    parts.extend(robot.patrol.as_ref().map(|_| "on patrol by a schedule".to_owned()));
    parts.join("; ")
}

/// A number rounded to thousandths, without trailing zeros.
fn short(value: f64) -> String {
    format!("{}", (value * 1000.0).round() / 1000.0)
}
