//! What is marked on a plan, and where the labels are.

use super::number;
use maud::{Markup, html};
use nalgebra::{Point2, Vector2, distance};

/// The lowest and the highest coordinates of a rectangle of the drawing.
pub(super) type Rectangle = [Point2<f64>; 2];

/// The radius of a label.
const RADIUS: f64 = 19.0;
/// The distances of a label from what it marks that are tried, and the directions: first below, in the drawing.
const DISTANCES: [f64; 8] = [3.0, 12.0, 24.0, 40.0, 65.0, 100.0, 160.0, 260.0];
const DIRECTIONS: [[f64; 2]; 8] =
    [[0.0, 1.0], [0.0, -1.0], [1.0, 0.0], [-1.0, 0.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];

/// The middles of the labels of marks: the first place near a mark that is inside a picture of this size and touches no mark and no
/// label before it; below the mark if there is none.
pub(super) fn labels(marks: &[Rectangle], size: Vector2<f64>) -> Vec<Point2<f64>> {
    let mut placed: Vec<Point2<f64>> = Vec::new();
    for [low, high] in marks {
        let (middle, half) = (nalgebra::center(low, high), (high - low) / 2.0);
        let beside = |away: f64, direction: [f64; 2]| {
            middle + Vector2::from(direction).component_mul(&half.add_scalar(RADIUS + away))
        };
        let is_free = |at: &Point2<f64>| {
            at.coords.inf(&(size - at.coords)).min() >= RADIUS
                && marks.iter().all(|mark| distance(&nearest(mark, at), at) >= RADIUS)
                && placed.iter().all(|other| distance(other, at) >= 2.0 * RADIUS)
        };
        let mut tried = DISTANCES.iter().flat_map(|away| DIRECTIONS.map(|it| beside(*away, it)));
        placed.push(tried.find(is_free).unwrap_or_else(|| beside(DISTANCES[0], DIRECTIONS[0])));
    }
    placed
}

/// The point of a rectangle that is nearest to another one.
fn nearest([low, high]: &Rectangle, at: &Point2<f64>) -> Point2<f64> {
    at.sup(low).inf(high)
}

/// A mark on a plan.
pub(super) struct Mark {
    pub(super) label: String,
    /// The part of the page that tells more.
    pub(super) link: Option<String>,
    /// What it marks, m: the rectangle around these points.
    pub(super) points: Vec<Point2<f64>>,
    /// The class that gives its color, as in the style of the page: a place, a `door`, something `new`, a `doubt`.
    pub(super) class: &'static str,
}

impl Mark {
    /// A mark on a square around a point, of twice this side.
    pub(super) fn square(label: String, at: [f64; 2], half_m: f64, class: &'static str) -> Self {
        let (at, half) = (Point2::from(at), Vector2::repeat(half_m));
        Self { label, link: None, points: vec![at - half, at + half], class }
    }
}

/// A mark with its label beside it.
pub(super) fn drawn(mark: &Mark, rectangle: &Rectangle, label: &Point2<f64>) -> Markup {
    let font = if mark.label.len() > 2 { 20 } else { 25 };
    let circle = html! {
        circle cx=(number(label.x)) cy=(number(label.y)) r=(RADIUS - 0.5) fill="currentColor" stroke="#fff" {}
        text x=(number(label.x)) y=(number(label.y + 0.36 * f64::from(font))) font-size=(font) font-weight="bold" text-anchor="middle" fill="#fff" { (mark.label) }
    };
    let to = nearest(rectangle, label);
    html! {
        g.mark.(mark.class) stroke-width="1.6" {
            (outline(rectangle))
            line x1=(number(label.x)) y1=(number(label.y)) x2=(number(to.x)) y2=(number(to.y)) stroke="currentColor" {}
            @if let Some(link) = &mark.link { a href=(link) { (circle) } } @else { (circle) }
        }
    }
}

/// A rectangle of the drawing.
pub(super) fn outline([low, high]: &Rectangle) -> Markup {
    html! { rect x=(number(low.x)) y=(number(low.y)) width=(number(high.x - low.x)) height=(number(high.y - low.y)) fill="none" stroke="currentColor" {} }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Rectangle {
        [Point2::new(x, y), Point2::new(x + width, y + height)]
    }

    /// No label hides a mark or another label.
    fn check(marks: &[Rectangle], placed: &[Point2<f64>]) {
        assert_eq!(placed.len(), marks.len());
        for (number, label) in placed.iter().enumerate() {
            assert!(marks.iter().all(|mark| distance(&nearest(mark, label), label) >= RADIUS), "{label:?}");
            let mut before = placed[..number].iter();
            assert!(before.all(|other| distance(other, label) >= 2.0 * RADIUS), "{label:?}");
        }
    }

    #[test]
    fn labels_hide_neither_marks_nor_each_other() {
        // A row of marks that touch each other, as along a corridor, and a heap of marks.
        let row: Vec<Rectangle> =
            (0..12).map(|number| rectangle(100.0 + 30.0 * f64::from(number), 200.0, 28.0, 15.0)).collect();
        check(&row, &labels(&row, Vector2::new(700.0, 400.0)));
        let heap: Vec<Rectangle> = (0..20)
            .map(|number| {
                rectangle(300.0 + f64::from(number % 5 * 17), 300.0 + f64::from(number % 3 * 23), 40.0, 30.0)
            })
            .collect();
        check(&heap, &labels(&heap, Vector2::repeat(700.0)));
    }

    #[test]
    fn labels_give_way_to_the_border_and_every_mark_has_one() {
        let at_the_bottom = labels(&[rectangle(100.0, 280.0, 10.0, 10.0)], Vector2::repeat(300.0));
        assert_eq!(at_the_bottom, [Point2::new(105.0, 258.0)]);
        let marks = [rectangle(10.0, 10.0, 5.0, 5.0); 9];
        assert_eq!(labels(&marks, Vector2::repeat(30.0)).len(), marks.len());
    }
}
