//! The space that things of a file are put into: the map, and what is solid.

use super::file::Pair;
use super::numbers::{Table, extent};
use crate::error::{Source, WorldError};
use crate::together::Together;
use nalgebra::Point2;
use sim::physics::Rectangle;
use sim::physics::shape::TOUCH_M;
use std::ops::Range;

/// The latest time that a file can name, s: some thirty years.
pub(super) const MAX_TIME_S: f64 = 1e9;

/// Something solid, and where the file speaks of it.
pub(super) struct Solid {
    pub(super) shape: Rectangle,
    pub(super) span: Range<usize>,
}

/// What a robot is put into. What is wrong in the file is missing here.
pub(super) struct Around<'a> {
    pub(super) size: Point2<f64>,
    pub(super) step_s: f64,
    /// What stands from the start to the end.
    pub(super) solids: &'a [Solid],
    /// What stands at the start but may be gone when a robot comes by.
    pub(super) movers: &'a [Solid],
    /// Whether nothing is missing.
    pub(super) is_whole: bool,
}

/// The rectangle between two corners.
pub(super) fn upright(
    table: &Table<'_>,
    min: &Pair,
    max: &Pair,
    size: &Point2<f64>,
) -> Result<Rectangle, WorldError> {
    let (low, high) = (table.point("min_m", min, size), table.point("max_m", max, size)).together()?;
    if (high - low).min() < 0.001 {
        let what = format!("`{}.max_m` is not above and to the right of `min_m`", table.path);
        let help = "`min_m` is the lower left corner, `max_m` the upper right one, at least 0.001 m away";
        return Err(table.source.error(
            &what,
            (max.span(), "upper right"),
            &[(min.span(), "lower left")],
            help,
        ));
    }
    Ok(Rectangle::between(low, high))
}

pub(super) fn inside(
    source: &Source<'_>,
    what: &str,
    span: Range<usize>,
    shape: &Rectangle,
    size: &Point2<f64>,
) -> Result<(), WorldError> {
    let (low, high) = shape.bounds();
    if low.x >= -TOUCH_M && low.y >= -TOUCH_M && high.x <= size.x + TOUCH_M && high.y <= size.y + TOUCH_M {
        return Ok(());
    }
    let help = format!(
        "it spans [{:.3}, {:.3}] to [{:.3}, {:.3}], the map {}",
        low.x,
        low.y,
        high.x,
        high.y,
        extent(size)
    );
    Err(source.error(what, (span, "this one"), &[], &help))
}
