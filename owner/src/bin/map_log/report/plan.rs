//! The plan of the place: turned so that its walls are upright, and parts of it.

use super::labels::{Mark, Rectangle, drawn, labels};
use super::{hex, number};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use draw::canvas::png_of_palette;
use draw::layers::{BLOCKED, FREE, Layer, UNKNOWN};
use draw::palette;
use draw::scene::span;
use interfaces::Cell;
use mapper::Mapper;
use maud::{Markup, html};
use nalgebra::{Point2, Vector2};
use std::f64::consts::FRAC_PI_2;
use survey::upright_rad;

/// The share of the plan from which on a point is beside its middle.
const BESIDE: f64 = 0.05;
/// The width of a whole plan in units of its drawing: labels are legible on a telephone.
const WIDTH: f64 = 720.0;
/// The space around the map, for labels, and that below it, for the scale.
const MARGIN: f64 = 48.0;
const BELOW: f64 = 38.0;
/// The largest number of pixels along the longer side of a plan: several cells of a large map share one.
const MAX_PIXELS: f64 = 1500.0;
/// A plan that is wider than high by this factor is turned once more: telephones and pages are high.
const WIDE: f64 = 1.5;
/// This share of the rows and columns of cells that were seen is left out at each end: single beams through windows.
const TAIL: f64 = 0.002;
/// The space around what was seen, m.
const AROUND_M: f64 = 0.5;
/// The least side of a rectangle on the plan, m: the front of a wall is a cell wide.
const LEAST_SIDE_M: f64 = 0.3;
/// The class of a cell that changed.
const CHANGED: u8 = 68;
/// The lengths of the scale, m.
const SCALES_M: [f64; 8] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];

/// A rectangle of the turned map.
#[derive(Clone, Copy)]
pub(super) struct Plan<'a> {
    mapper: &'a Mapper,
    /// The angle by which the map is turned counter-clockwise.
    pub(super) turn_rad: f64,
    /// Its lower left corner and its size in the turned frame, m.
    low: Point2<f64>,
    size: Vector2<f64>,
    /// Units of the drawing per meter, and the space around the map in units.
    scale: f64,
    margin: f64,
    /// The cells of the map along the side of a pixel of its pictures.
    cells_per_pixel: usize,
}

impl<'a> Plan<'a> {
    /// The plan of all that was seen.
    pub(super) fn whole(mapper: &'a Mapper) -> Self {
        let mut turn_rad = upright_rad(mapper);
        let (mut low, mut size) = seen(mapper, turn_rad);
        if size.x > WIDE * size.y {
            turn_rad += FRAC_PI_2;
            (low, size) = seen(mapper, turn_rad);
        }
        let scale = (WIDTH - 2.0 * MARGIN) / size.x;
        let cells_per_pixel =
            (size.max() / MAX_PIXELS / mapper.frame().resolution_m()).ceil().max(1.0) as usize;
        Self { mapper, turn_rad, low, size, scale, margin: MARGIN, cells_per_pixel }
    }

    /// The square of this side around a point, m.
    pub(super) fn around(&self, at: &Point2<f64>, side_m: f64) -> Self {
        let size = Vector2::repeat(side_m);
        let low = interfaces::rotation(self.turn_rad) * at - size / 2.0;
        Self { low, size, scale: 300.0 / side_m, margin: 0.0, ..*self }
    }

    /// A point of the map in units of the drawing.
    pub(super) fn unit(&self, at: &Point2<f64>) -> Point2<f64> {
        let from = interfaces::rotation(self.turn_rad) * at - self.low;
        Point2::new(from.x, self.size.y - from.y) * self.scale + Vector2::repeat(self.margin)
    }

    /// Where a point is on the plan, in words.
    pub(super) fn words(&self, at: &Point2<f64>) -> String {
        let from = interfaces::rotation(self.turn_rad) * at - self.low;
        words([from.x / self.size.x, from.y / self.size.y])
    }

    /// The size of the drawing, in units.
    pub(super) fn drawing(&self) -> Vector2<f64> {
        let below = if self.margin > 0.0 { BELOW } else { 0.0 };
        self.size * self.scale + Vector2::new(2.0 * self.margin, 2.0 * self.margin + below)
    }

    /// The picture of all cells that every plan on the page shows a part of.
    pub(super) fn picture(&self, layer: Layer) -> Markup {
        let mut classes = layer.classes(self.mapper);
        let mut colors: Vec<palette::Rgb> = (0..CHANGED).map(|class| layer.color(class)).collect();
        colors.push(palette::MOVING);
        if layer == Layer::Occupancy {
            let changed = self.mapper.changed().filter(|index| self.mapper.rate(*index) > 0.0);
            changed.for_each(|index| classes.cells_mut()[index] = CHANGED);
        }
        // Where several cells meet in one pixel, the one that tells most is shown.
        let rank = |class: &u8| match *class {
            ..=UNKNOWN => 0,
            FREE => 1,
            BLOCKED => 2,
            class => u8::MAX - class, // short intervals first
        };
        let (frame, side) = (self.mapper.frame(), self.cells_per_pixel);
        let size = [frame.width(), frame.height()].map(|cells| cells.div_ceil(side));
        let pixel = |column: usize, row: usize| {
            let cells = (0..side * side).filter_map(|cell| {
                let [x, y] = [column * side + cell % side, row * side + cell / side];
                classes.get(Cell::new(x as i32, y as i32)).copied()
            });
            cells.max_by_key(rank).unwrap_or(UNKNOWN)
        };
        // The rows of a picture count from the top.
        let rows = (0..size[1]).rev().flat_map(|row| (0..size[0]).map(move |column| (column, row)));
        let pixels: Vec<u8> = rows.map(|(column, row)| pixel(column, row)).collect();
        let png = STANDARD.encode(png_of_palette(size.map(|length| length as u32), &colors, &pixels));
        html! {
            svg.picture width="0" height="0" {
                image id=(layer.name()) width=(size[0]) height=(size[1]) href={ "data:image/png;base64," (png) } {}
            }
        }
    }

    /// The cells of a picture of the page, as an element of a drawing.
    pub(super) fn cells(&self, layer: Layer) -> Markup {
        let (frame, side) = (self.mapper.frame(), self.cells_per_pixel);
        let (pixel_m, rows) = (side as f64 * frame.resolution_m(), frame.height().div_ceil(side) as f64);
        // From pixels to units of the drawing.
        let unit = |x: f64, y: f64| {
            self.unit(&(frame.origin() + Vector2::new(x, rows - y) * pixel_m)) - Vector2::repeat(self.margin)
        };
        let origin = unit(0.0, 0.0);
        let [x, y] = [unit(1.0, 0.0) - origin, unit(0.0, 1.0) - origin];
        let matrix = [x.x, x.y, y.x, y.y, origin.x, origin.y].map(|value| format!("{value:.5}")).join(" ");
        let [width, height] = [self.size.x, self.size.y].map(|length_m| number(length_m * self.scale));
        html! {
            svg x=(self.margin) y=(self.margin) width=(width) height=(height) {
                rect width=(width) height=(height) fill=(hex(palette::UNKNOWN)) {}
                use href={ "#" (layer.name()) } transform={ "matrix(" (matrix) ")" } {}
            }
        }
    }

    /// A drawing of the cells, with marks, their labels, the scale, and the axes of the map where it is turned.
    pub(super) fn draw(&self, layer: Layer, marks: &[Mark], what: &str) -> Markup {
        let size = self.drawing();
        let rectangles: Vec<Rectangle> = marks.iter().map(|mark| self.rectangle(&mark.points)).collect();
        let found = labels(&rectangles, size - Vector2::new(0.0, BELOW));
        html! {
            svg.plan viewBox={ "0 0 " (number(size.x)) " " (number(size.y)) } role="img" aria-label=(what) font-family="sans-serif" {
                (self.cells(layer))
                @for ((mark, rectangle), label) in marks.iter().zip(&rectangles).zip(&found) { (drawn(mark, rectangle, label)) }
                (self.scale_bar([self.margin, size.y - 12.0]))
                (self.axis("x", 0.0, &size)) (self.axis("y", FRAC_PI_2, &size))
            }
        }
    }

    /// The rectangle around points, in units of the drawing, wide and high enough to be seen.
    pub(super) fn rectangle(&self, points: &[Point2<f64>]) -> Rectangle {
        let [low, high] = span(&points.iter().map(|point| self.unit(point)).collect::<Vec<_>>());
        let cell = Vector2::repeat(self.mapper.frame().resolution_m() * self.scale);
        let half = (high - low + cell).sup(&Vector2::repeat(LEAST_SIDE_M * self.scale)) / 2.0;
        let middle = nalgebra::center(&low, &high);
        [middle - half, middle + half]
    }

    /// A bar of a round length.
    pub(super) fn scale_bar(&self, [x, y]: [f64; 2]) -> Markup {
        let longest = 0.3 * self.size.x * self.scale;
        let fits = SCALES_M.iter().rev().find(|length_m| *length_m * self.scale <= longest);
        let length_m = fits.copied().unwrap_or(SCALES_M[0]);
        let end = x + length_m * self.scale;
        let font = if self.margin > 0.0 { 26 } else { 18 };
        html! {
            path d={ "M" (number(x)) " " (number(y - 6.0)) "v6H" (number(end)) "v-6" } fill="none" stroke="#1b1f27" stroke-width="2.5" {}
            text x=(number(end + 7.0)) y=(number(y + 1.0)) font-size=(font) fill="#1b1f27" { (length_m) " m" }
        }
    }

    /// The direction of an axis of the map, at the lower right of a drawing.
    fn axis(&self, name: &str, angle_rad: f64, size: &Vector2<f64>) -> Markup {
        let from = Point2::new(size.x - self.margin - 30.0, size.y - 24.0);
        let along = interfaces::rotation(-self.turn_rad - angle_rad) * Vector2::x();
        let [to, text] = [22.0, 34.0].map(|length| from + along * length);
        html! {
            line x1=(number(from.x)) y1=(number(from.y)) x2=(number(to.x)) y2=(number(to.y)) stroke="#4a5160" stroke-width="2" {}
            text x=(number(text.x)) y=(number(text.y + 7.0)) font-size="22" text-anchor="middle" fill="#4a5160" { (name) }
        }
    }
}

/// The rectangle of a turned map that was seen: its lower left corner and its size, m.
fn seen(mapper: &Mapper, turn_rad: f64) -> (Point2<f64>, Vector2<f64>) {
    let (frame, rotation) = (mapper.frame(), interfaces::rotation(turn_rad));
    let points: Vec<Point2<f64>> =
        mapper.seen().map(|index| rotation * frame.center(frame.cell(index))).collect();
    let span = |of: fn(&Point2<f64>) -> f64| {
        let mut values: Vec<f64> = points.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        let tail = (TAIL * values.len() as f64) as usize;
        let at = |number: usize| values.get(number).copied().unwrap_or_default();
        [at(tail) - AROUND_M, at(values.len().saturating_sub(1 + tail)) + AROUND_M]
    };
    let [x, y] = [span(|at| at.x), span(|at| at.y)];
    (Point2::new(x[0], y[0]), Vector2::new(x[1] - x[0], y[1] - y[0]))
}

/// A point in words: in which third of the plan it lies in both directions and, in a middle third, on which side of the middle.
fn words(shares: [f64; 2]) -> String {
    let third = |share: f64| [1.0 / 3.0, 2.0 / 3.0].iter().filter(|limit| share >= **limit).count();
    let side = |share: f64, below: &'static str, above: &'static str| match share - 0.5 {
        off if off < -BESIDE => Some(below),
        off if off > BESIDE => Some(above),
        _ => None,
    };
    let (column, row) = (side(shares[0], "left of", "right of"), side(shares[1], "below", "above"));
    let [x, y] = shares.map(third);
    let (edge, side) = match (["left", "", "right"][x], ["lower", "", "upper"][y]) {
        ("", "") => return format!("{} the middle", column.or(row).unwrap_or("in")),
        ("", _) => (["bottom", "", "top"][y].to_owned(), column),
        (edge, "") => (edge.to_owned(), row),
        (x, y) => (format!("{y} {x}"), None),
    };
    side.map_or_else(|| format!("at the {edge}"), |side| format!("at the {edge} ({side} the middle)"))
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn two_doors_across_a_hall_are_not_at_the_same_place() {
        let is = |x: f64, y: f64, expected: &str| assert_eq!(words([x, y]), expected);
        is(0.5, 0.52, "in the middle");
        is(0.42, 0.45, "left of the middle");
        is(0.58, 0.45, "right of the middle");
        is(0.5, 0.6, "above the middle");
        is(0.42, 0.1, "at the bottom (left of the middle)");
        is(0.5, 0.9, "at the top");
        is(0.1, 0.4, "at the left (below the middle)");
        is(0.9, 0.5, "at the right");
        is(0.1, 0.1, "at the lower left");
        is(0.9, 0.1, "at the lower right");
        is(0.1, 0.9, "at the upper left");
        is(0.9, 0.9, "at the upper right");
    }
}
