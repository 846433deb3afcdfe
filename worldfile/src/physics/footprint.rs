//! The outline of a robot: a circle, or a convex polygon.

use super::file::{Pair, RobotFile};
use super::numbers::Table;
use crate::error::{Source, WorldError};
use crate::together::Together;
use nalgebra::Point2;
use sim::physics::convex;

const MOST_CORNERS: usize = 32;

/// What a robot's body covers.
pub(super) struct Footprint {
    /// The radius of the circle about its middle that holds it, m.
    pub(super) radius_m: f64,
    /// The radius of the circle about its middle that it holds, m.
    pub(super) inner_m: f64,
    /// The corners, counter-clockwise, m; none: it is a circle.
    pub(super) corners: Vec<Point2<f64>>,
}

pub(super) fn footprint(source: &Source<'_>, file: &RobotFile) -> Result<Footprint, WorldError> {
    let table = Table { source, path: "robot" };
    match (&file.radius_m, &file.footprint_m) {
        (Some(radius), None) => {
            let radius_m = table.number("radius_m", radius, 0.02..=10.0)?;
            Ok(Footprint { radius_m, inner_m: radius_m, corners: Vec::new() })
        }
        (None, Some(footprint)) => {
            let error = |what: &str, help: &str| {
                Err(source.error(what, (footprint.span(), "this footprint"), &[], help))
            };
            let pairs: &Vec<Pair> = footprint.get_ref();
            if !(3..=MOST_CORNERS).contains(&pairs.len()) {
                let what = format!("`robot.footprint_m` has {} corners", pairs.len());
                return error(&what, "it must have 3 to 32, as in `[[-0.2, -0.1], [0.3, 0.0], [-0.2, 0.1]]`");
            }
            let corners = pairs.iter().map(|pair| table.pair("footprint_m", pair, -10.0..=10.0));
            let mut corners = corners.collect::<Vec<_>>().together()?;
            // Either way around is fine.
            let area: f64 = convex::sides(&corners).map(|(a, b)| a.coords.perp(&b.coords)).sum();
            if area < 0.0 {
                corners.reverse();
            }
            let turn = |i: usize| {
                let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % corners.len()]);
                (b - a).perp(&(c - b))
            };
            // Turning left at every corner, it may still go around twice.
            let turns = convex::sides(&corners).map(|(a, b)| libm::atan2((b - a).y, (b - a).x));
            let turns: Vec<f64> = turns.collect();
            let around: f64 =
                (0..turns.len()).map(|i| interfaces::wrap_rad(turns[(i + 1) % turns.len()] - turns[i])).sum();
            if (0..corners.len()).any(|i| turn(i) < 1e-6) || around > 7.0 {
                return error("`robot.footprint_m` is not convex", "every corner must point outwards");
            }
            let inner_m = -convex::disc_gap_m(&corners, &Point2::origin(), 0.0);
            if inner_m < 0.02 {
                let help = "the point that the robot turns about, [0, 0], must be 0.02 m within it or more";
                return error("a robot turns about a point outside of itself", help);
            }
            let radius_m = corners.iter().map(|corner| corner.coords.norm()).fold(0.0, f64::max);
            Ok(Footprint { radius_m, inner_m, corners })
        }
        _ => {
            let what = format!("the robot `{}` needs one outline", file.name.get_ref());
            let help = "give either `radius_m` or `footprint_m`";
            Err(source.error(&what, (file.name.span(), "this robot"), &[], help))
        }
    }
}
