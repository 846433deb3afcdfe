//! The body of a model: its blocks, its bitmap, or a box.

use super::lexer::Span;
use super::polygon;
use super::tree::Entity;
use super::world::Builder;
use interfaces::pose;
use nalgebra::{Isometry2, Point2, Vector2};
use sim::physics::Rectangle;
use worldfile::floor_plan::FloorPlan;

/// A block with more corners than this is an error.
const MAX_POINTS: f64 = 1000.0;
/// The border that `boundary` puts around a bitmap, m.
const BOUNDARY_M: f64 = 0.01;

/// The shape of a model in the frame of the world.
#[derive(Debug, Default)]
pub(super) struct Body {
    pub(super) plan: Option<FloorPlan>,
    pub(super) polygons: Vec<Vec<Point2<f64>>>,
}

impl Body {
    pub(super) fn is_empty(&self) -> bool {
        self.plan.is_none() && self.polygons.is_empty()
    }

    /// The corners of every piece.
    pub(super) fn corners(&self) -> impl Iterator<Item = Vec<Point2<f64>>> {
        let pixels = self.plan.iter().flat_map(|plan| plan.rectangles().map(|r| r.corners().to_vec()));
        self.polygons.iter().cloned().chain(pixels)
    }

    /// Solid rectangles, and how far they may be off the polygons, m.
    pub(super) fn rectangles(&self) -> (Vec<Rectangle>, f64) {
        let mut rectangles: Vec<Rectangle> = self.plan.iter().flat_map(FloorPlan::rectangles).collect();
        let mut off_m = 0.0_f64;
        for polygon in &self.polygons {
            let cover = polygon::cover(polygon);
            off_m = off_m.max(cover.off_m);
            rectangles.extend(cover.rectangles);
        }
        (rectangles, off_m)
    }
}

/// The polygon of a block, before it is scaled to the size of the model, m.
type Block = Vec<Point2<f64>>;

impl Builder<'_, '_> {
    /// The body of a model whose pose is `at`. `has_box`: without blocks or a bitmap it is a box.
    pub(super) fn body(
        &mut self,
        model: &Entity,
        at: &Isometry2<f64>,
        size_m: Vector2<f64>,
        has_box: bool,
    ) -> Body {
        let at = at * self.pose(model, "origin");
        let parts = model.parts.iter().filter(|part| part.kind == "block");
        let blocks: Vec<Block> = parts.filter_map(|part| self.block(part)).collect();
        let has_no_box = self.flag(model, "noblocks") == Some(true);
        let has_boundary = self.flag(model, "boundary") == Some(true);
        let (x, y) = (size_m.x, size_m.y);
        let bitmap = self.text(model, "bitmap");
        let plan = bitmap.and_then(|(name, place)| self.plan(&name, place, &at, size_m));
        let mut body = Body { plan, polygons: Vec::new() };
        let has_plan = body.plan.is_some();
        let rectangle = |left: f64, bottom: f64, width: f64, height: f64| -> Vec<Point2<f64>> {
            let (right, top) = (left + width, bottom + height);
            let corners = [(left, bottom), (right, bottom), (right, top), (left, top)];
            corners.map(|(x, y)| at * Point2::new(x, y)).to_vec()
        };
        let (left, bottom) = (-x / 2.0, -y / 2.0);
        if has_boundary && has_plan {
            body.polygons.push(rectangle(left, bottom, BOUNDARY_M, y));
            body.polygons.push(rectangle(left, bottom, x, BOUNDARY_M));
            body.polygons.push(rectangle(left, bottom + y - BOUNDARY_M, x, BOUNDARY_M));
            body.polygons.push(rectangle(left + x - BOUNDARY_M, bottom, BOUNDARY_M, y));
        } else if has_boundary {
            let help = "in Stage, too, blocks take the place of the boundary";
            self.sources.warning(model.place, "`boundary` without `bitmap` has no effect", help);
        }
        if !blocks.is_empty() {
            if has_plan {
                let help = "Stage fits both into the size together, here each fills it by itself";
                self.sources.warning(model.place, "a thing with a bitmap and blocks", help);
            }
            let blocks = self.scaled(model.place, &blocks, &at, &size_m);
            body.polygons.extend(blocks);
        } else if !has_plan && has_box && !has_no_box && !model.properties.contains_key("bitmap") {
            body.polygons.push(rectangle(left, bottom, x, y));
        }
        body
    }

    fn block(&mut self, block: &Entity) -> Option<Block> {
        let help = "it needs `points` (3 or more) and as many `point[0] [x y]`, `point[1] [x y]`, …";
        if !block.properties.contains_key("points") {
            self.sources.error(block.place, "a block has no shape", help);
        }
        let count = self.number(block, "points", 3.0..=MAX_POINTS)?;
        let mut points = Vec::new();
        for i in 0..count as usize {
            let key = format!("point[{i}]");
            if !block.properties.contains_key(&key) {
                self.sources.error(block.place, format!("a block has no `{key}`"), help);
            }
            points.push(Point2::from_slice(&self.lengths_m(block, &key, 2)?));
        }
        Some(points)
    }

    /// Blocks in the world, scaled so that they fill the size of their model together, about its middle.
    fn scaled(
        &mut self,
        place: Span,
        blocks: &[Block],
        at: &Isometry2<f64>,
        size_m: &Vector2<f64>,
    ) -> Vec<Vec<Point2<f64>>> {
        let (low, high) = polygon::bounds(blocks.iter().flatten().copied());
        let extent = high - low;
        if extent.min() < 1e-9 {
            self.sources.error(place, "the blocks of this thing have no area", "they lie on one line");
            return Vec::new();
        }
        let scale = size_m.component_div(&extent);
        let middle = nalgebra::center(&low, &high);
        let scaled = |point: &Point2<f64>| at * Point2::from((point - middle).component_mul(&scale));
        blocks.iter().map(|points| points.iter().map(scaled).collect()).collect()
    }

    /// The picture of a bitmap, scaled so that its blocked pixels fill `size_m`.
    fn plan(
        &mut self,
        name: &str,
        place: Span,
        at: &Isometry2<f64>,
        size_m: Vector2<f64>,
    ) -> Option<FloorPlan> {
        // As in Stage, beside the world file, not beside the file that names it.
        let path = self.sources.beside(self.sources.path(), place);
        let bitmap = match self.pictures.get(self.sources.files, &path) {
            Ok(bitmap) => bitmap,
            Err(error) => {
                let what = format!("cannot read the picture `{}`: {error}", path.display());
                let help = "is looked for in the folder of the world file, and must be PNG or PGM";
                self.sources.error(place, what, format!("`{name}` {help}"));
                return None;
            }
        };
        let Some(bounds) = bitmap.blocked_bounds() else {
            self.sources.warning(place, "no pixel of this picture is dark", "it makes no walls");
            return None;
        };
        let (low, high): (Vector2<u32>, Vector2<u32>) = (bounds.min.into(), bounds.max.into());
        let pixel_m = size_m.component_div(&(high - low).cast());
        let lower_left = -size_m / 2.0 - low.cast().component_mul(&pixel_m);
        Some(FloorPlan { bitmap, pixel_m, origin: at * pose(lower_left.x, lower_left.y, 0.0) })
    }
}
