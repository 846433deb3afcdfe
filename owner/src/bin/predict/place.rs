//! What is known of one place or door, in sentences and as data.

use crate::moment;
use draw::pictures::NamedLine;
use interfaces::CellState;
use mapper::{Clock, Door, UsualChange, UsualSlot, Week};
use nalgebra::Point2;
use owner::week::usual_hours;
use owner::words::{Seen, changed, length_of, range, rate};
use results::numbers::percent;
use serde::Serialize;
use survey::{Forecast, NEAR_M};

/// The looks at a place are counted by half hours, s.
const HALF_HOUR_S: f64 = 1800.0;

/// A place: a door, or the tile of half a meter at, or beside, a point.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Place {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// Its number and its name in the report of `map_log`, if it has them.
    pub(crate) number: Option<u32>,
    pub(crate) name: Option<String>,
    /// The known door at this place; `None` where there is no door.
    pub(crate) door: Option<DoorRecord>,
    /// The state whose probabilities and hours follow: `open` of a door, `blocked` of another place.
    pub(crate) state: &'static str,
    /// The probabilities, by time.
    pub(crate) expected: Vec<Expected>,
    /// The days and the half hours with a look at the place while it was known to change.
    pub(crate) days: u32,
    pub(crate) half_hours: f64,
    /// For how long a look says more than the usual hours, s; `None` if this is longer than four weeks.
    pub(crate) expiry_s: Option<f64>,
    /// What is usual at these times; empty unless usual hours are known.
    pub(crate) usual: Vec<UsualSlot>,
    /// The times of the week at which it usually changes.
    pub(crate) usual_changes: Vec<UsualChange>,
    /// The same in sentences: what it is, then what is known of it.
    pub(crate) title: String,
    pub(crate) text: Vec<String>,
}

/// A door.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct DoorRecord {
    /// Its number, as in `things.json`.
    pub(crate) id: u32,
    pub(crate) width_m: f64,
    /// Openings per hour, by all looks, and their 90 % interval.
    pub(crate) openings_per_hour: f64,
    pub(crate) openings_per_hour_90: [f64; 2],
}

/// The probability of a state at a time.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Expected {
    pub(crate) time_s: f64,
    /// `None` if the place was never seen.
    pub(crate) probability: Option<f64>,
    /// The interval that contains the true probability with 90 %; `None` with too few looks for it.
    pub(crate) interval_90: Option<[f64; 2]>,
}

impl Place {
    /// The place at a point, at times in seconds. `None` outside of the map.
    pub(crate) fn new(forecast: &Forecast, at: Point2<f64>, times_s: &[f64]) -> Option<Self> {
        let mapper = forecast.mapper();
        let frame = mapper.frame();
        let own = frame.index(frame.cell_at(&at))?;
        if let Some(door) = forecast.door_at(at) {
            return Some(Self::of_door(forecast, door, times_s));
        }
        // The place that changes is perhaps beside the point.
        let far_m = |index: &usize| (frame.center(frame.cell(*index)) - at).norm();
        let near = mapper.changed().filter(|index| far_m(index) <= NEAR_M);
        let index = near.min_by(|a, b| far_m(a).total_cmp(&far_m(b))).unwrap_or(own);
        let title = format!("the place at ({:.2}, {:.2}) m", at.x, at.y);
        let place = Self { x_m: at.x, y_m: at.y, state: "blocked", title, ..Self::default() };
        if let Some(tile) = mapper.tile(index).filter(|tile| tile.last().is_some()) {
            return Some(place.of_clock(forecast, tile.clock(), times_s));
        }
        let probability = |time_s| forecast.outlook().blocked(frame.cell(index), time_s);
        let expected =
            |time_s: &f64| Expected { time_s: *time_s, probability: probability(*time_s), interval_90: None };
        let mut place = Self { expected: times_s.iter().map(expected).collect(), ..place };
        place.text = match mapper.states().cells()[index] {
            CellState::Unknown => vec!["It was never seen.".to_owned()],
            _ if mapper.map_changes(index) > 0 => {
                let of_cell = "From what was seen of this cell alone, without hours.".to_owned();
                place.predictions(forecast).chain([of_cell]).collect()
            }
            state => {
                let state = if state == CellState::Blocked { "blocked" } else { "free" };
                vec![format!("Nothing ever changed within half a meter: it was always {state}.")]
            }
        };
        Some(place)
    }

    /// A door, at times in seconds.
    pub(crate) fn of_door(forecast: &Forecast, door: &Door, times_s: &[f64]) -> Self {
        let at = nalgebra::center(&door.closed.ends[0], &door.closed.ends[1]);
        let width_m = door.closed.length_m();
        let state = if door.is_open() { "open" } else { "closed" };
        let seen = moment::text(forecast.mapper().epoch_s() + door.last_seen_s(), forecast);
        let id = door.id;
        let (openings_per_hour, openings_per_hour_90) = door.openings_per_hour();
        let record = DoorRecord { id, width_m, openings_per_hour, openings_per_hour_90 };
        let reported = forecast.places().iter().find(|place| place.kind.door() == Some(id));
        let called = reported.map(|place| format!(", {},", called(place))).unwrap_or_default();
        let title = format!(
            "door {id}{called} at ({:.2}, {:.2}) m, {width_m:.2} m wide, {state} when it was last seen, {seen}",
            at.x, at.y
        );
        let place =
            Self { x_m: at.x, y_m: at.y, state: "open", title, door: Some(record), ..Self::default() };
        let mut place = place.reported(reported).of_clock(forecast, &door.clock, times_s);
        if let Some(rates) = reported.and_then(|reported| reported.rates.as_ref()) {
            place.text.insert(times_s.len() + 1, openings(&Seen::of_place(rates)));
        }
        place
    }

    /// A place of the report, at times in seconds.
    pub(crate) fn of_report(forecast: &Forecast, reported: &survey::Place, times_s: &[f64]) -> Option<Self> {
        let mapper = forecast.mapper();
        if let Some(door) = mapper.doors().iter().find(|door| reported.kind.door() == Some(door.id)) {
            return Some(Self::of_door(forecast, door, times_s));
        }
        let centers = reported.cells.iter().map(|cell| mapper.frame().center(mapper.frame().cell(*cell)));
        // The middle of a ring or an arc is not in it.
        let middle = Point2::new(reported.x_m, reported.y_m);
        let far_m = |at: &Point2<f64>| (at - middle).norm();
        let at = centers.min_by(|a, b| far_m(a).total_cmp(&far_m(b)))?;
        let mut place = Self::new(forecast, at, times_s)?.reported(Some(reported));
        place.title = format!("{} at ({:.2}, {:.2}) m", called(reported), at.x, at.y);
        Some(place)
    }

    /// Adds what the report calls it.
    fn reported(self, reported: Option<&survey::Place>) -> Self {
        let number = reported.map(|place| place.number);
        Self { number, name: reported.and_then(|place| place.name.clone()), ..self }
    }

    /// Adds what a clock says.
    fn of_clock(mut self, forecast: &Forecast, clock: &Clock, times_s: &[f64]) -> Self {
        let calendar = forecast.calendar();
        let week = clock.week(calendar);
        let expected = |time_s: &f64| Expected {
            time_s: *time_s,
            probability: Some(clock.probability(*time_s, calendar)),
            interval_90: clock.interval_90(*time_s, calendar),
        };
        self.expected = times_s.iter().map(expected).collect();
        (self.days, self.half_hours) = (clock.days(), clock.half_hours());
        self.expiry_s = clock.expiry_s(calendar);
        if let Some(week) = &week {
            let hours = times_s.iter().filter_map(|time_s| calendar.hour_of_week(*time_s));
            self.usual = hours.map(|hour| *week.at(hour)).collect();
            self.usual_changes = week.usual_changes();
        }
        self.text = self.sentences(forecast, week.as_ref());
        self
    }

    /// What is predicted, a sentence for each time.
    fn predictions(&self, forecast: &Forecast) -> impl Iterator<Item = String> {
        self.expected.iter().enumerate().map(|(number, expected)| {
            let probability = expected.probability.unwrap_or(0.5);
            let range = match expected.interval_90 {
                Some([low, high]) => format!("{} to {}", percent(low), percent(high)),
                None => "few data".to_owned(),
            };
            let closed = self.door.as_ref().map(|_| format!(", closed with {}", percent(1.0 - probability)));
            let usual = self.usual.get(number).map(usual).unwrap_or_default();
            format!(
                "{}: {} with a probability of {} ({range}){}{usual}",
                moment::text(expected.time_s, forecast),
                self.state,
                percent(probability),
                closed.unwrap_or_default()
            )
        })
    }

    fn sentences(&self, forecast: &Forecast, week: Option<&Week>) -> Vec<String> {
        let mut lines: Vec<String> = self.predictions(forecast).collect();
        let days = if self.days == 1 { "one day".to_owned() } else { format!("{} days", self.days) };
        let half_hours = match self.half_hours {
            one if one < 1.5 => "one interval".to_owned(),
            many => format!("{many:.0} intervals"),
        };
        lines.push(format!("Observed on {days}, in {half_hours} of 30 minutes."));
        let usual = if week.is_some() { "usual hours" } else { "average" };
        // No longer than it was observed in all: a longer time would be a guess.
        let seen_s = HALF_HOUR_S * self.half_hours;
        lines.push(match self.expiry_s {
            Some(expiry_s) if expiry_s <= seen_s => {
                format!("The last observation tells more than the {usual} for {}.", length_of(expiry_s))
            }
            _ => format!("How long the last observation tells more than the {usual} is not known yet."),
        });
        lines.push(match (week, forecast.why_undated()) {
            (Some(week), _) => format!("Usually {}.", usual_hours(week, self.state)),
            (None, Some(why)) => format!("Usual hours: none, as {why}."),
            (None, None) => {
                format!("Usual hours: not known yet; they need looks on {} days.", Week::MIN_DAYS)
            }
        });
        lines
    }
}

/// The closed leaves of the doors, each with its name, the number of its place, or its own number.
pub(crate) fn door_lines(forecast: &Forecast) -> Vec<NamedLine> {
    let line = |door: &Door| {
        let id = door.id;
        let reported = forecast.places().iter().find(|place| place.kind.door() == Some(id));
        let name = match reported {
            Some(place) => place.name.clone().unwrap_or_else(|| format!("place {}", place.number)),
            None => format!("door {id}"),
        };
        NamedLine { ends: door.closed.ends, name }
    };
    forecast.mapper().doors().iter().map(line).collect()
}

/// A place as it is called in the report.
pub(crate) fn called(place: &survey::Place) -> String {
    let name = place.name.as_ref().map(|name| format!(" ({name})")).unwrap_or_default();
    format!("place {}{name}", place.number)
}

/// How often a door opens: as the card of the report, a rate only where it opened twice.
fn openings(seen: &Seen) -> String {
    match seen.per_hour {
        (per_hour, ends) if seen.has_cycle => {
            format!("Opens {} ({}, 90 % interval): {}.", rate(per_hour), range(per_hour, ends), seen.seen())
        }
        _ => format!("How often it opens is not known yet: {}.", changed(seen.times, seen)),
    }
}

/// What is usual in a half hour of the week.
fn usual(slot: &UsualSlot) -> String {
    let [low, high] = slot.interval_90.map(percent);
    let seen = match slot.days {
        0 => "from the hours and days around it".to_owned(),
        1 => "seen on 1 such day".to_owned(),
        days => format!("seen on {days} such days"),
    };
    format!("; usual then: {} ({low} to {high}, {seen})", percent(slot.probability))
}
