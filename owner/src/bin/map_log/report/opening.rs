//! The first lines of the page: is the map good, where is it liveliest, how many doors.

use super::labels::Mark;
use super::{Page, middle};
use draw::layers::Layer;
use maud::{Markup, html};
use owner::words::Seen;
use survey::{Place, Verdict};

/// Half the side of the rectangle around a point in doubt, m.
const HALF_M: f64 = 0.4;

impl Page<'_> {
    /// What everyone should read.
    pub(super) fn opening(&self) -> Markup {
        let (class, words) = match (self.summary.verdict, self.summary.is_refused) {
            (Verdict::Good, _) => ("", "This map is good: what the laser saw from different places agrees."),
            (Verdict::UsableWithCare, _) => {
                ("care", "This map is usable with care: parts of it are probably wrong.")
            }
            (Verdict::NotUsable, true) => {
                ("bad", "This map is not usable: it is wrong. It has no rates and no masks.")
            }
            (Verdict::NotUsable, false) => {
                ("bad", "This map is not usable: it is wrong. It was accepted anyway.")
            }
        };
        html! {
            div class={ "opening " (class) } {
                h1 { (words) }
                @if !self.summary.verdict_reasons.is_empty() {
                    ul { @for reason in &self.summary.verdict_reasons { li { (reason) "." } } }
                    p { a href="#doubts" { "Uncertain places of the map" } }
                }
                p { (self.liveliest()) }
                p { (self.doors()) }
                @if let Some(why) = &self.summary.rates_withheld { p { strong { "No rates: " } (why) "." } }
                @if self.summary.is_interrupted {
                    p { strong { "Interrupted: " } "the maps and the numbers are of the part of the logs up to then." }
                }
            }
        }
    }

    fn liveliest(&self) -> Markup {
        let Some(place) = self.summary.places.first() else {
            return html! { "Nothing of 0.02 m² or more was seen to change." };
        };
        let is_known =
            |place: &Place| place.rates.as_ref().is_none_or(|rates| Seen::of_place(rates).is_known());
        let is_any_known = self.summary.places.iter().any(is_known);
        let begin = match (self.has_rates(), is_any_known) {
            (false, _) => "Most cells changed at ",
            (true, true) => "Most often it changes at ",
            (true, false) => "Most was seen at ",
        };
        html! {
            (begin) (self.link(place)) ", " (self.plan.words(&middle(place))) " of the plan."
            @if let Some(rates) = &place.rates { " " (self.often(place, &Seen::of_place(rates))) }
            @if self.has_rates() && !is_any_known {
                " This is a first impression: no place was observed for long enough to say how often it changes, or where it changes most."
            }
        }
    }

    fn doors(&self) -> Markup {
        let mut doors: Vec<&Place> = self.summary.places.iter().filter(|place| self.is_door(place)).collect();
        doors.sort_by_key(|door| door.number);
        if doors.is_empty() {
            return html! { "No door was seen to open or close." };
        }
        html! {
            "Doors: "
            @for (number, door) in doors.iter().enumerate() {
                @if number > 0 { "; " }
                (self.link(door)) ", " (self.plan.words(&middle(door))) " of the plan"
            }
            "."
        }
    }

    /// The uncertain places of the map.
    pub(super) fn doubts(&self) -> Markup {
        if self.summary.verdict == Verdict::Good {
            return html! {};
        }
        let doubts = self.summary.quality.iter().flat_map(|quality| &quality.doubts);
        let mark = |(number, doubt): (usize, &survey::Doubt)| {
            Mark::square(number.to_string(), [doubt.x_m, doubt.y_m], HALF_M, "doubt")
        };
        let marks: Vec<Mark> = (1..).zip(doubts).map(mark).collect();
        html! {
            h2 #doubts { "Uncertain places of the map" }
            p { "The numbers are the uncertain places, in the order of time. There, walls can be drawn twice, or in the wrong place." }
            figure { (self.plan.draw(Layer::Occupancy, &marks, "Uncertain places")) }
        }
    }
}
