//! `report.html`: a page for people who look after a building.

use crate::summary::Summary;
use curious::week;
use curious::words::{date, how_often, length_of, list, range};
use mapper::{Door, Mapper, Week};
use maud::{DOCTYPE, Markup, html};
use nalgebra::Point2;
use results::numbers::percent;
use survey::{Place, Verdict};

const STYLE: &str = "body{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}\
table{border-collapse:collapse}td,th{padding:.3em .8em;border-bottom:1px solid #ccc;text-align:right}\
td:first-child,th:first-child{text-align:left}img{max-width:100%;height:auto}figcaption{color:#555}\
.good,.care,.bad{padding:.5em 1em;border-left:.5em solid #2a7}.care{border-color:#e90;background:#fff8e8}\
.bad{border-color:#c00;background:#fdecec}";

/// The page.
pub(crate) fn page(summary: &Summary, mapper: &Mapper) -> String {
    let has_rates = summary.rates_withheld.is_none();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { "Where it changes: " (list(&summary.logs)) }
                style { (STYLE) }
            }
            body {
                h1 { "Where it changes, and how often" }
                @if summary.is_interrupted {
                    p { strong { "Interrupted: " } "the maps and the numbers are of the part of the logs up to then." }
                }
                (verdict(summary))
                (overview(summary))
                @if let Some(why) = &summary.rates_withheld { p { strong { "No rates: " } (why) "." } }
                h2 { "Where" }
                (picture("places.png", "Pink: cells that changed while the robot looked or between two looks, drawn twice as \
                                        large as they are. The numbers are those of the table. Light blue: never seen."))
                (table(&summary.places, summary.begin_s, has_rates))
                @if summary.place_count > summary.places.len() {
                    p { (summary.place_count - summary.places.len()) " more places with less change are in the pictures." }
                }
                @if has_rates {
                    (doors(mapper))
                    (weeks(&summary.places, mapper))
                    h2 { "How often" }
                    (picture("interval.png", "The mean time of one cycle: blocked, free, and blocked again. Dark: often."))
                    h2 { "When last seen" }
                    (picture("recency.png", "The time between the last look at a cell and the end of the log."))
                    h2 { "How sure" }
                    p {
                        "Rates are estimated from what the robot saw. The table gives the range that contains the true rate with \
                         90 % probability, if changes come at random. Where the robot looked for a short time only, the range is \
                         wide. A cell without a change can still change: the file cell_statistics.csv has the range of every cell."
                    }
                }
                h2 { "What was never seen" }
                p {
                    "The light blue areas of the maps. Nothing is known about them. The laser sees one horizontal plane: what is above \
                     or below it, or made of clear glass, is not in the map."
                }
                (picture("trajectory.png", "The route of the robot."))
                @if !summary.notes.is_empty() {
                    h2 { "Notes on the log" }
                    ul { @for note in &summary.notes { li { (note) } } }
                }
                h2 { "Files for a robot" }
                (files(has_rates))
            }
        }
    };
    page.into_string()
}

/// Whether the map is right, before anything else.
fn verdict(summary: &Summary) -> Markup {
    let (class, words) = match (summary.verdict, summary.is_refused) {
        (Verdict::Good, _) => ("good", "This map is good: its scans agree with each other."),
        (Verdict::UsableWithCare, _) => {
            ("care", "This map is usable with care: parts of it are probably wrong.")
        }
        (Verdict::NotUsable, true) => {
            ("bad", "This map is not usable: it is wrong. It has no rates and no masks.")
        }
        (Verdict::NotUsable, false) => {
            ("bad", "This map is not usable: it is wrong. It was accepted all the same.")
        }
    };
    html! {
        div class=(class) {
            strong { (words) }
            @if !summary.verdict_reasons.is_empty() {
                ul { @for reason in &summary.verdict_reasons { li { (reason) "." } } }
                p { "The numbers in the picture are the places in doubt, in the order of time." }
                (picture("doubts.png", "Places in doubt."))
            }
        }
    }
}

fn overview(summary: &Summary) -> Markup {
    html! {
        p {
            (summary.scans) " scans"
            @if let Some(duration_s) = summary.duration_s { " in " (length_of(duration_s)) }
            @if let Some(begin_s) = summary.begin_s { ", from " (date(begin_s)) " on" }
            ", " (format!("{:.0}", summary.trajectory_m)) " m travelled, "
            (format!("{:.0}", summary.seen_m2)) " m² seen. Hours of people and doors: " (summary.hours) ". "
            (percent(summary.changed_share)) " of this area changed at least once, in " (summary.place_count) " places. "
            @if summary.scans_left_out > 0 {
                (summary.scans_left_out) " scans were left out, because it is not certain from where they were taken."
            }
        }
    }
}

fn table(places: &[Place], begin_s: Option<f64>, has_rates: bool) -> Markup {
    if places.is_empty() {
        return html! { p { "No area of 0.02 m² or more changed where the robot looked." } };
    }
    html! {
        table {
            tr {
                th { "place" } th { "at (m)" } th { "area" } th { "most changes of a cell" }
                @if has_rates {
                    th { "how often" } th { "90 % range" } th { "blocked" } th { "looked at for" } th { @if begin_s.is_some() { "last change" } @else { "last change, after the begin" } }
                }
            }
            @for (number, place) in (1..).zip(places) {
                tr {
                    td { (number) }
                    td { (format!("{:.1}, {:.1}", place.x_m, place.y_m)) }
                    td { (format!("{:.2} m²", place.area_m2)) }
                    td { (place.changes) }
                    @if let Some(rates) = &place.rates {
                        td { (how_often(place.changes, rates)) }
                        td { (range(rates)) }
                        td { (percent(rates.share_blocked)) " of the time" }
                        td { (length_of(rates.observed_s)) }
                        td { (begin_s.map_or_else(|| length_of(rates.last_change_s), |begin_s| date(begin_s + rates.last_change_s))) }
                    }
                }
            }
        }
    }
}

/// The doors that were found.
fn doors(mapper: &Mapper) -> Markup {
    let doors: Vec<(u32, &Door)> = survey::doors(mapper).collect();
    let ends = |door: &Door| door.closed.ends.map(|end| format!("{:.1}, {:.1}", end.x, end.y)).join(" to ");
    html! {
        @if !doors.is_empty() {
            h2 { "Doors" }
            table {
                tr { th { "door" } th { "closed, from and to (m)" } th { "openings per hour" } th { "90 % range" } th { "last seen" } }
                @for (id, door) in &doors {
                    @let seen = &door.statistics;
                    tr {
                        td { (id) }
                        td { (ends(door)) }
                        td { (seen.openings_per_hour().map_or_else(String::new, |rate| format!("{:.1}", rate.mean()))) }
                        td { (seen.interval_of_openings_per_hour(0.9).map_or_else(String::new, |(low, high)| format!("{low:.1} to {high:.1}"))) }
                        td { (door.is_open.map_or("", |is_open| if is_open { "open" } else { "closed" })) }
                    }
                }
            }
            @for (id, door) in &doors {
                @if let Some(week) = door.clock.week(mapper.calendar()) { (week_of(&format!("Door {id}"), &week, "open")) }
            }
        }
    }
}

/// The usual weeks of the places that are known for two weeks.
fn weeks(places: &[Place], mapper: &Mapper) -> Markup {
    let frame = mapper.frame();
    let week = |place: &Place| {
        let index = frame.index(frame.cell_at(&Point2::new(place.x_m, place.y_m)))?;
        mapper.tile(index)?.clock().week(mapper.calendar())
    };
    let weeks: Vec<_> = (1..)
        .zip(places)
        .filter_map(|(number, place)| Some((number, week(place)?)))
        .collect::<Vec<(usize, Week)>>();
    html! {
        @if !weeks.is_empty() {
            h2 { "Usual weeks" }
            @for (number, week) in &weeks { (week_of(&format!("Place {number}"), week, "blocked")) }
        }
    }
}

fn week_of(title: &str, week: &Week, state: &str) -> Markup {
    html! { figure { (week::picture(week, state)) figcaption { (title) ": usually " (week::usual_hours(week, state)) "." } } }
}

fn files(has_rates: bool) -> Markup {
    html! {
        ul {
            li { "map.yaml: the map as last seen; permanent.yaml: the map without what moves (ROS map server)" }
            @if has_rates {
                li { "speed_mask.yaml, keepout_mask.yaml: masks for the speed filter and the keepout filter of Nav2" }
                li { "cell_statistics.csv, layers.npy: all that was learned about every cell; things.json: doors, and furniture that was moved" }
            }
            li { "trajectory.tum: the route, with times; summary.json: this page as data" }
        }
    }
}

fn picture(file: &str, caption: &str) -> Markup {
    html! { figure { img src=(file) alt=(caption); figcaption { (caption) } } }
}
