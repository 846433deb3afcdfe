//! The space that the things of a file are put into: the map, and what is solid.

use crate::reader::{File, Table, extent};
use nalgebra::{Point2, Vector2};
use sim::physics::shape::TOUCH_M;
use sim::physics::{BoxTree, Rectangle};
use std::cell::Cell;
use std::ops::Range;

/// The maximum time in a file, s: about thirty years.
pub(super) const MAX_TIME_S: f64 = 1e9;

/// Something solid, and its place in the file.
pub(super) struct Solid {
    pub(super) shape: Rectangle,
    pub(super) span: Range<usize>,
}

/// Solid things in the order of the file. A search does not look at all of them.
#[derive(Default)]
pub(super) struct Solids {
    pub(super) solids: Vec<Solid>,
    tree: BoxTree,
}

impl Solids {
    pub(super) fn new(solids: Vec<Solid>) -> Self {
        let tree = BoxTree::new(solids.iter().map(|solid| solid.shape.bounds()));
        Self { solids, tree }
    }

    /// The first solid for whose shape `is_near` holds. It must hold for a shape that holds a smaller one for which
    /// it holds.
    pub(super) fn first(&self, is_near: impl Fn(&Rectangle) -> bool) -> Option<&Solid> {
        let found = self.tree.first_below(usize::MAX, &is_near, |index| is_near(&self.solids[index].shape));
        found.map(|index| &self.solids[index])
    }

    /// The range at which a ray from `origin` (m) in the direction of the unit vector `direction` hits the nearest
    /// solid, m; infinite if there is none.
    pub(super) fn ray_m(&self, origin: &Point2<f64>, direction: &Vector2<f64>) -> f64 {
        let nearest_m = Cell::new(f64::INFINITY);
        let range_m = |shape: &Rectangle| shape.ray_m(origin, direction).unwrap_or(f64::INFINITY);
        let may_be_nearest = |area: &Rectangle| range_m(area) < nearest_m.get();
        self.tree.first_below(usize::MAX, may_be_nearest, |index| {
            nearest_m.set(nearest_m.get().min(range_m(&self.solids[index].shape)));
            false
        });
        nearest_m.get()
    }
}

/// The surroundings of a robot or an obstacle. What is invalid in the file is missing.
pub(super) struct Space {
    /// The size of the map, m; infinite if it is invalid.
    pub(super) size: Point2<f64>,
    /// The physics step, s; tiny if it is invalid.
    pub(super) step_s: f64,
    pub(super) walls: Solids,
    /// The obstacles that stand from the start to the end.
    pub(super) fixed: Solids,
    /// The obstacles that stand at the start but can be gone later.
    pub(super) movers: Solids,
    /// Whether nothing is missing.
    pub(super) is_whole: bool,
}

impl Space {
    /// The first thing that stands from the start to the end and for whose shape `is_near` holds, as in
    /// [`Solids::first`].
    pub(super) fn first_solid(&self, is_near: impl Fn(&Rectangle) -> bool) -> Option<&Solid> {
        self.walls.first(&is_near).or_else(|| self.fixed.first(&is_near))
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
    let [from, to] = [low, high].map(|corner| format!("[{:.3}, {:.3}]", corner.x, corner.y));
    let help = format!("it spans {from} to {to}, the map {}", extent(size));
    file.error(what, (span, "this one"), &[], &help)
}
