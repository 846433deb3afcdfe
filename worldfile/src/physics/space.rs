//! The space that the things of a file are put into: the map, and what is solid.

use crate::reader::{File, Table, extent};
use nalgebra::Point2;
use sim::physics::Rectangle;
use sim::physics::shape::TOUCH_M;
use std::ops::Range;

/// The maximum time in a file, s: about thirty years.
pub(super) const MAX_TIME_S: f64 = 1e9;

/// Something solid, and its place in the file.
pub(super) struct Solid {
    pub(super) shape: Rectangle,
    pub(super) span: Range<usize>,
}

/// The surroundings of a robot or an obstacle. What is invalid in the file is missing.
pub(super) struct Space {
    /// The size of the map, m; infinite if it is invalid.
    pub(super) size: Point2<f64>,
    /// The physics step, s; tiny if it is invalid.
    pub(super) step_s: f64,
    pub(super) walls: Vec<Solid>,
    /// The obstacles that stand from the start to the end.
    pub(super) fixed: Vec<Solid>,
    /// The obstacles that stand at the start but can be gone later.
    pub(super) movers: Vec<Solid>,
    /// Whether nothing is missing.
    pub(super) is_whole: bool,
}

impl Space {
    /// Everything that stands from the start to the end.
    pub(super) fn solids(&self) -> impl Iterator<Item = &Solid> {
        self.walls.iter().chain(&self.fixed)
    }
}

/// The rectangle between the corners `min_m` and `max_m` of a table.
pub(super) fn upright(table: &Table<'_>, size: &Point2<f64>) -> Option<Rectangle> {
    let [low, high] = ["min_m", "max_m"].map(|key| table.needed(key)?.point(size));
    let (low, high) = (low?, high?);
    if (high - low).min() < 0.001 {
        let what = format!("`{}` is not above and to the right of `min_m`", table.path("max_m"));
        let help = "`min_m` is the lower left corner, `max_m` the upper right one, at least 0.001 m away";
        let others = [(table.at("min_m"), "lower left")];
        return table.error(&what, (table.at("max_m"), "upper right"), &others, help);
    }
    Some(Rectangle::between(low, high))
}

/// Records an error for a shape that is partly outside of the map.
pub(super) fn inside(
    file: &File<'_>,
    what: &str,
    span: Range<usize>,
    shape: &Rectangle,
    size: &Point2<f64>,
) -> Option<()> {
    let (low, high) = shape.bounds();
    if low.x >= -TOUCH_M && low.y >= -TOUCH_M && high.x <= size.x + TOUCH_M && high.y <= size.y + TOUCH_M {
        return Some(());
    }
    let help = format!(
        "it spans [{:.3}, {:.3}] to [{:.3}, {:.3}], the map {}",
        low.x,
        low.y,
        high.x,
        high.y,
        extent(size)
    );
    file.error(what, (span, "this one"), &[], &help)
}
