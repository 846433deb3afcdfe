//! A patrol along a wall: the wall must be there, and the robot must fit beside it.

use super::Driver;
use crate::findings::Mark;
use crate::physics::space::Space;
use crate::reader::Table;
use nalgebra::{Point2, Vector2};
use sim::physics::shape::{TOUCH_M, point_segment_m};
use sim::physics::{PatrolSpec, Rectangle};

/// A wall farther away than this cannot be followed, m.
const FARTHEST_WALL_M: f64 = 2.0;
/// How far the start may lie from the path, and how much the wall's distance may vary, m.
const SLACK_M: f64 = 0.05;
/// The path's distance to its wall is sampled in steps of this, m.
const SAMPLE_EVERY_M: f64 = 0.1;

impl Driver<'_> {
    pub(super) fn patrol(&self, table: &Table<'_>) -> Option<PatrolSpec> {
        let [from, to] = ["from_m", "to_m"].map(|key| table.needed(key)?.point(&self.space.size));
        let side = table.needed("wall_side").and_then(|value| value.choice(&super::SIDES));
        let (speed_mps, clearance_m) = (self.speed_mps(table), super::clearance_m(table));
        let (from, to, wall_on_left) = (from?, to?, side?);
        let mut wall_distance_m = f64::NAN;
        if let Some((radius_m, start)) = self.start {
            let path = PatrolPath { driver: self, table, radius_m, from, to };
            path.is_free(&start)?;
            // Where a wall is invalid, a robot that follows it is not invalid as well.
            if self.space.is_whole {
                wall_distance_m = path.wall_distance_m(wall_on_left)?;
            }
        }
        Some(PatrolSpec { from, to, speed_mps, wall_on_left, wall_distance_m, clearance_m })
    }
}

/// The path of a patrol.
struct PatrolPath<'a> {
    driver: &'a Driver<'a>,
    table: &'a Table<'a>,
    radius_m: f64,
    from: Point2<f64>,
    to: Point2<f64>,
}

impl PatrolPath<'_> {
    fn error<T>(&self, what: &str, others: &[Mark<'_>], help: &str) -> Option<T> {
        let mut marks = vec![(self.table.at("from_m"), "from here")];
        marks.extend_from_slice(others);
        let what = format!("the patrol of `{}` {what}", self.driver.name);
        self.table.error(&what, (self.table.at("to_m"), "to here"), &marks, help)
    }

    /// The robot fits along the whole path, and starts on it.
    fn is_free(&self, start: &Point2<f64>) -> Option<()> {
        let radius_m = self.radius_m;
        if (self.to - self.from).norm() < 0.1 {
            return self.error("has no length", &[], "its two ends must be at least 0.1 m apart");
        }
        let is_near = |shape: &Rectangle| shape.segment_distance_m(&self.from, &self.to) < radius_m - TOUCH_M;
        if let Some(solid) = self.driver.space.first_solid(is_near) {
            let help = format!("the way must keep the robot's radius of {radius_m} m away");
            let others = [(solid.span.clone(), "through this one")];
            return self.error("leads through a wall or an obstacle", &others, &help);
        }
        let off_m = point_segment_m(start, &self.from, &self.to);
        if off_m > SLACK_M {
            let what = format!("the robot `{}` does not start on its patrol", self.driver.name);
            let help = format!("`pose_m` is {off_m:.3} m off the way; {SLACK_M} m are the most");
            let others =
                [(self.table.at("from_m"), "from here"), (self.driver.robot.at("pose_m"), "starts here")];
            return self.table.error(&what, (self.table.at("to_m"), "to here"), &others, &help);
        }
        Some(())
    }

    /// The distance of the wall on the given side; it must be parallel and without a gap.
    fn wall_distance_m(&self, on_left: bool) -> Option<f64> {
        let along = self.to - self.from;
        let side = Vector2::new(-along.y, along.x) / along.norm() * if on_left { 1.0 } else { -1.0 };
        let samples = (along.norm() / SAMPLE_EVERY_M).ceil();
        let sample = |i: f64| {
            let at = self.from + along * (i / samples);
            let Space { walls, fixed, .. } = self.driver.space;
            (at, walls.ray_m(&at, &side).min(fixed.ray_m(&at, &side)))
        };
        let (_, first_m) = sample(0.0);
        for i in 0..=samples as u32 {
            let (at, distance_m) = sample(f64::from(i));
            if distance_m > FARTHEST_WALL_M {
                let what = format!("has no wall on its {}", if on_left { "left" } else { "right" });
                let help = format!(
                    "there is none within {FARTHEST_WALL_M} m of [{:.3}, {:.3}]; check `wall_side`",
                    at.x, at.y
                );
                return self.error(&what, &[], &help);
            }
            if (distance_m - first_m).abs() > SLACK_M {
                let help = format!(
                    "the wall is {first_m:.3} m away at the start, but {distance_m:.3} m at [{:.3}, {:.3}]",
                    at.x, at.y
                );
                return self.error("does not run along its wall", &[], &help);
            }
        }
        let (radius_m, relief_m) = (self.radius_m, PatrolSpec::WALL_RELIEF_M);
        if first_m < radius_m + relief_m - TOUCH_M {
            let help = format!(
                "the wall is {first_m:.3} m away; a robot of radius {radius_m} m needs {relief_m} m more"
            );
            return self.error("is too near to its wall", &[], &help);
        }
        Some(first_m)
    }
}
