//! A card for each place.

use super::advice::advice;
use super::labels::{Mark, outline};
use super::plan::Plan;
use super::{Page, middle, number};
use draw::layers::Layer;
use mapper::{Clock, Door, Leaf, Week};
use maud::{Markup, html};
use nalgebra::Point2;
use owner::week;
use owner::words::{Seen, changed, date, length_of, range, rate, short, times};
use survey::{Place, PlaceKind, is_line};

/// The side of the picture of a place, m.
const SIDE_M: f64 = 6.0;
/// What was looked at for this time, s, has an upper bound that says something.
const LONG_S: f64 = 600.0;

impl Page<'_> {
    /// The card of a place.
    pub(super) fn card(&self, place: &Place) -> Markup {
        let week = self.week(place);
        html! {
            article.card id={ "place-" (place.number) } {
                h3 { span class={ "number " (if self.door(place).is_some() { "door" } else { "" }) } { (place.number) } " " (self.title(place)) }
                (self.surroundings(place))
                dl {
                    dt { "What it looks like" } dd { (self.looks(place)) }
                    @if let Some(rates) = &place.rates {
                        @let seen = Seen::of_place(rates);
                        dt { "How often" } dd { (self.often(place, &seen)) }
                        dt { "When" } dd {
                            p { "Last change: " (self.time(rates.last_change_s)) "." }
                            @if let Some(week) = &week { (week_of(week, if self.is_door(place) { "open" } else { "blocked" })) }
                            @else if let Some(days) = self.few_days(place) { p { (days) } }
                        }
                        dt { "How sure" } dd { (sure(&seen)) }
                        dt { "What to do" } dd {
                            @for (who, what) in advice(place.kind, &seen, rates.share_blocked, week.is_some(), is_line(self.mapper, &place.cells)) { p { em { (who) ": " } (what) } }
                        }
                    } @else {
                        dt { "How often" } dd { "A cell changed " (times(place.changes)) ". No rate can be given." }
                    }
                }
                p.where { "In the files: x " (format!("{:.1}", place.x_m)) " m, y " (format!("{:.1}", place.y_m)) " m, " (format!("{:.2}", place.area_m2)) " m²." }
            }
        }
    }

    /// The name of a place, or what it is.
    pub(super) fn title(&self, place: &Place) -> String {
        let kind = match place.kind {
            PlaceKind::Door { .. } => "door",
            PlaceKind::Object { .. } => "object that comes and goes",
            PlaceKind::Traffic => "traffic",
            PlaceKind::Unknown => "something that changes",
        };
        place.name.as_ref().map_or_else(|| kind.to_owned(), |name| format!("{name} ({kind})"))
    }

    /// A place as a link to its card.
    pub(super) fn link(&self, place: &Place) -> Markup {
        let name = place.name.as_ref().map(|name| format!(" ({name})")).unwrap_or_default();
        html! { a href={ "#place-" (place.number) } { "place " (place.number) (name) } }
    }

    /// Whether a place is a door.
    pub(super) fn is_door(&self, place: &Place) -> bool {
        matches!(place.kind, PlaceKind::Door { .. })
    }

    /// The door of a place, if it is one.
    pub(super) fn door(&self, place: &Place) -> Option<&Door> {
        let PlaceKind::Door { thing } = place.kind else { return None };
        self.mapper.doors().iter().find(|door| door.id == thing)
    }

    /// What is usual in a week, once it is known.
    fn week(&self, place: &Place) -> Option<Week> {
        self.clock_of(place)?.week(self.mapper.calendar())
    }

    /// Why there are no usual hours yet; `None` where nothing has hours, or where they are known.
    fn few_days(&self, place: &Place) -> Option<String> {
        self.summary.begin_s?;
        let days = self.clock_of(place)?.days();
        let seen = if days == 1 { "one day".to_owned() } else { format!("{days} days") };
        (1..Week::MIN_DAYS).contains(&days).then(|| {
            format!(
                "Usual hours are not known yet: the robot looked on {seen}, and {} are needed.",
                Week::MIN_DAYS
            )
        })
    }

    /// The clock of a door, or of the tile in the middle of another place.
    fn clock_of(&self, place: &Place) -> Option<&Clock> {
        if let Some(door) = self.door(place) {
            return Some(&door.clock);
        }
        let frame = self.mapper.frame();
        Some(self.mapper.tile(frame.index(frame.cell_at(&middle(place)))?)?.clock())
    }

    fn looks(&self, place: &Place) -> String {
        if let Some(door) = self.door(place) {
            let length = short(door.closed.length_m());
            let state = if door.is_open() { "open" } else { "closed" };
            let motion = match door.leaf {
                Leaf::Hinged { .. } => "sweeps about one end",
                Leaf::Sliding => "comes and goes. It slides, or opens out of sight",
            };
            return format!("A door: a line of {length} m {motion}. It was {state} when it was last seen.");
        }
        match place.kind {
            PlaceKind::Object { thing } => {
                let object = self.mapper.objects().find(|object| object.id == thing);
                let state = object.map_or("", |object| if object.is_there { "there" } else { "away" });
                format!("An object that comes and goes as a whole. It was {state} when it was last seen.")
            }
            PlaceKind::Traffic => {
                "Traffic: something comes again and again, and is gone within half a minute. People, carts or robots.".to_owned()
            }
            _ if is_line(self.mapper, &place.cells) => "Not known: a thin line that was there at times. It can be a door that moved too rarely \
                 to be recognized, or a part of a wall that was seen a few centimeters beside its place."
                .to_owned(),
            _ => "Not known: something came or went here, and it is neither a door nor traffic.".to_owned(),
        }
    }

    pub(super) fn often(&self, place: &Place, seen: &Seen) -> String {
        let (does, did) = match place.kind {
            PlaceKind::Door { .. } => ("It opens", "It opened"),
            PlaceKind::Traffic => ("Something passes", "Something passed"),
            _ => ("Something comes and goes", "Something came"),
        };
        match seen.how_often() {
            Some(often) if seen.is_after_gap() => format!("It {often}."),
            Some(often) if seen.is_known() => format!("{does} {often}."),
            Some(often) => format!("{did} {often}."),
            None => format!("{}.", sentence(&changed(place.changes, seen))),
        }
    }

    /// A time of the map, in words. Between logs without a date, an unknown time has passed: their times count each from its own
    /// first scan.
    pub(super) fn time(&self, time_s: f64) -> String {
        if let Some(begin_s) = self.summary.begin_s {
            return date(begin_s + time_s);
        }
        let begins_s = &self.summary.log_begins_s;
        let log = begins_s.partition_point(|begin_s| *begin_s <= time_s).saturating_sub(1);
        let of_log = match begins_s.len() {
            ..=1 => String::new(),
            _ => format!(" of {}", self.summary.logs[log]),
        };
        let after = match time_s - begins_s.get(log).copied().unwrap_or_default() {
            since_s if since_s < 3600.0 => {
                format!("{:.0} min {:02.0} s", (since_s / 60.0).floor(), (since_s % 60.0).floor())
            }
            since_s => length_of(since_s),
        };
        format!("{after} after the first scan{of_log}")
    }

    /// The picture of a place.
    fn surroundings(&self, place: &Place) -> Markup {
        let plan = self.plan.around(&middle(place), SIDE_M);
        let size = plan.drawing();
        html! {
            svg.plan.mark viewBox={ "0 0 " (number(size.x)) " " (number(size.y)) } role="img" aria-label={ "Surroundings of place " (place.number) } font-family="sans-serif" stroke-width="2" {
                (plan.cells(Layer::Occupancy))
                @if let Some(door) = self.door(place) { (leaf(&plan, door)) } @else { (outline(&plan.rectangle(&self.cells(place)))) }
                rect x="0" y=(number(size.y - 28.0)) width="106" height="28" fill="#fff" opacity="0.85" {}
                g stroke-width="0" { (plan.scale_bar([8.0, size.y - 8.0])) }
            }
        }
    }

    /// The middles of the cells of a place, m.
    fn cells(&self, place: &Place) -> Vec<Point2<f64>> {
        let frame = self.mapper.frame();
        place.cells.iter().map(|index| frame.center(frame.cell(*index))).collect()
    }

    /// The marks of the places on the plan.
    pub(super) fn marks(&self) -> Vec<Mark> {
        let mark = |place: &Place| Mark {
            label: place.number.to_string(),
            link: Some(format!("#place-{}", place.number)),
            points: self.cells(place),
            class: if self.is_door(place) { "door" } else { "place" },
        };
        self.summary.places.iter().map(mark).collect()
    }
}

/// Words with a capital letter at their begin.
fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

fn sure(seen: &Seen) -> String {
    let first = sentence(seen.sureness());
    match seen.per_hour {
        (rate, ends) if seen.has_cycle => {
            format!("{first}: {} (90 % range). {}.", range(rate, ends), sentence(&seen.seen()))
        }
        (_, [_, high]) if seen.observed_s >= LONG_S => {
            format!(
                "{first}: nothing was seen to come, go, and come again. With 95 % probability it comes not more than {}.",
                rate(high)
            )
        }
        _ => format!("{first}: nothing was seen to come, go, and come again."),
    }
}

/// The closed leaf of a door, and the open one where it is known.
fn leaf(plan: &Plan, door: &Door) -> Markup {
    let open = match door.leaf {
        Leaf::Hinged { hinge, length_m, open_rad, .. } => {
            Some([hinge, hinge + interfaces::rotation(open_rad) * nalgebra::Vector2::x() * length_m])
        }
        Leaf::Sliding => None,
    };
    html! { (line(plan, door.closed.ends, "none")) @if let Some(open) = open { (line(plan, open, "6 4")) } }
}

fn line(plan: &Plan, ends: [Point2<f64>; 2], dashes: &str) -> Markup {
    let [from, to] = ends.map(|end| plan.unit(&end));
    html! { line x1=(number(from.x)) y1=(number(from.y)) x2=(number(to.x)) y2=(number(to.y)) stroke="currentColor" stroke-width="4" stroke-dasharray=(dashes) {} }
}

fn week_of(week: &Week, state: &str) -> Markup {
    html! { p { "Usually " (week::usual_hours(week, state)) "." } (week::picture(week, state)) }
}
