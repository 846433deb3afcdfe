//! The body of a thing: its blocks, its bitmap, or a box.

use super::place::Place;
use super::polygon;
use super::tree::Thing;
use super::values::{Pose, Reader};
use interfaces::pose;
use nalgebra::{Isometry2, Point2, Vector2};
use sim::physics::Rectangle;
use std::sync::Arc;
use worldfile::floor_plan::{Bitmap, FloorPlan};

/// A block with more corners than this is an error.
const MAX_POINTS: f64 = 1000.0;
/// The border that `boundary` puts around a bitmap, m.
const BOUNDARY_M: f64 = 0.01;

/// What a thing is made of, in the frame of the world.
#[derive(Debug, Default)]
pub(super) struct Body {
    pub(super) plan: Option<FloorPlan>,
    pub(super) polygons: Vec<Vec<Point2<f64>>>,
    /// The lowest and the highest point, m.
    pub(super) z_m: [f64; 2],
}

impl Body {
    pub(super) fn is_empty(&self) -> bool {
        self.plan.is_none() && self.polygons.is_empty()
    }

    /// All corners.
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

/// A polygon of a block, before it is scaled to the size of its thing.
struct Block {
    points: Vec<Point2<f64>>,
    z: [f64; 2],
}

impl Reader<'_, '_> {
    /// The body of a thing at `at`, which is where its pose is, and its size. `has_box`: without
    /// blocks or a bitmap it is a box.
    pub(super) fn body(&mut self, thing: &Thing, at: &Pose, size_m: [f64; 3], has_box: bool) -> Body {
        let origin = self.pose(thing, "origin").unwrap_or(Pose::origin());
        let at = at.then(&origin);
        let blocks: Vec<Block> = thing
            .parts
            .iter()
            .filter(|part| part.kind == "block")
            .filter_map(|part| self.block(part))
            .collect();
        let has_no_box = self.flag(thing, "noblocks") == Some(true);
        let boundary = self.flag(thing, "boundary") == Some(true);
        let plan = self.text(thing, "bitmap").and_then(|(name, place)| {
            let plan = self.plan(&name, place)?;
            self.fit(plan, place, &at, size_m)
        });
        let whole = [at.z_m, at.z_m + size_m[2]];
        let mut body = Body { plan, polygons: Vec::new(), z_m: whole };
        if boundary {
            self.boundary(thing, &mut body, &at, size_m);
        }
        if !blocks.is_empty() {
            if body.plan.is_some() {
                let help = "Stage fits both into the size together, here each fills it by itself";
                self.sources.warning(thing.place, "a thing with a bitmap and blocks", "", help);
            }
            self.scale(thing.place, &blocks, &at, size_m, &mut body);
        } else if body.plan.is_none() && has_box && !has_no_box && !thing.properties.contains_key("bitmap") {
            body.polygons.push(rectangle(&at.flat, -size_m[0] / 2.0, -size_m[1] / 2.0, size_m[0], size_m[1]));
        }
        body
    }

    fn block(&mut self, block: &Thing) -> Option<Block> {
        let what = "a block has no shape";
        let help = "it needs `points` (3 or more) and as many `point[0] [x y]`, `point[1] [x y]`, …";
        let Some(count) = self.number(block, "points", 3.0..=MAX_POINTS) else {
            if !block.properties.contains_key("points") {
                self.sources.error(block.place, what, "", help);
            }
            return None;
        };
        let mut points = Vec::new();
        for i in 0..count as usize {
            let key = format!("point[{i}]");
            if !block.properties.contains_key(&key) {
                self.sources.error(block.place, &format!("a block has no `{key}`"), "", help);
                return None;
            }
            let (numbers, _) = self.numbers(block, &key, 2..=2)?;
            points.push(Point2::new(numbers[0], numbers[1]) * self.length_m);
        }
        let z = self.numbers(block, "z", 2..=2).map_or([0.0, 1.0], |(z, _)| [z[0], z[1]]);
        if let Some((_, place)) = self.text(block, "color") {
            self.sources.harmless(place, "color");
        }
        Some(Block { points, z: z.map(|z| z * self.length_m) })
    }

    /// Scales blocks so that they fill the size of their thing together, about its middle.
    fn scale(&mut self, place: Place, blocks: &[Block], at: &Pose, size_m: [f64; 3], body: &mut Body) {
        let all = || blocks.iter().flat_map(|block| &block.points);
        let low = all().fold(Point2::new(f64::MAX, f64::MAX), |low, point| low.inf(point));
        let high = all().fold(Point2::new(f64::MIN, f64::MIN), |high, point| high.sup(point));
        let extent = high - low;
        if extent.min() < 1e-9 {
            self.sources.error(place, "the blocks of this thing have no area", "", "they lie on one line");
            return;
        }
        let scale = Vector2::new(size_m[0], size_m[1]).component_div(&extent);
        let middle = nalgebra::center(&low, &high);
        for block in blocks {
            let points = block
                .points
                .iter()
                .map(|point| at.flat * Point2::from((point - middle).component_mul(&scale)));
            body.polygons.push(points.collect());
        }
        let low_z = blocks.iter().map(|block| block.z[0]).fold(f64::MAX, f64::min);
        let high_z = blocks.iter().map(|block| block.z[1]).fold(f64::MIN, f64::max);
        let per_z = if high_z - low_z > 1e-9 { size_m[2] / (high_z - low_z) } else { 1.0 };
        body.z_m = [at.z_m + low_z * per_z, at.z_m + high_z * per_z];
    }

    fn plan(&mut self, name: &str, place: Place) -> Option<Arc<Bitmap>> {
        // As in Stage, beside the world file, not beside the file that names it.
        let world = self.sources.path(Place { file: 0, ..place }).to_owned();
        let path = self.sources.beside(&world, place);
        match self.pictures.get(&path) {
            Ok(bitmap) => Some(bitmap),
            Err(error) => {
                let what = format!("cannot read the picture `{}`: {error}", path.display());
                let help =
                    format!("`{name}` is looked for in the folder of the world file, and must be PNG or PGM");
                self.sources.error(place, &what, "", &help);
                None
            }
        }
    }

    /// Scales a bitmap so that its blocked pixels fill `size_m`.
    fn fit(&mut self, bitmap: Arc<Bitmap>, place: Place, at: &Pose, size_m: [f64; 3]) -> Option<FloorPlan> {
        let Some((low, high)) = bitmap.blocked_bounds() else {
            self.sources.warning(place, "no pixel of this picture is dark", "", "it makes no walls");
            return None;
        };
        let corner = |[x, y]: [u32; 2]| Vector2::new(f64::from(x), f64::from(y));
        let size = Vector2::new(size_m[0], size_m[1]);
        let pixel_m = size.component_div(&(corner(high) - corner(low)));
        let lower_left = -size / 2.0 - corner(low).component_mul(&pixel_m);
        Some(FloorPlan { bitmap, pixel_m, origin: at.flat * pose(lower_left.x, lower_left.y, 0.0) })
    }

    /// The thin walls around a bitmap.
    fn boundary(&mut self, thing: &Thing, body: &mut Body, at: &Pose, [x, y, _]: [f64; 3]) {
        if body.plan.is_none() {
            let help = "in Stage, too, blocks take the place of the boundary";
            self.sources.warning(thing.place, "`boundary` without `bitmap` has no effect", "", help);
            return;
        }
        let (left, bottom) = (-x / 2.0, -y / 2.0);
        let thin = BOUNDARY_M;
        for (x, y, width, height) in [
            (left, bottom, thin, y),
            (left, bottom, x, thin),
            (left, bottom + y - thin, x, thin),
            (left + x - thin, bottom, thin, y),
        ] {
            body.polygons.push(rectangle(&at.flat, x, y, width, height));
        }
    }
}

fn rectangle(at: &Isometry2<f64>, x: f64, y: f64, width: f64, height: f64) -> Vec<Point2<f64>> {
    let corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)];
    corners.map(|(x, y)| at * Point2::new(x, y)).to_vec()
}
