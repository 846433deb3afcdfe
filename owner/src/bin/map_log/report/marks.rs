//! What is marked on a plan.

use super::labels::{Label, RADIUS, Rectangle};
use super::number;
use maud::{Markup, html};
use nalgebra::Point2;

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
