//! A Stage world written as a world file of this project.

use super::lexer::Span;
use super::polygon::bounds;
use super::{Bounds, Drive, StageRobot, StageSensor, StageWorld, fastest};
use nalgebra::{Point2, Vector2};
use sim::physics::{OdometryError, Rectangle};
use toml::Value;
use worldfile::physics::MAX_OUT_M;
use worldfile::toml_value::{degrees, heading, lines, number, point};

/// The side of a cell of the truth grid, m, where the map is not too large for it.
const CELL_M: f64 = 0.05;
/// The target number of cells of a large map; 4 million are the most.
const TARGET_CELLS: f64 = 3.5e6;
/// The greatest acceleration that a world file can name: all at once, as in Stage.
const AT_ONCE: Bounds = Bounds {
    x: [-100.0, 100.0],
    y: [-100.0, 100.0],
    turn: [-100_000.0_f64.to_radians(), 100_000.0_f64.to_radians()],
};
/// How far the front wheels of a car turn, °: Stage does not bound it.
pub(super) const STEER_DEG: f64 = 45.0;
/// The speed of Stage's own wandering robots, m/s.
const WANDER_MPS: f64 = 0.4;

/// The keys of a table with their values.
type Keys = Vec<(&'static str, Value)>;

/// A world file made of a Stage world.
pub(super) struct Made<'a> {
    pub(super) text: String,
    tables: Vec<Origin<'a>>,
}

/// Where the table that begins at a byte of the text comes from.
struct Origin<'a> {
    start: usize,
    at: Span,
    robot: Option<&'a StageRobot>,
}

impl<'a> Made<'a> {
    fn table(&mut self, header: &str, keys: Keys) {
        self.text += &format!("\n{header}\n{}", lines(keys));
    }

    /// A table that comes from a thing or a robot at a place.
    fn table_of(&mut self, head: &str, (at, place): (Span, &str), robot: Option<&'a StageRobot>, keys: Keys) {
        self.tables.push(Origin { start: self.text.len(), at, robot });
        self.table(&format!("{head}  # {place}"), keys);
    }

    /// What a line comes from; `None` for what holds for the whole world.
    pub(super) fn origin(&self, line: usize) -> Option<Span> {
        let mut lines = self.text.split_inclusive('\n');
        let start: usize = lines.by_ref().take(line - 1).map(str::len).sum();
        let after = self.tables.partition_point(|table| table.start < start);
        let Origin { at, robot, .. } = self.tables[..after].last()?;
        let key = lines.next()?.split(" = ").next()?;
        Some(robot.map_or(*at, |robot| robot.key(stage_key(key))))
    }
}

/// The key of a Stage robot from which a key of a world file is made.
fn stage_key(key: &str) -> &str {
    match key {
        "max_linear_mps" | "max_left_mps" | "max_angular_degps" => "velocity_bounds",
        "wheelbase_m" => "wheelbase",
        "mass_kg" => "mass",
        "distance_gain" | "turn_gain" => "odom_error",
        _ if key.ends_with("ps2") => "acceleration_bounds",
        _ => key,
    }
}

/// The map in Stage's coordinates.
pub(super) struct Map {
    low: Point2<f64>,
    size_m: Vector2<f64>,
    cell_m: f64,
}

impl StageWorld {
    /// This world in a world file. Coordinates are moved, not turned, so that the lower left corner of
    /// the map is [0, 0]: what is at p in the Stage file is at p − [`StageWorld::map_origin`] there.
    /// Every table names the line of the Stage file that it comes from.
    pub fn to_toml(&self) -> String {
        self.made().text
    }

    pub(super) fn made(&self) -> Made<'_> {
        let map = self.map();
        let (name, low) = (Value::from(self.name.as_str()), point(&map.low));
        let files = self.files.join(", ");
        let text = format!(
            "# Made from {files}. Lengths in meters, angles in degrees.\n# [0, 0] here is {low} there.\nname = {name}\n"
        );
        let mut made = Made { text, tables: Vec::new() };
        let size_m = map.size_m.into();
        made.table("[map]", vec![("size_m", point(&size_m)), ("cell_m", number(map.cell_m))]);
        made.table("[physics]", vec![("step_s", number(self.step_s))]);
        for (wall, rectangle) in
            self.walls.iter().flat_map(|wall| wall.rectangles.iter().map(move |r| (wall, r)))
        {
            made.table_of("[[wall]]", (wall.at, &wall.place), None, map.wall(rectangle));
        }
        for robot in &self.robots {
            let mut table = |header: &str, keys| {
                made.table_of(header, (robot.at, &robot.place), Some(robot), keys);
            };
            table("[[robot]]", map.robot(robot));
            table("[robot.drive]", drive(robot));
            let OdometryError { distance_gain, turn_gain, .. } = robot.odometry;
            if robot.odometry != OdometryError::default() {
                let keys = vec![("distance_gain", number(distance_gain)), ("turn_gain", number(turn_gain))];
                table("[robot.odometry]", keys);
            }
            if robot.lasers.is_empty() {
                let mut keys = vec![("beams", Value::from(180)), ("fov_deg", number(180.0))];
                keys.extend([("range_max_m", number(8.0)), ("rate_hz", number(10.0))]);
                let place = format!("{}: none there", robot.place);
                made.table_of("[robot.laser]", (robot.at, &place), None, keys);
            }
            for (kind, sensor) in robot.sensors() {
                let header = match kind {
                    "laser" if robot.lasers.len() == 1 => "[robot.laser]",
                    "laser" => "[[robot.laser]]",
                    _ => "[[robot.sonar]]",
                };
                let keys = self::sensor(kind, sensor, robot.radius_m());
                made.table_of(header, (sensor.at, &sensor.place), None, keys);
            }
            made.table_of("[robot.behavior]", (robot.at, &robot.place), None, behavior(robot));
        }
        made
    }

    /// The lower left corner of the map in Stage's coordinates, m: on a whole number of cells.
    pub fn map_origin(&self) -> Point2<f64> {
        self.map().low
    }

    fn map(&self) -> Map {
        let rectangles = self.walls.iter().flat_map(|wall| &wall.rectangles);
        let robots = self.robots.iter().flat_map(|robot| <[Point2<f64>; 2]>::from(robot.form().bounds()));
        let (mut low, mut high) = bounds(rectangles.flat_map(Rectangle::corners).chain(robots));
        if low.x > high.x {
            (low, high) = (Point2::origin(), Point2::new(1.0, 1.0));
        }
        let extent = high - low;
        let coarse_m = (extent.x * extent.y / TARGET_CELLS).sqrt();
        let cell_m = CELL_M.max((coarse_m * 100.0).ceil() / 100.0);
        // What is only by rounding beyond a border of cells shall not cost another cell.
        let cells =
            |value_m: f64, round: fn(f64) -> f64, margin: f64| round(value_m / cell_m + margin) * cell_m;
        let low = low.map(|value_m| cells(value_m, f64::floor, 1e-6));
        let high = high.map(|value_m| cells(value_m, f64::ceil, -1e-6));
        let size_m = (high - low).map(|side_m| cells(side_m, f64::round, 0.0).max(2.0 * cell_m));
        Map { low, size_m, cell_m }
    }
}

impl Map {
    /// A point on this map; one that is only by rounding outside is moved to the border.
    fn point(&self, point: Point2<f64>) -> Value {
        let inside = |value_m: f64, size_m: f64| {
            let kept_m = value_m.clamp(0.0, size_m);
            if (value_m - kept_m).abs() < 1e-9 { kept_m } else { value_m }
        };
        let point = point - self.low.coords;
        self::point(&Point2::new(inside(point.x, self.size_m.x), inside(point.y, self.size_m.y)))
    }

    fn wall(&self, rectangle: &Rectangle) -> Keys {
        if is_upright(rectangle) {
            let (low, high) = rectangle.bounds();
            return vec![("min_m", self.point(low)), ("max_m", self.point(high))];
        }
        // Along its longer side: the thickness of a wall has bounds, its length has none.
        let (x, y) = (rectangle.half_m.x, rectangle.half_m.y);
        let along = if x >= y { Point2::new(x, 0.0) } else { Point2::new(0.0, y) };
        let end = |along: Point2<f64>| self.point(rectangle.pose * along);
        vec![("from_m", end(-along)), ("to_m", end(along)), ("thickness_m", number(2.0 * x.min(y)))]
    }

    fn robot(&self, robot: &StageRobot) -> Keys {
        let outline: Vec<Value> = robot.outline.iter().map(point).collect();
        let mut keys = vec![("name", Value::from(robot.name.as_str()))];
        keys.push(match outline.is_empty() {
            true => ("radius_m", number(robot.radius_m())),
            false => ("footprint_m", Value::from(outline)),
        });
        keys.extend(robot.mass_kg.map(|mass_kg| ("mass_kg", number(mass_kg))));
        keys.push(("pose_m", self.point(robot.pose.translation.vector.into())));
        keys.push(("heading_deg", heading(&robot.pose)));
        keys
    }
}

fn drive(robot: &StageRobot) -> Keys {
    let (velocity, gain) = (&robot.velocity, robot.acceleration.unwrap_or(AT_ONCE));
    let mut keys = vec![
        ("max_linear_mps", number(fastest(velocity.x))),
        ("max_angular_degps", degrees(fastest(velocity.turn))),
        ("max_linear_acceleration_mps2", number(fastest(gain.x))),
        ("max_angular_acceleration_degps2", degrees(fastest(gain.turn))),
    ];
    match robot.drive {
        Drive::Differential => {}
        Drive::Omni => keys.extend([
            ("kind", Value::from("omni")),
            ("max_left_mps", number(fastest(velocity.y))),
            ("max_left_acceleration_mps2", number(fastest(gain.y))),
        ]),
        Drive::Car { wheelbase_m } => keys.extend([
            ("kind", Value::from("car")),
            ("wheelbase_m", number(wheelbase_m)),
            ("max_steer_deg", number(STEER_DEG)),
        ]),
    }
    keys
}

fn sensor(kind: &str, sensor: &StageSensor, radius_m: f64) -> Keys {
    // Not farther out than it may be, by more than rounding.
    let mount_m = sensor.mount.translation.vector.cap_magnitude(radius_m + MAX_OUT_M - 1e-7);
    let mut keys = match kind {
        "laser" => vec![("beams", Value::from(sensor.beams as i64)), ("fov_deg", degrees(sensor.fov_rad))],
        _ => vec![("cone_deg", degrees(sensor.fov_rad))],
    };
    keys.extend([
        ("range_min_m", number(sensor.range_m[0])),
        ("range_max_m", number(sensor.range_m[1])),
        ("rate_hz", number(1000.0 / f64::from(sensor.interval_ms))),
        ("mount_m", point(&mount_m.into())),
        ("mount_deg", heading(&sensor.mount)),
        ("noise_std_m", number(sensor.noise_std_m)),
    ]);
    keys
}

fn behavior(robot: &StageRobot) -> Keys {
    // A car cannot turn in place, as our wandering robots do.
    if robot.wanders && !matches!(robot.drive, Drive::Car { .. }) {
        let speed_mps = WANDER_MPS.min(fastest(robot.velocity.x));
        return vec![("kind", Value::from("wander")), ("speed_mps", number(speed_mps))];
    }
    vec![("kind", Value::from("driven"))]
}

/// Whether its sides are along the axes.
fn is_upright(rectangle: &Rectangle) -> bool {
    let turn = rectangle.pose.rotation;
    turn.re.abs() < 1e-12 || turn.im.abs() < 1e-12
}
