//! A patrol must be possible.

use super::Context;
use crate::error::{Source, WorldError};
use crate::physics::file::{BehaviourFile, Pair, RobotFile};
use crate::physics::space::Solid;
use crate::together::Together;
use nalgebra::{Point2, Vector2};
use sim::physics::shape::{TOUCH_M, point_segment_m};
use sim::physics::{BehaviorSpec, PatrolSpec};

/// A wall farther away than this is none to follow, m.
const FARTHEST_WALL_M: f64 = 2.0;
/// How far the start may lie from the way, and how much the wall's distance may vary, m.
const SLACK_M: f64 = 0.05;
/// The way's distance to its wall is looked at in steps of this, m.
const LOOK_EVERY_M: f64 = 0.1;

pub(super) fn patrol(context: &Context<'_>, file: &BehaviourFile) -> Result<BehaviorSpec, WorldError> {
    let Context { source, robot, around, .. } = context;
    let table = context.table();
    let end = |key: &str, value| {
        let value: &Pair = context.needed(key, value)?;
        Ok((table.point(key, value, &around.size)?, value.span()))
    };
    let side = context.needed("wall_side", &file.wall_side).and_then(|side| match side.get_ref().as_str() {
        "left" => Ok(true),
        "right" => Ok(false),
        other => {
            let what = format!("`robot.behaviour.wall_side` is `{other}`");
            let help = "it must be \"left\" or \"right\", seen on the way from `from_m` to `to_m`";
            Err(source.error(&what, (side.span(), "no side"), &[], help))
        }
    });
    let ((from, from_span), (to, to_span), wall_on_left, speed_mps, clearance_m) = (
        end("from_m", &file.from_m),
        end("to_m", &file.to_m),
        side,
        context.speed_mps(file),
        context.clearance_m(file),
    )
        .together()?;
    let mut wall_distance_m = f64::NAN;
    if let Some((radius_m, start)) = context.place {
        let way = Way { source, robot, radius_m, from, to, spans: [from_span, to_span] };
        way.is_free(&start, around.solids)?;
        // A robot that follows a wall is not wrong because the wall is; the world is refused for that.
        if around.is_whole {
            wall_distance_m = way.wall_distance_m(wall_on_left, around.solids)?;
        }
    }
    Ok(BehaviorSpec::WallPatrol(PatrolSpec {
        from,
        to,
        speed_mps,
        wall_on_left,
        wall_distance_m,
        clearance_m,
    }))
}

/// The way of a patrol, and where the file speaks of its ends.
struct Way<'a> {
    source: &'a Source<'a>,
    robot: &'a RobotFile,
    radius_m: f64,
    from: Point2<f64>,
    to: Point2<f64>,
    spans: [std::ops::Range<usize>; 2],
}

impl Way<'_> {
    fn error(&self, what: &str, others: &[crate::error::Mark<'_>], help: &str) -> WorldError {
        let [from, to] = self.spans.clone();
        let mut marks = vec![(from, "from here")];
        marks.extend_from_slice(others);
        self.source.error(what, (to, "to here"), &marks, help)
    }

    /// The robot fits all the way, and starts on it.
    fn is_free(&self, start: &Point2<f64>, solids: &[Solid]) -> Result<(), WorldError> {
        let (name, radius_m) = (self.robot.name.get_ref(), self.radius_m);
        if (self.to - self.from).norm() < 0.1 {
            let what = format!("the patrol of `{name}` has no length");
            return Err(self.error(&what, &[], "its two ends must be at least 0.1 m apart"));
        }
        let near_m = |solid: &Solid| solid.shape.segment_distance_m(&self.from, &self.to);
        if let Some(solid) = solids.iter().find(|solid| near_m(solid) < radius_m - TOUCH_M) {
            let what = format!("the patrol of `{name}` leads through a wall or an obstacle");
            let help = format!("the way must keep the robot's radius of {radius_m} m away");
            return Err(self.error(&what, &[(solid.span.clone(), "through this one")], &help));
        }
        let off_m = point_segment_m(start, &self.from, &self.to);
        if off_m > SLACK_M {
            let what = format!("the robot `{name}` does not start on its patrol");
            let marks = [(self.robot.pose_m.span(), "starts here")];
            let help = format!("`pose_m` is {off_m:.3} m off the way; {SLACK_M} m are the most");
            return Err(self.error(&what, &marks, &help));
        }
        Ok(())
    }

    /// How far away the wall runs on the given side; it must be parallel and without a gap.
    fn wall_distance_m(&self, on_left: bool, solids: &[Solid]) -> Result<f64, WorldError> {
        let along = self.to - self.from;
        let side = Vector2::new(-along.y, along.x) / along.norm() * if on_left { 1.0 } else { -1.0 };
        let looks = (along.norm() / LOOK_EVERY_M).ceil();
        let look = |i: f64| {
            let at = self.from + along * (i / looks);
            let hits = solids.iter().filter_map(|solid| solid.shape.ray_m(&at, &side));
            (at, hits.fold(f64::INFINITY, f64::min))
        };
        let (_, first_m) = look(0.0);
        let mut i = 0.0;
        while i <= looks {
            let (at, distance_m) = look(i);
            let name = self.robot.name.get_ref();
            let side = if on_left { "left" } else { "right" };
            if distance_m > FARTHEST_WALL_M {
                let what = format!("the patrol of `{name}` has no wall on its {side}");
                let help = format!(
                    "there is none within {FARTHEST_WALL_M} m of [{:.3}, {:.3}]; check `wall_side`",
                    at.x, at.y
                );
                return Err(self.error(&what, &[], &help));
            }
            if (distance_m - first_m).abs() > SLACK_M {
                let what = format!("the patrol of `{name}` does not run along its wall");
                let help = format!(
                    "the wall is {first_m:.3} m away at the start, but {distance_m:.3} m at [{:.3}, {:.3}]",
                    at.x, at.y
                );
                return Err(self.error(&what, &[], &help));
            }
            i += 1.0;
        }
        let (name, radius_m) = (self.robot.name.get_ref(), self.radius_m);
        let relief_m = PatrolSpec::WALL_RELIEF_M;
        if first_m < radius_m + relief_m - TOUCH_M {
            let what = format!("the patrol of `{name}` is too near to its wall");
            let help = format!(
                "the wall is {first_m:.3} m away; a robot of radius {radius_m} m needs {relief_m} m more"
            );
            return Err(self.error(&what, &[], &help));
        }
        Ok(first_m)
    }
}
