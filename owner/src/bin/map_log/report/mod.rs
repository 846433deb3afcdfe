//! `report.html`: one file for people who look after a building, with all its pictures inside.

mod advice;
mod card;
mod labels;
mod opening;
mod plan;
mod sessions;

use crate::summary::Summary;
use draw::layers::Layer;
use draw::palette::{self, Rgb};
use interfaces::printable_lines;
use mapper::Mapper;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use nalgebra::Point2;
use owner::words::{date, length_of, list};
use plan::Plan;
use results::numbers::percent;
use survey::{Place, StillName};

const STYLE: &str = include_str!("style.css");

/// What the page is made of.
struct Page<'a> {
    summary: &'a Summary,
    mapper: &'a Mapper,
    plan: Plan<'a>,
}

/// The page.
pub(crate) fn page(summary: &Summary, mapper: &Mapper) -> String {
    let page = Page { summary, mapper, plan: Plan::whole(mapper) }.html().into_string();
    printable_lines(&page).into_owned() // names of logs and places come from outside
}

impl Page<'_> {
    fn has_rates(&self) -> bool {
        self.summary.rates_withheld.is_none()
    }

    fn html(&self) -> Markup {
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { "Where it changes: " (list(&self.summary.logs)) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    (self.plan.picture(Layer::Occupancy))
                    @if self.has_rates() { (self.plan.picture(Layer::Interval)) }
                    (self.opening())
                    (self.where_it_changes())
                    (self.sessions())
                    (self.places())
                    @if self.has_rates() { (self.how_often()) }
                    (self.doubts())
                    (self.unseen())
                    (self.about())
                }
            }
        }
    }

    fn where_it_changes(&self) -> Markup {
        let marks: Vec<_> = self.marks().into_iter().chain(self.lasting_marks()).collect();
        html! {
            h2 { "Where it changes" }
            figure {
                (self.plan.draw(Layer::Occupancy, &marks, "The plan, with the places where something changes"))
                ul.key {
                    (key(palette::BLOCKED, "wall or thing"))
                    (key(palette::MOVING, "something was here at times"))
                    (key(palette::FREE, "free"))
                    (key(palette::UNKNOWN, "never seen"))
                    @if let Some(place) = self.summary.places.iter().find(|place| !self.is_door(place)) {
                        li { span.number { (place.number) } " number of a place, described below; the rectangle is around it" }
                    }
                    @if let Some(door) = self.summary.places.iter().find(|place| self.is_door(place)) {
                        li { span.number.door { (door.number) } " number of a door" }
                    }
                    @if !self.lasting_marks().is_empty() { li { span.number.new { "A" } " came or went since the last visit" } }
                }
                figcaption { (self.turned()) }
            }
            p { (self.elsewhere()) }
            @for name in &self.summary.names_without_change { p { (still(name)) } }
        }
    }

    fn turned(&self) -> String {
        match self.plan.turn_rad.to_degrees() {
            turn_deg if turn_deg.abs() < 0.01 => "x and y are the directions of the coordinates.".to_owned(),
            turn_deg => {
                let direction = if turn_deg > 0.0 { "to the left" } else { "to the right" };
                format!(
                    "The plan is rotated {direction} by {:.0}°, so that walls are upright. x and y are the directions of the \
                     coordinates in the files.",
                    turn_deg.abs()
                )
            }
        }
    }

    /// What did not change.
    fn elsewhere(&self) -> String {
        let share = percent(1.0 - self.summary.changed_share);
        match self.summary.still_observed_s.filter(|_| self.has_rates()) {
            Some(median_s) => format!(
                "Elsewhere, nothing was seen to change: {share} of the area seen. Half of that area was in view for {} or more.",
                length_of(median_s)
            ),
            None => format!("Elsewhere, nothing was seen to change: {share} of the area seen."),
        }
    }

    fn places(&self) -> Markup {
        let more = self.summary.place_count.saturating_sub(self.summary.places.len());
        html! {
            @if !self.summary.places.is_empty() {
                h2 { "The places" }
                p {
                    "They are sorted by the lower end of the 90 % range of their rate; what is smaller than a person counts less. The numbers stay the same on later visits. Time of observation is \
                     the time for which the robot had the place in view; the robot itself is not counted. On the pictures, a blue line is a \
                     closed door, a dashed one is where it opens to, and a rectangle is around any other place. "
                    (self.clock())
                }
                div.cards { @for place in &self.summary.places { (self.card(place)) } }
            }
            @if more > 0 { p { (more) " more places with less change have no card and no number on the plan." } }
        }
    }

    /// What times count from.
    fn clock(&self) -> &'static str {
        match self.summary.begin_s {
            Some(_) => "Usual hours follow once a place is known for two weeks.",
            None if self.summary.logs.len() > 1 => {
                "The logs have no date, and the time between them is not known: times count from the first scan of each log."
            }
            None => "The log has no date: times count from the first scan.",
        }
    }

    fn how_often(&self) -> Markup {
        html! {
            h2 { "How often" }
            figure {
                (self.plan.draw(Layer::Interval, &[], "The mean time of one cycle of every cell"))
                (interval_key())
                figcaption {
                    "The mean time of one cycle of each cell: blocked, free, and blocked again. Dark: often; light: rarely. Each cell counts alone, and not \
                     the place: who passes rarely covers the same cell twice, so that traffic is light here even where its card says often. It is an \
                     estimate, also where less than a full cycle was seen; the file cell_statistics.csv has the 90 % range of every cell."
                }
            }
        }
    }

    fn unseen(&self) -> Markup {
        html! {
            h2 { "What was never seen" }
            p {
                "Nothing is known about the light blue areas of the plans. The laser sees one horizontal plane: what is above or below it, \
                 or made of clear glass, is not on the map."
            }
        }
    }

    fn about(&self) -> Markup {
        let summary = self.summary;
        html! {
            h2 { "About this map" }
            p {
                "Made from " (list(&summary.logs)) ": " (summary.scans) " scans"
                @if let Some(duration_s) = summary.duration_s { " in " (length_of(duration_s)) }
                @if let Some(begin_s) = summary.begin_s { ", from " (date(begin_s)) " on" }
                ", " (format!("{:.0}", summary.trajectory_m)) " m driven, " (format!("{:.0}", summary.seen_m2)) " m² seen. "
                @if summary.begin_s.is_some() { "Hours of people and doors: " (summary.hours) ". " }
                (percent(summary.changed_share)) " of the area changed at least once, in " (summary.place_count) " places. "
                @if summary.scans_left_out > 0 {
                    (summary.scans_left_out) " scans were left out, because their poses are uncertain."
                }
            }
            @if self.has_rates() {
                p {
                    "Passages count how often something came into the spot of half a meter where this happened most often. A 90 % range \
                     contains the true rate in 9 of 10 cases, if changes come at random. A rate is given once something came, was gone, and \
                     came again; before, only what was seen. “Between looks” means that the robot was elsewhere when it changed."
                }
            }
            @if !summary.notes.is_empty() {
                h2 { "Notes on the log" }
                ul { @for note in &summary.notes { li { (note) } } }
            }
            h2 { "Files for a robot" }
            (files(self.has_rates()))
        }
    }
}

/// The middle of a place.
fn middle(place: &Place) -> Point2<f64> {
    Point2::new(place.x_m, place.y_m)
}

/// A name of the user for what was not seen to change.
fn still(StillName { name, observed_s }: &StillName) -> String {
    match observed_s {
        Some(observed_s) => {
            format!("{}: not seen to change in {} of observation.", name.name, length_of(*observed_s))
        }
        None => format!("{}: never seen.", name.name),
    }
}

fn key(color: Rgb, meaning: &str) -> Markup {
    html! { li { svg width="16" height="16" aria-hidden="true" { rect x="1" y="1" width="14" height="14" fill=(hex(color)) stroke="#777" {} } (meaning) } }
}

fn hex([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The colors of the times of a cycle.
fn interval_key() -> Markup {
    const WIDTH: f64 = 300.0;
    const LEFT: f64 = 20.0;
    let (layer, classes) = (Layer::Interval, Layer::Interval.scale_classes());
    let step = WIDTH / classes.len() as f64;
    let scale = layer.scale();
    html! {
        svg width="340" height="38" viewBox="0 0 340 38" font-size="13" font-family="sans-serif" role="img" aria-label="From dark, often, to light, rarely" {
            @for (place, class) in classes.iter().enumerate() {
                rect x=(number(LEFT + step * place as f64)) y="0" width=(number(step + 0.5)) height="14" fill=(hex(layer.color(*class))) {}
            }
            @for tick in scale.iter().flat_map(|scale| scale.ticks.iter().map(move |tick| (*tick, scale.position(*tick)))) {
                text x=(number(LEFT + WIDTH * tick.1)) y="31" text-anchor="middle" { (tick.0) @if tick.0 >= 500.0 { " s" } }
            }
        }
    }
}

fn files(has_rates: bool) -> Markup {
    html! {
        ul {
            li { "map.yaml: the map as last seen; permanent.yaml: the map without what moves (ROS map server)" }
            @if has_rates {
                li { "speed_mask.yaml, keepout_mask.yaml: masks for the speed filter and the keepout filter of Nav2" }
                li { "cell_statistics.csv: all that was learned about every cell; things.json: doors, and objects that come and go" }
            }
            li { "trajectory.tum: the route, with times; summary.json: this page as data" }
        }
    }
}

/// A number of a drawing.
fn number(value: f64) -> String {
    format!("{}", (10.0 * value).round() / 10.0)
}
