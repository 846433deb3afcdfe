//! The world from above, as pixels.

use interfaces::GridFrame;
use nalgebra::{Point2, Vector2};
use sim::physics::Fleet;
use std::ops::Range;

type Rgb = [u8; 3];

const FLOOR: Rgb = [250, 250, 247];
const WALL: Rgb = [70, 70, 75];
const OBSTACLE: Rgb = [190, 140, 80];
const DRIVEN: Rgb = [50, 100, 200];
const OTHER: Rgb = [200, 70, 60];
const HEADING: Rgb = [255, 255, 255];

/// A picture: rows from the top, 3 bytes (red, green, blue) per pixel.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The number of columns.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// The pixels.
    pub pixels: Vec<u8>,
    /// The lower left corner, m.
    low: Point2<f64>,
    pixels_per_m: f64,
}

impl Picture {
    /// The floor of a frame; the longer side has `size` pixels.
    pub(crate) fn floor(frame: &GridFrame, size: usize) -> Self {
        let (width_m, height_m) = size_m(frame);
        let size = size.clamp(16, 4096);
        let pixels_per_m = size as f64 / width_m.max(height_m);
        let pixels = |length_m: f64| ((length_m * pixels_per_m).round() as usize).clamp(1, size);
        let (width, height) = (pixels(width_m), pixels(height_m));
        Self { width, height, pixels: FLOOR.repeat(width * height), low: frame.origin(), pixels_per_m }
    }

    /// The walls and the obstacles that are present now.
    pub(crate) fn of(fleet: &Fleet, size: usize) -> Self {
        let mut picture = Self::floor(&fleet.spec().frame, size);
        fleet.walls().for_each(|corners| picture.polygon(&corners, WALL));
        fleet.obstacles().for_each(|obstacle| picture.polygon(&obstacle.corners, OBSTACLE));
        picture
    }

    /// All robots, those in `driven` in another color, with their headings.
    pub(crate) fn robots(&mut self, fleet: &Fleet, driven: &[usize]) {
        for robot in fleet.robots() {
            let color = if driven.contains(&robot.index) { DRIVEN } else { OTHER };
            let at = robot.pose.translation.vector.into();
            if robot.corners.is_empty() {
                self.disc(&at, robot.radius_m, color);
            } else {
                let corners: Vec<_> = robot.corners.iter().map(|corner| robot.pose * corner).collect();
                self.polygon(&corners, color);
            }
            let nose = robot.pose * Point2::new(robot.radius_m * 0.6, 0.0);
            self.disc(&nose, robot.radius_m * 0.25, HEADING);
        }
    }

    /// Fills a disc.
    pub(crate) fn disc(&mut self, center: &Point2<f64>, radius_m: f64, color: Rgb) {
        let reach = Vector2::repeat(radius_m);
        self.fill(center - reach, center + reach, color, |at| nalgebra::distance(at, center) <= radius_m);
    }

    /// Fills a convex polygon with corners counter-clockwise.
    pub(crate) fn polygon(&mut self, corners: &[Point2<f64>], color: Rgb) {
        let Some(first) = corners.first() else { return };
        let (low, high) =
            corners.iter().fold((*first, *first), |(low, high), at| (low.inf(at), high.sup(at)));
        let is_inside = |at: &Point2<f64>| {
            corners.iter().enumerate().all(|(index, from)| {
                let to = corners[(index + 1) % corners.len()];
                (to - from).perp(&(at - from)) >= 0.0
            })
        };
        self.fill(low, high, color, is_inside);
    }

    /// Colors the pixels in a rectangle whose center `is_inside`.
    fn fill(
        &mut self,
        low: Point2<f64>,
        high: Point2<f64>,
        color: Rgb,
        is_inside: impl Fn(&Point2<f64>) -> bool,
    ) {
        let [low, high] = [low, high].map(|at| (at - self.low) * self.pixels_per_m);
        let rows = (low.y.floor().max(0.0) as usize)..(high.y.ceil().max(0.0) as usize).min(self.height);
        let columns = (low.x.floor().max(0.0) as usize)..(high.x.ceil().max(0.0) as usize).min(self.width);
        self.paint(rows, columns, |at| is_inside(at).then_some(color));
    }

    /// Colors the cells of a frame, below everything that is drawn later; `None` leaves a cell as it is.
    pub(crate) fn cells(&mut self, frame: &GridFrame, color: impl Fn(usize) -> Option<Rgb>) {
        let color = |at: &Point2<f64>| frame.index(frame.cell_at(at)).and_then(&color);
        self.paint(0..self.height, 0..self.width, color);
    }

    /// Colors pixels by their centers, rows from the bottom; `None` leaves a pixel as it is.
    fn paint(
        &mut self,
        rows: Range<usize>,
        columns: Range<usize>,
        color: impl Fn(&Point2<f64>) -> Option<Rgb>,
    ) {
        for (row, column) in rows.flat_map(|row| columns.clone().map(move |column| (row, column))) {
            let at = self.low + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) / self.pixels_per_m;
            if let Some(color) = color(&at) {
                let pixel = ((self.height - 1 - row) * self.width + column) * 3;
                self.pixels[pixel..pixel + 3].copy_from_slice(&color);
            }
        }
    }
}

/// The width and the height of a frame, m.
pub(crate) fn size_m(frame: &GridFrame) -> (f64, f64) {
    (frame.width() as f64 * frame.resolution_m(), frame.height() as f64 * frame.resolution_m())
}
