//! The plan of the place: turned so that its walls are upright, and parts of it.

use super::labels::{Box4, labels};
use super::marks::{Mark, drawn};
use super::number;
use super::raster::Cells;
use draw::layers::{BLOCKED, FREE, Layer, UNKNOWN};
use draw::palette;
use mapper::Mapper;
use maud::{Markup, html};
use nalgebra::{Point2, Vector2};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use survey::upright_rad;

/// The share of the plan from which on a point is beside its middle.
const BESIDE: f64 = 0.05;
/// The width of a whole plan in units of its drawing: labels are legible on a telephone.
const WIDTH: f64 = 720.0;
/// The space around the map, for labels, and that below it, for the scale.
const MARGIN: f64 = 48.0;
const BELOW: f64 = 38.0;
/// The largest number of pixels along the longer side of the picture of the cells.
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
    turn_rad: f64,
    /// Its lower left corner and its size in the turned frame, m.
    low: Point2<f64>,
    size: Vector2<f64>,
    /// Units of the drawing per meter, and the space around the map in units.
    scale: f64,
    margin: f64,
}

/// What is drawn of the cells.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Shown {
    /// Walls, and what changed.
    Places,
    /// The time of a cycle.
    Interval,
}

impl<'a> Plan<'a> {
    /// The plan of all that was seen.
    pub(super) fn whole(mapper: &'a Mapper) -> Self {
        let upright = upright_rad(mapper);
        let plan = Self {
            mapper,
            turn_rad: upright,
            low: Point2::origin(),
            size: Vector2::zeros(),
            scale: 1.0,
            margin: MARGIN,
        };
        let (mut low, mut size) = plan.seen();
        let mut turn_rad = upright;
        if size.x > WIDE * size.y {
            turn_rad += FRAC_PI_2;
            (low, size) = (Point2::new(-low.y - size.y, low.x), Vector2::new(size.y, size.x));
        }
        let scale = (WIDTH - 2.0 * MARGIN) / size.x;
        Self { turn_rad, low, size, scale, ..plan }
    }

    /// The square of this side around a point, m.
    pub(super) fn around(&self, at: &Point2<f64>, side_m: f64) -> Self {
        let size = Vector2::repeat(side_m);
        Self { low: self.turned(at) - size / 2.0, size, scale: 300.0 / side_m, margin: 0.0, ..*self }
    }

    /// The rectangle of the turned map that was seen.
    fn seen(&self) -> (Point2<f64>, Vector2<f64>) {
        let frame = self.mapper.frame();
        let seen = (0..frame.len()).filter(|index| self.mapper.was_ever_seen(*index));
        let points: Vec<Point2<f64>> =
            seen.map(|index| self.turned(&frame.center(frame.cell(index)))).collect();
        let span = |of: fn(&Point2<f64>) -> f64| {
            let mut values: Vec<f64> = points.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            let tail = (TAIL * values.len() as f64) as usize;
            let at = |number: usize| values.get(number).copied().unwrap_or_default();
            [at(tail), at(values.len().saturating_sub(1 + tail))]
        };
        let [x, y] = [span(|at| at.x), span(|at| at.y)];
        let low = Point2::new(x[0] - AROUND_M, y[0] - AROUND_M);
        (low, Vector2::new(x[1] - x[0] + 2.0 * AROUND_M, y[1] - y[0] + 2.0 * AROUND_M))
    }

    fn turned(&self, at: &Point2<f64>) -> Point2<f64> {
        interfaces::rotation(self.turn_rad) * at
    }

    /// The angle by which the map is turned counter-clockwise, degrees.
    pub(super) fn turn_deg(&self) -> f64 {
        self.turn_rad.to_degrees()
    }

    /// A point of the map in units of the drawing.
    pub(super) fn unit(&self, at: &Point2<f64>) -> [f64; 2] {
        let from = self.turned(at) - self.low;
        [self.margin + self.scale * from.x, self.margin + self.scale * (self.size.y - from.y)]
    }

    /// Where a point is on the plan, in words.
    pub(super) fn words(&self, at: &Point2<f64>) -> String {
        let from = self.turned(at) - self.low;
        words([from.x / self.size.x, from.y / self.size.y])
    }

    /// A heading on the plan, in words.
    pub(super) fn towards(&self, heading_rad: f64) -> &'static str {
        const WORDS: [&str; 8] = [
            "right",
            "up to the right",
            "up",
            "up to the left",
            "left",
            "down to the left",
            "down",
            "down to the right",
        ];
        let eighths = ((heading_rad + self.turn_rad) / FRAC_PI_4).round();
        WORDS[eighths.rem_euclid(8.0) as usize]
    }

    /// The size of the drawing, in units.
    pub(super) fn drawing(&self) -> [f64; 2] {
        let below = if self.margin > 0.0 { BELOW } else { 0.0 };
        [2.0 * self.margin + self.scale * self.size.x, 2.0 * self.margin + self.scale * self.size.y + below]
    }

    fn cells(&self, shown: Shown) -> Cells {
        let layer = if shown == Shown::Places { Layer::Occupancy } else { Layer::Interval };
        let mut classes = layer.classes(self.mapper);
        let mut colors: Vec<palette::Rgb> = (0..CHANGED).map(|class| layer.color(class)).collect();
        colors.push(palette::MOVING);
        if shown == Shown::Places {
            let changed = self.mapper.changed().filter(|index| self.mapper.rate(*index) > 0.0);
            changed.for_each(|index| classes.cells_mut()[index] = CHANGED);
        }
        let rank = |class: u8| match class {
            ..=UNKNOWN => 0,
            FREE => 1,
            BLOCKED => 2,
            class => u8::MAX - class, // short intervals first
        };
        Cells { classes, colors, rank, outside: UNKNOWN }
    }

    /// The cells as an element of a drawing.
    pub(super) fn image(&self, shown: Shown) -> Markup {
        let longest_m = self.size.x.max(self.size.y);
        let pixel_m = (longest_m / MAX_PIXELS).max(self.mapper.frame().resolution_m() / 2.0);
        let pixels = [self.size.x, self.size.y].map(|length_m| (length_m / pixel_m).ceil().max(1.0));
        let (low, high_y, back) = (self.low, self.low.y + self.size.y, interfaces::rotation(-self.turn_rad));
        let at = |x: f64, y: f64| back * Point2::new(low.x + x * pixel_m, high_y - y * pixel_m);
        let address = self.cells(shown).address(pixels.map(|count| count as u32), pixel_m, at);
        let [width, height] = pixels.map(|count| number(count * pixel_m * self.scale));
        html! { image x=(number(self.margin)) y=(number(self.margin)) width=(width) height=(height) href=(address) preserveAspectRatio="none" {} }
    }

    /// A drawing of the cells, with marks, their labels, the scale, and the axes of the map where it is turned.
    pub(super) fn draw(&self, shown: Shown, marks: &[Mark], what: &str) -> Markup {
        let [width, height] = self.drawing();
        let boxes: Vec<Box4> = marks.iter().map(|mark| self.visible(&mark.points)).collect();
        let found = labels(&boxes, [width, height - BELOW], |at, radius| self.covered(at, radius));
        html! {
            svg.plan viewBox={ "0 0 " (number(width)) " " (number(height)) } role="img" aria-label=(what) font-family="sans-serif" {
                (self.image(shown))
                @for ((mark, rectangle), label) in marks.iter().zip(&boxes).zip(&found) { (drawn(mark, rectangle, label.as_ref())) }
                (self.scale_bar([self.margin, height - 12.0]))
                (self.axes([width - self.margin - 30.0, height - 24.0]))
            }
        }
    }

    /// The rectangle around points, in units of the drawing.
    pub(super) fn rectangle(&self, points: &[Point2<f64>]) -> Box4 {
        let half = self.mapper.frame().resolution_m() / 2.0 * self.scale;
        let mut around = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for [x, y] in points.iter().map(|point| self.unit(point)) {
            around = [
                around[0].min(x - half),
                around[1].min(y - half),
                around[2].max(x + half),
                around[3].max(y + half),
            ];
        }
        around
    }

    /// The rectangle around points, wide and high enough to be seen.
    pub(super) fn visible(&self, points: &[Point2<f64>]) -> Box4 {
        let [left, top, right, bottom] = self.rectangle(points);
        let missing = |side: f64| ((LEAST_SIDE_M * self.scale - side) / 2.0).max(0.0);
        let [x, y] = [missing(right - left), missing(bottom - top)];
        [left - x, top - y, right + x, bottom + y]
    }

    /// The share of a circle of the drawing under which something blocks or changes.
    fn covered(&self, at: [f64; 2], radius: f64) -> f64 {
        const STEPS: i32 = 4;
        let frame = self.mapper.frame();
        let back = interfaces::rotation(-self.turn_rad);
        let (mut all, mut full) = (0.0, 0.0);
        for (x, y) in (-STEPS..=STEPS).flat_map(|y| (-STEPS..=STEPS).map(move |x| (x, y))) {
            let offset = [x, y].map(|step| f64::from(step) / f64::from(STEPS));
            if offset[0] * offset[0] + offset[1] * offset[1] > 1.0 {
                continue;
            }
            let [x, y] = [at[0] + radius * offset[0], at[1] + radius * offset[1]];
            let from = Vector2::new(x - self.margin, self.margin - y) / self.scale;
            let point = back * (self.low + from + Vector2::new(0.0, self.size.y));
            let index = frame.index(frame.cell_at(&point));
            all += 1.0;
            full += index.map_or(0.0, |index| {
                let is_full = self.mapper.states().cells()[index] == interfaces::CellState::Blocked;
                if is_full || self.mapper.rate(index) > 0.0 {
                    1.0
                } else if self.mapper.was_ever_seen(index) {
                    0.05
                } else {
                    0.0
                }
            });
        }
        full / all
    }

    /// A bar of a round length.
    pub(super) fn scale_bar(&self, [x, y]: [f64; 2]) -> Markup {
        let longest = 0.3 * (self.drawing()[0] - 2.0 * self.margin);
        let fits = SCALES_M.iter().rev().find(|length_m| *length_m * self.scale <= longest);
        let length_m = fits.copied().unwrap_or(SCALES_M[0]);
        let end = x + length_m * self.scale;
        let font = if self.margin > 0.0 { 26 } else { 18 };
        html! {
            path d={ "M" (number(x)) " " (number(y - 6.0)) "v6H" (number(end)) "v-6" } fill="none" stroke="#1b1f27" stroke-width="2.5" {}
            text x=(number(end + 7.0)) y=(number(y + 1.0)) font-size=(font) fill="#1b1f27" { (length_m) " m" }
        }
    }

    /// The directions of x and y of the map.
    fn axes(&self, [x, y]: [f64; 2]) -> Markup {
        let arrow = |name: &str, angle_rad: f64| {
            let (sin, cos) = libm::sincos(self.turn_rad + angle_rad);
            let [to, text] = [22.0, 34.0].map(|length| [x + length * cos, y - length * sin]);
            html! {
                line x1=(number(x)) y1=(number(y)) x2=(number(to[0])) y2=(number(to[1])) stroke="#4a5160" stroke-width="2" {}
                text x=(number(text[0])) y=(number(text[1] + 7.0)) font-size="22" text-anchor="middle" fill="#4a5160" { (name) }
            }
        };
        html! { (arrow("x", 0.0)) (arrow("y", FRAC_PI_2)) }
    }
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
    let (edge, side) = match shares.map(third) {
        [1, 1] => return format!("{} the middle", column.or(row).unwrap_or("in")),
        [0, 0] => ("at the lower left", None),
        [2, 0] => ("at the lower right", None),
        [0, 2] => ("at the upper left", None),
        [2, 2] => ("at the upper right", None),
        [_, 0] => ("at the bottom", column),
        [_, 2] => ("at the top", column),
        [0, _] => ("at the left", row),
        _ => ("at the right", row),
    };
    side.map_or_else(|| edge.to_owned(), |side| format!("{edge} ({side} the middle)"))
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
