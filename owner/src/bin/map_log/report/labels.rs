//! What is marked on a plan, and where the labels are, so that they hide nothing.

use super::number;
use mapper::Segment;
use maud::{Markup, html};
use nalgebra::{Point2, Vector2};
use std::f64::consts::TAU;

/// The lowest and the highest coordinates of a rectangle of the drawing.
pub(super) type Rectangle = [Point2<f64>; 2];

/// The radius of a label.
pub(super) const RADIUS: f64 = 19.0;
/// Labels keep this distance from each other and from what they mark.
const GAP: f64 = 3.0;
/// Directions and distances at which a label is tried.
const DIRECTIONS: u32 = 24;
const DISTANCES: [f64; 12] = [8.0, 14.0, 22.0, 32.0, 44.0, 58.0, 76.0, 100.0, 130.0, 170.0, 220.0, 290.0];
/// What a label that covers only walls costs, in units of its distance.
const COVERS_ALL: f64 = 900.0;

/// A label: the middle of its circle, and where its leader line ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) at: Point2<f64>,
    pub(super) to: Point2<f64>,
}

/// Places a label beside each mark, one after the other, within a picture of this size; none where there is no room. `covered`: the
/// share of a label at a point that would hide something.
pub(super) fn labels(
    marks: &[Rectangle],
    size: Vector2<f64>,
    covered: impl Fn(&Point2<f64>) -> f64,
) -> Vec<Option<Label>> {
    let mut placed: Vec<Option<Label>> = Vec::new();
    for mark in marks {
        let is_free = |label: &Label| {
            let others = || placed.iter().flatten();
            let inside = label.at.coords.inf(&(size - label.at.coords)).min() >= RADIUS;
            inside
                && marks.iter().all(|mark| (label.at - nearest(mark, &label.at)).norm() >= RADIUS + GAP)
                && others().all(|other| (other.at - label.at).norm() >= 2.0 * RADIUS + GAP)
                && others().all(|other| is_clear(other, label) && is_clear(label, other))
        };
        let tried = beside(mark).filter(|(_, label)| is_free(label));
        let costs = tried.map(|(distance, label)| (distance + COVERS_ALL * covered(&label.at), label));
        let best = costs.min_by(|(a, _), (b, _)| a.total_cmp(b));
        placed.push(best.map(|(_, label)| label));
    }
    placed
}

/// The labels that are tried around a rectangle, with their distances from it.
fn beside(mark: &Rectangle) -> impl Iterator<Item = (f64, Label)> {
    let (middle, half) = (nalgebra::center(&mark[0], &mark[1]), (mark[1] - mark[0]) / 2.0);
    let tried = DISTANCES.iter().flat_map(|distance| (0..DIRECTIONS).map(move |number| (*distance, number)));
    tried.map(move |(distance, number)| {
        let along = interfaces::rotation(-TAU * f64::from(number) / f64::from(DIRECTIONS)) * Vector2::x();
        let at = middle + along.component_mul(&half.add_scalar(RADIUS + distance));
        (distance, Label { at, to: nearest(mark, &at) })
    })
}

/// The point of a rectangle that is nearest to another one.
fn nearest([low, high]: &Rectangle, at: &Point2<f64>) -> Point2<f64> {
    at.sup(low).inf(high)
}

/// Whether the leader line of a label does not go through the circle of another one.
fn is_clear(line: &Label, circle: &Label) -> bool {
    Segment { ends: [line.at, line.to] }.distance_m(&circle.at) >= RADIUS + GAP
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
pub(super) fn drawn(mark: &Mark, rectangle: &Rectangle, label: Option<&Label>) -> Markup {
    let font = if mark.label.len() > 2 { 20 } else { 25 };
    let circle = |label: &Label| {
        html! {
            circle cx=(number(label.at.x)) cy=(number(label.at.y)) r=(RADIUS - 0.5) fill="currentColor" stroke="#fff" {}
            text x=(number(label.at.x)) y=(number(label.at.y + 0.36 * f64::from(font))) font-size=(font) font-weight="bold" text-anchor="middle" fill="#fff" { (mark.label) }
        }
    };
    html! {
        g.mark.(mark.class) stroke-width="1.6" {
            (outline(rectangle))
            @if let Some(label) = label {
                line x1=(number(label.at.x)) y1=(number(label.at.y)) x2=(number(label.to.x)) y2=(number(label.to.y)) stroke="currentColor" {}
                @if let Some(link) = &mark.link { a href=(link) { (circle(label)) } } @else { (circle(label)) }
            }
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

    #[test]
    fn labels_hide_neither_marks_nor_each_other() {
        // A row of marks that touch each other, as along a corridor.
        let mark = |number: u32| rectangle(100.0 + 30.0 * f64::from(number), 200.0, 28.0, 15.0);
        let marks: Vec<Rectangle> = (0..12).map(mark).collect();
        let found = labels(&marks, Vector2::new(700.0, 400.0), |_| 0.0);
        let placed: Vec<Label> = found.iter().flatten().copied().collect();
        assert_eq!(placed.len(), marks.len());
        for (number, label) in placed.iter().enumerate() {
            let far = |mark: &Rectangle| (label.at - nearest(mark, &label.at)).norm();
            assert!(marks.iter().all(|mark| far(mark) >= RADIUS), "{label:?}");
            assert_eq!(label.to, nearest(&marks[number], &label.to), "the line ends at its mark");
            let mut before = placed[..number].iter();
            assert!(before.all(|other| (other.at - label.at).norm() >= 2.0 * RADIUS), "{label:?}");
        }
    }

    #[test]
    fn a_label_avoids_what_it_would_hide_and_needs_room() {
        let wall_above = |at: &Point2<f64>| f64::from(u8::from(at.y < 200.0));
        let found = labels(&[rectangle(100.0, 200.0, 10.0, 10.0)], Vector2::repeat(300.0), wall_above);
        assert!(found[0].unwrap().at.y > 200.0, "{found:?}");
        assert_eq!(labels(&[rectangle(0.0, 0.0, 20.0, 20.0)], Vector2::repeat(20.0), |_| 0.0), [None]);
    }
}
