//! What is marked on a plan.

use super::labels::{Box4, Label, RADIUS};
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
    pub(super) kind: MarkKind,
}

/// What a mark marks.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum MarkKind {
    Place,
    Door,
    /// Something that came or went since the last visit.
    New,
    /// Where the map is in doubt.
    Doubt,
}

impl MarkKind {
    /// The color, as in the style of the page.
    fn color(self) -> &'static str {
        match self {
            Self::Place => "#0072b2",
            Self::Door => "#00745a",
            Self::New => "#b3429a",
            Self::Doubt => "#c00000",
        }
    }
}

/// A mark with its label beside it.
pub(super) fn drawn(mark: &Mark, rectangle: &Box4, label: Option<&Label>) -> Markup {
    let [left, top, right, bottom] = *rectangle;
    let color = mark.kind.color();
    let font = if mark.label.len() > 2 { 20 } else { 25 };
    let circle = |label: &Label| {
        html! {
            circle cx=(number(label.at[0])) cy=(number(label.at[1])) r=(RADIUS - 0.5) fill=(color) stroke="#fff" {}
            text x=(number(label.at[0])) y=(number(label.at[1] + 0.36 * f64::from(font))) font-size=(font) font-weight="bold" text-anchor="middle" fill="#fff" { (mark.label) }
        }
    };
    html! {
        rect x=(number(left)) y=(number(top)) width=(number(right - left)) height=(number(bottom - top)) fill="none" stroke=(color) stroke-width="1.6" {}
        @if let Some(label) = label {
            line x1=(number(label.at[0])) y1=(number(label.at[1])) x2=(number(label.to[0])) y2=(number(label.to[1])) stroke=(color) stroke-width="1.6" {}
            @if let Some(link) = &mark.link { a href=(link) { (circle(label)) } } @else { (circle(label)) }
        }
    }
}
