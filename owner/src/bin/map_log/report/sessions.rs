//! What is different since the last visit of the robot.

use super::Page;
use super::labels::Mark;
use maud::{Markup, html};
use nalgebra::Point2;
use owner::words::{date, length_of, list, rate, times};
use survey::{Lasting, Place, PlaceSince, Since, Trend};

/// What has come or gone is drawn at least this large, m.
const HALF_M: f64 = 0.25;

/// The letter of what has come or gone, in the order of the list.
fn letter(number: usize) -> String {
    let letter = char::from(b'A' + (number % 26) as u8);
    if number < 26 { letter.to_string() } else { format!("{letter}{}", number / 26) }
}

impl Page<'_> {
    /// The section about the visits; nothing in the first one.
    pub(super) fn sessions(&self) -> Markup {
        let Some(since) = &self.summary.since_last_session else { return html! {} };
        let of = |trend: Trend| -> Vec<(&PlaceSince, &Place)> {
            let those = since.places.iter().filter(move |place| place.trend == trend);
            those.filter_map(|found| Some((found, self.place(found.number)?))).collect()
        };
        let trends = [Trend::New, Trend::Gone, Trend::Livelier, Trend::Quieter, Trend::FirstSeen];
        let is_same = since.lasting.is_empty() && trends.iter().all(|trend| of(*trend).is_empty());
        html! {
            h2 #since { "What changed since the last visit" }
            p { (self.visits(since)) }
            @if is_same { p { "Nothing for certain: nothing came or went for good, and no place is livelier or quieter by more than chance explains." } }
            ul {
                @for (number, lasting) in since.lasting.iter().enumerate() { li { (self.lasting(number, lasting)) } }
                @for (trend, found) in trends.iter().flat_map(|trend| of(*trend).into_iter().map(move |found| (trend, found))) {
                    li { (self.difference(*trend, found, since)) }
                }
            }
            (self.list("Changed for the first time, which can be chance: ", &of(Trend::FirstChange)))
            (self.list("Not looked at on this visit: ", &of(Trend::NotSeen)))
        }
    }

    fn list(&self, what: &str, places: &[(&PlaceSince, &Place)]) -> Markup {
        html! {
            @if !places.is_empty() {
                p {
                    (what)
                    @for (number, (_, place)) in places.iter().enumerate() { @if number > 0 { ", " } (self.link(place)) }
                    "."
                }
            }
        }
    }

    fn visits(&self, since: &Since) -> String {
        let (before, now) = self.summary.logs.split_at(since.first_log.min(self.summary.logs.len()));
        let day = self
            .summary
            .session_begin_s
            .map(|begin_s| format!(", from {} on", date(begin_s)))
            .unwrap_or_default();
        format!("This visit: {}{day}. Before: {}.", list(now), list(before))
    }

    fn lasting(&self, number: usize, lasting: &Lasting) -> Markup {
        let at = Point2::new(lasting.x_m, lasting.y_m);
        let what = if lasting.is_new {
            "New: something is here that was not"
        } else {
            "Gone: something is no longer here"
        };
        html! {
            span.number.new { (letter(number)) } " " (what) ", " (self.plan.words(&at)) " of the plan, about "
            (format!("{:.1}", lasting.area_m2.max(0.1))) " m²."
        }
    }

    fn difference(&self, trend: Trend, (found, place): (&PlaceSince, &Place), since: &Since) -> Markup {
        let [before_s, now_s] = found.observed_s.map(length_of);
        let rates = [0, 1].map(|part| {
            let hours = found.observed_s[part] / 3600.0;
            match found.passages[part] {
                0 => "never".to_owned(),
                1 => "once".to_owned(),
                count => rate(f64::from(count) / hours),
            }
        });
        let compared =
            format!("now {} in {now_s} of observation, before {} in {before_s}", rates[1], rates[0]);
        let door = if since.doors.contains(&place.number) { " It is a door." } else { "" };
        html! {
            @match trend {
                Trend::New => { "New: " (self.link(place)) " changed for the first time. It was observed for " (before_s) " before." (door) }
                Trend::FirstSeen => { "Seen for the first time: " (self.link(place)) ", where the robot did not look before." (door) }
                Trend::Gone => { "No more changes: " (self.link(place)) " did not change in " (now_s) " of observation. Before, it changed " (times(found.passages[0])) " in " (before_s) "." }
                Trend::Livelier => { "More changes: " (self.link(place)) ", " (compared) "." }
                Trend::Quieter => { "Fewer changes: " (self.link(place)) ", " (compared) "." }
                Trend::FirstChange | Trend::NotSeen | Trend::Same => {}
            }
        }
    }

    /// A place with a card.
    fn place(&self, number: u32) -> Option<&Place> {
        self.summary.places.iter().find(|place| place.number == number)
    }

    /// The marks of what has come or gone.
    pub(super) fn lasting_marks(&self) -> Vec<Mark> {
        let mark = |(number, lasting): (usize, &Lasting)| {
            let half_m = HALF_M.max(lasting.area_m2.sqrt() / 2.0);
            let mark = Mark::square(letter(number), [lasting.x_m, lasting.y_m], half_m, "new");
            Mark { link: Some("#since".to_owned()), ..mark }
        };
        let since = self.summary.since_last_session.iter();
        since.flat_map(|since| since.lasting.iter().enumerate().map(mark)).collect()
    }
}
