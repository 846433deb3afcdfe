//! A Stage world written as a world file of ours.

use super::{Drive, StageRobot, StageWall, StageWorld};
use interfaces::heading_rad;
use nalgebra::{Isometry2, Point2, Vector2};
use sim::physics::{OdometryError, Rectangle};
use std::fmt::{Result, Write};
use worldfile::physics::MOST_OUT_M;

/// The side of a cell of the truth grid, m, where the map is not too large for it.
const CELL_M: f64 = 0.05;
/// The target number of cells of a large map; 4 million are the most.
const MOST_CELLS: f64 = 3.5e6;
/// The greatest acceleration that a world file can name: all at once, as in Stage.
const AT_ONCE_MPS2: f64 = 100.0;
const AT_ONCE_DEGPS2: f64 = 100_000.0;

/// How far the front wheels of a car turn, °: Stage does not bound it.
pub(super) const STEER_DEG: f64 = 45.0;

/// The speed of Stage's own wandering robots, m/s.
const WANDER_MPS: f64 = 0.4;

/// Where the map lies in Stage's coordinates.
struct Map {
    low: Point2<f64>,
    size_m: Vector2<f64>,
    cell_m: f64,
}

impl StageWorld {
    /// This world in a world file. Coordinates are moved, not turned, so that the lower left corner of
    /// the map is [0, 0]: what is at p in the Stage file is at p − [`StageWorld::map_origin`] there.
    /// Every table names the line of the Stage file that it comes from.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        // Writing to a text cannot fail.
        let _ = self.write(&mut text);
        text
    }

    /// The lower left corner of the map in Stage's coordinates, m: on a whole number of cells.
    pub fn map_origin(&self) -> Point2<f64> {
        self.map().low
    }

    /// The width and height of the map, m.
    pub(super) fn size_m(&self) -> Vector2<f64> {
        self.map().size_m
    }

    fn map(&self) -> Map {
        let (mut low, mut high) = (Point2::new(f64::MAX, f64::MAX), Point2::new(f64::MIN, f64::MIN));
        let mut reach = |point: Point2<f64>| {
            low = low.inf(&point);
            high = high.sup(&point);
        };
        for rectangle in self.walls.iter().flat_map(|wall| &wall.rectangles) {
            rectangle.corners().into_iter().for_each(&mut reach);
        }
        for robot in &self.robots {
            let (low, high) = robot.form().bounds();
            reach(low);
            reach(high);
        }
        if low.x > high.x {
            (low, high) = (Point2::origin(), Point2::new(1.0, 1.0));
        }
        let extent = high - low;
        let coarse_m = (extent.x * extent.y / MOST_CELLS).sqrt();
        let cell_m = CELL_M.max((coarse_m * 100.0).ceil() / 100.0);
        // What is a hair beyond a border of cells shall not cost another cell.
        let cells = |value_m: f64, round: fn(f64) -> f64, hair: f64| round(value_m / cell_m + hair) * cell_m;
        let low = low.map(|value_m| cells(value_m, f64::floor, 1e-6));
        let high = high.map(|value_m| cells(value_m, f64::ceil, -1e-6));
        Map {
            low,
            size_m: (high - low).map(|side_m| cells(side_m, f64::round, 0.0).max(2.0 * cell_m)),
            cell_m,
        }
    }

    fn write(&self, to: &mut String) -> Result {
        let map = self.map();
        writeln!(to, "# Made from {}. Lengths in metres, angles in degrees.", self.files.join(", "))?;
        writeln!(to, "# [0, 0] here is [{:?}, {:?}] there.", short(map.low.x), short(map.low.y))?;
        writeln!(to, "name = {}\n\n[map]", quoted(&self.name))?;
        pair(to, "size_m", &map.size_m.into())?;
        number(to, "cell_m", map.cell_m)?;
        writeln!(to, "\n[physics]")?;
        number(to, "step_s", self.step_s)?;
        for wall in &self.walls {
            for rectangle in &wall.rectangles {
                match wall.tag {
                    Some(tag) => map.write_tagged(to, wall, rectangle, tag)?,
                    None => map.write_wall(to, rectangle, &wall.place)?,
                }
            }
        }
        for robot in &self.robots {
            map.write_robot(to, robot)?;
        }
        Ok(())
    }
}

impl Map {
    /// A point on this map, of which rounding keeps none a hair outside.
    fn point(&self, point: &Point2<f64>) -> Point2<f64> {
        let inside = |value: f64, size: f64| {
            if (-1e-9..0.0).contains(&value) {
                0.0
            } else if value > size && value < size + 1e-9 {
                size
            } else {
                value
            }
        };
        let point = point - self.low.coords;
        Point2::new(inside(point.x, self.size_m.x), inside(point.y, self.size_m.y))
    }

    fn write_wall(&self, to: &mut String, rectangle: &Rectangle, place: &str) -> Result {
        writeln!(to, "\n[[wall]]  # {place}")?;
        if is_upright(rectangle) {
            let (low, high) = rectangle.bounds();
            pair(to, "min_m", &self.point(&low))?;
            return pair(to, "max_m", &self.point(&high));
        }
        // Along its longer side: how long a wall is has no bounds, how thick it is has.
        let (x, y) = (rectangle.half_m.x, rectangle.half_m.y);
        let along = if x >= y { Vector2::new(x, 0.0) } else { Vector2::new(0.0, y) };
        let end = |along: Vector2<f64>| self.point(&(rectangle.pose * Point2::from(along)));
        pair(to, "from_m", &end(-along))?;
        pair(to, "to_m", &end(along))?;
        number(to, "thickness_m", 2.0 * x.min(y))
    }

    fn write_tagged(&self, to: &mut String, wall: &StageWall, shape: &Rectangle, tag: u32) -> Result {
        writeln!(to, "\n[[obstacle]]  # {}\nname = {}\ntag = {tag}", wall.place, quoted(&wall.name))?;
        pair(to, "center_m", &self.point(&shape.pose.translation.vector.into()))?;
        pair(to, "size_m", &(2.0 * shape.half_m).into())?;
        number(to, "heading_deg", heading_rad(&shape.pose).to_degrees())
    }

    fn write_robot(&self, to: &mut String, robot: &StageRobot) -> Result {
        let StageRobot { name, place, velocity, odometry, .. } = robot;
        let most = |[least, most]: [f64; 2]| most.max(-least);
        writeln!(to, "\n[[robot]]  # {place}\nname = {}", quoted(name))?;
        if robot.outline.is_empty() {
            number(to, "radius_m", robot.radius_m())?;
        } else {
            let corner = |corner: &Point2<f64>| format!("[{:?}, {:?}]", short(corner.x), short(corner.y));
            let corners: Vec<String> = robot.outline.iter().map(corner).collect();
            writeln!(to, "footprint_m = [{}]", corners.join(", "))?;
        }
        robot.mass_kg.map_or(Ok(()), |mass_kg| number(to, "mass_kg", mass_kg))?;
        robot.tag.map_or(Ok(()), |tag| writeln!(to, "tag = {tag}"))?;
        pair(to, "pose_m", &self.point(&robot.pose.translation.vector.into()))?;
        number(to, "heading_deg", heading_rad(&robot.pose).to_degrees())?;
        writeln!(to, "\n[robot.drive]  # {place}")?;
        number(to, "max_linear_mps", most(velocity.x))?;
        number(to, "max_angular_degps", most(velocity.turn).to_degrees())?;
        let gain = robot.acceleration.map(|bounds| (most(bounds.x), most(bounds.turn).to_degrees()));
        let (along, about) = gain.unwrap_or((AT_ONCE_MPS2, AT_ONCE_DEGPS2));
        number(to, "max_linear_acceleration_mps2", along)?;
        number(to, "max_angular_acceleration_degps2", about)?;
        match robot.drive {
            Drive::Differential => {}
            Drive::Omni => {
                writeln!(to, "kind = \"omni\"")?;
                number(to, "max_left_mps", most(velocity.y))?;
                let gain = robot.acceleration.map_or(AT_ONCE_MPS2, |bounds| most(bounds.y));
                number(to, "max_left_acceleration_mps2", gain)?;
            }
            Drive::Car { wheelbase_m } => {
                writeln!(to, "kind = \"car\"")?;
                number(to, "wheelbase_m", wheelbase_m)?;
                number(to, "max_steer_deg", STEER_DEG)?;
            }
        }
        if *odometry != OdometryError::default() {
            writeln!(to, "\n[robot.odometry]  # {place}")?;
            number(to, "distance_gain", odometry.distance_gain)?;
            number(to, "turn_gain", odometry.turn_gain)?;
        }
        write_senses(to, robot)?;
        writeln!(to, "\n[robot.behaviour]  # {place}")?;
        let wanders = |name: &String| name.split_whitespace().next() == Some("wander");
        // A car cannot turn in place, as ours do.
        if robot.controllers.iter().any(wanders) && !matches!(robot.drive, Drive::Car { .. }) {
            writeln!(to, "kind = \"wander\"")?;
            return number(to, "speed_mps", WANDER_MPS.min(most(velocity.x)));
        }
        writeln!(to, "kind = \"driven\"")
    }
}

fn write_senses(to: &mut String, robot: &StageRobot) -> Result {
    let radius_m = robot.radius_m();
    let table = if robot.lasers.len() == 1 { "[robot.laser]" } else { "[[robot.laser]]" };
    for laser in &robot.lasers {
        writeln!(to, "\n{table}  # {}\nbeams = {}", laser.place, laser.beams)?;
        number(to, "fov_deg", laser.fov_rad.to_degrees())?;
        number(to, "range_min_m", laser.range_min_m)?;
        number(to, "range_max_m", laser.range_max_m)?;
        write_place(to, laser.interval_ms, &laser.mount, radius_m)?;
        number(to, "noise_std_m", laser.noise_std_m)?;
    }
    if robot.lasers.is_empty() {
        writeln!(to, "\n[robot.laser]  # {}: none there", robot.place)?;
        writeln!(to, "beams = 180\nfov_deg = 180.0\nrange_max_m = 8.0\nrate_hz = 10.0")?;
    }
    for sonar in &robot.sonars {
        writeln!(to, "\n[[robot.sonar]]  # {}", sonar.place)?;
        number(to, "cone_deg", sonar.cone_rad.to_degrees())?;
        number(to, "range_min_m", sonar.range_min_m)?;
        number(to, "range_max_m", sonar.range_max_m)?;
        write_place(to, sonar.interval_ms, &sonar.mount, radius_m)?;
        number(to, "noise_std_m", sonar.noise_std_m)?;
    }
    if let Some(finder) = &robot.fiducial {
        writeln!(to, "\n[robot.fiducial]  # {}", finder.place)?;
        number(to, "fov_deg", finder.fov_rad.to_degrees())?;
        number(to, "range_max_m", finder.range_max_m)?;
        write_place(to, finder.interval_ms, &finder.mount, radius_m)?;
    }
    Ok(())
}

/// How often a sensor senses, and where it sits: not farther out than it may be, by more than rounding.
fn write_place(to: &mut String, interval_ms: u32, mount: &Isometry2<f64>, radius_m: f64) -> Result {
    let within_m = mount.translation.vector.cap_magnitude(radius_m + MOST_OUT_M - 1e-7);
    number(to, "rate_hz", 1000.0 / f64::from(interval_ms))?;
    pair(to, "mount_m", &within_m.into())?;
    number(to, "mount_deg", heading_rad(mount).to_degrees())
}

/// Whether its sides are along the axes.
pub(super) fn is_upright(rectangle: &Rectangle) -> bool {
    let turn = rectangle.pose.rotation;
    turn.re.abs() < 1e-12 || turn.im.abs() < 1e-12
}

fn number(to: &mut String, key: &str, value: f64) -> Result {
    writeln!(to, "{key} = {:?}", short(value))
}

fn pair(to: &mut String, key: &str, point: &Point2<f64>) -> Result {
    writeln!(to, "{key} = [{:?}, {:?}]", short(point.x), short(point.y))
}

/// To a billionth: without what sums and units leave behind.
pub(super) fn short(value: f64) -> f64 {
    let rounded = (value * 1e9).round() / 1e9;
    // No −0.0.
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// A text in quotes as TOML has it.
fn quoted(text: &str) -> String {
    let escaped = text.chars().flat_map(|c| match c {
        '"' | '\\' => vec!['\\', c],
        c if c.is_control() => vec![' '],
        c => vec![c],
    });
    format!("\"{}\"", escaped.collect::<String>())
}
