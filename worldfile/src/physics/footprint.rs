//! The outline of a robot: a circle, or a convex polygon.

use crate::reader::{Table, Value};
use nalgebra::Point2;
use sim::physics::convex;

const MOST_CORNERS: usize = 32;

/// The area of a robot's body.
pub(super) struct Footprint {
    /// The radius of the circle about its center that contains the body, m.
    pub(super) radius_m: f64,
    /// The radius of the circle about its center that is contained in the body, m.
    pub(super) inner_m: f64,
    /// The corners, counter-clockwise, m; empty for a circle.
    pub(super) corners: Vec<Point2<f64>>,
}

/// The outline of the robot `name`.
pub(super) fn footprint(table: &Table<'_>, name: &str) -> Option<Footprint> {
    match (table.has("radius_m"), table.get("footprint_m")) {
        (true, None) => {
            let radius_m = table.number("radius_m", 0.02..=10.0)?;
            Some(Footprint { radius_m, inner_m: radius_m, corners: Vec::new() })
        }
        (false, Some(value)) => polygon(&value),
        _ => {
            let what = format!("the robot `{name}` needs one outline");
            let help = "give either `radius_m` or `footprint_m`";
            table.error(&what, (table.at("name"), "this robot"), &[], help)
        }
    }
}

fn polygon(value: &Value<'_, '_>) -> Option<Footprint> {
    let count = value.items()?.len();
    if !(3..=MOST_CORNERS).contains(&count) {
        let help = "it must have 3 to 32, as in `[[-0.2, -0.1], [0.3, 0.0], [-0.2, 0.1]]`";
        return value.invalid(&format!("has {count} corners"), "this footprint", help);
    }
    let mut corners = value.list(|corner| corner.pair_within(&(-10.0..=10.0)))?;
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
    let turns: Vec<f64> = convex::sides(&corners).map(|(a, b)| libm::atan2((b - a).y, (b - a).x)).collect();
    let around: f64 =
        (0..turns.len()).map(|i| interfaces::wrap_rad(turns[(i + 1) % turns.len()] - turns[i])).sum();
    if (0..corners.len()).any(|i| turn(i) < 1e-6) || around > 7.0 {
        return value.invalid("is not convex", "this footprint", "every corner must point outwards");
    }
    let inner_m = -convex::disc_gap_m(&corners, &Point2::origin(), 0.0);
    if inner_m < 0.02 {
        let help = "the point that the robot turns about, [0, 0], must be 0.02 m within it or more";
        let what = "a robot turns about a point outside of itself";
        return value.error(what, "this footprint", help);
    }
    let radius_m = corners.iter().map(|corner| corner.coords.norm()).fold(0.0, f64::max);
    Some(Footprint { radius_m, inner_m, corners })
}
