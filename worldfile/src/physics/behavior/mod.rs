//! The behavior of a robot.

mod patrol;

use crate::physics::kind::{KindOf, kind_of};
use crate::physics::space::Space;
use crate::reader::Table;
use nalgebra::Point2;
use sim::physics::shape::TOUCH_M;
use sim::physics::{
    BehaviorSpec, CircleSpec, DriveKind, DriveLimits, Rectangle, Repeat, WanderSpec, WaypointsSpec,
};

/// The continuation after the last waypoint.
pub(super) const REPEATS: [(&str, Repeat); 3] =
    [("loop", Repeat::Loop), ("back_and_forth", Repeat::BackAndForth), ("once", Repeat::Once)];

const SIDES: [(&str, bool); 2] = [("left", true), ("right", false)];

pub(super) const KEYS: &str = "kind, from_m, to_m, speed_mps, wall_side, clearance_m, turn_radius_m, direction, \
                               points_m, repeat";

const KINDS: [KindOf; 6] = [
    ("driven", "", "obeys commands"),
    ("standing", "", "stands"),
    ("circle", "speed_mps, turn_radius_m, direction", "drives a circle"),
    ("wander", "speed_mps, clearance_m", "drives about"),
    ("waypoints", "points_m, speed_mps, repeat, clearance_m", "drives from point to point"),
    ("wall_patrol", "from_m, to_m, speed_mps, wall_side, clearance_m", "follows a wall"),
];

/// A robot that drives by itself, and what it could run into.
pub(super) struct Driver<'a> {
    pub(super) robot: &'a Table<'a>,
    pub(super) name: &'a str,
    /// The radius of the circle around the robot and its start, m. Paths are not checked if these are invalid.
    pub(super) start: Option<(f64, Point2<f64>)>,
    pub(super) drive: &'a DriveLimits,
    pub(super) space: &'a Space,
}

impl Driver<'_> {
    pub(super) fn behavior(&self, table: &Table<'_>) -> Option<BehaviorSpec> {
        table.needed("kind")?;
        let kind = kind_of(table, &KINDS, "a behavior")?;
        if let DriveKind::Car { .. } = self.drive.kind
            && !["driven", "standing", "circle"].contains(&kind)
        {
            let help = "it cannot turn in place: it is \"driven\" or \"standing\", or drives a \"circle\"";
            let what = format!("a car cannot be `{kind}`");
            return table.error(&what, (table.at("kind"), "not for a car"), &[], help);
        }
        let behavior = match kind {
            "driven" => BehaviorSpec::Driven,
            "standing" => BehaviorSpec::Standing,
            "circle" => self.circle(table)?,
            "wander" => {
                let (speed_mps, clearance_m) = (self.speed_mps(table), clearance_m(table));
                BehaviorSpec::Wander(WanderSpec { speed_mps, clearance_m })
            }
            "waypoints" => self.waypoints(table)?,
            _ => BehaviorSpec::WallPatrol(self.patrol(table)?),
        };
        table.sound(behavior)
    }

    fn speed_mps(&self, table: &Table<'_>) -> f64 {
        table.number("speed_mps", 0.01..=self.drive.max_linear_mps)
    }

    fn circle(&self, table: &Table<'_>) -> Option<BehaviorSpec> {
        let (speed_mps, radius_m) = (self.speed_mps(table), table.number("turn_radius_m", 0.01..=1000.0));
        let is_left = table.choice("direction", &SIDES)?;
        let curved_radps = speed_mps * self.drive.max_curvature_radpm();
        let fastest_radps = self.drive.max_angular_radps.min(curved_radps);
        if speed_mps / radius_m > fastest_radps {
            let others = [(table.at("speed_mps"), "at this speed")];
            let help = format!(
                "its drive turns at {:.1} °/s at most: at {speed_mps} m/s a circle has a radius of {:.3} m or more",
                fastest_radps.to_degrees(),
                speed_mps / fastest_radps
            );
            let mark = (table.at("turn_radius_m"), "too small");
            return table.error("a circle is too tight", mark, &others, &help);
        }
        let turn_radps = speed_mps / radius_m * if is_left { 1.0 } else { -1.0 };
        Some(BehaviorSpec::Circle(CircleSpec { speed_mps, turn_radps }))
    }

    fn waypoints(&self, table: &Table<'_>) -> Option<BehaviorSpec> {
        let points = table.needed("points_m").and_then(|value| value.points(&self.space.size));
        let repeat = table.choice("repeat", &REPEATS);
        let (speed_mps, clearance_m) = (self.speed_mps(table), clearance_m(table));
        let (points, repeat) = (points?, repeat?);
        self.is_path_free(table, &points, repeat)?;
        Some(BehaviorSpec::Waypoints(WaypointsSpec { points, speed_mps, repeat, clearance_m }))
    }

    /// Checks that the path from the start through all points is free.
    fn is_path_free(&self, table: &Table<'_>, points: &[Point2<f64>], repeat: Repeat) -> Option<()> {
        /// Kept free beside the path, m.
        const BESIDE_M: f64 = 0.05;
        let Some((radius_m, start)) = self.start else { return Some(()) };
        let ends = points.iter().enumerate().map(|(i, point)| (*point, table.at_item("points_m", i)));
        let ends: Vec<_> = ends.collect();
        let back = (repeat == Repeat::Loop && ends.len() > 1).then(|| ends[0].clone());
        let path: Vec<_> = [(start, self.robot.at("pose_m"))].into_iter().chain(ends).chain(back).collect();
        let keep_m = radius_m + BESIDE_M;
        for (leg, pair) in path.windows(2).enumerate() {
            let [(a, from), (b, to)] = pair else { continue };
            let mark = (to.clone(), "to here");
            // The robot may start on its first point.
            if leg > 0 && (b - a).norm() < 0.1 {
                let others = [(from.clone(), "from here")];
                let help = "they must be at least 0.1 m apart";
                return table.error("two waypoints coincide", mark, &others, help);
            }
            let is_near = |shape: &Rectangle| shape.segment_distance_m(a, b) < keep_m - TOUCH_M;
            if let Some(solid) = self.space.first_solid(is_near) {
                let what = format!("the way of `{}` leads through a wall or an obstacle", self.name);
                let others = [(from.clone(), "from here"), (solid.span.clone(), "too near to this one")];
                let help =
                    format!("the way must keep {keep_m:.3} m away, 0.05 m more than the robot's radius");
                return table.error(&what, mark, &others, &help);
            }
        }
        Some(())
    }
}

fn clearance_m(table: &Table<'_>) -> f64 {
    table.number_or("clearance_m", 0.15, 0.05..=10.0)
}
