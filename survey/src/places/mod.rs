//! Places: what a person would point at, with its number, its name, what it looks like, and how often it changes.
//!
//! - `groups`: neighboring cells that change, and the cells of doors and of objects.
//! - `passages`: how often something came into each spot of half a meter.
//! - `book`: the numbers and the names of places, which they keep over all sessions.
//! - `session`, `since`: what is different since the last session.

mod book;
mod groups;
mod passages;
mod since;
#[cfg(test)]
mod tests;

pub(crate) use book::{PlaceBook, still_names};
pub use book::{PlaceName, StillName};
pub use groups::is_line;
pub(crate) use since::since;
pub use since::{Lasting, PlaceSince, Since, Trend};

use crate::ChangeLog;
use crate::masks::share_blocked;
use groups::{Group, groups};
use interfaces::median;
use mapper::{Mapper, RateDistribution};
use nalgebra::Point2;
use passages::Spot;
use serde::Serialize;

/// The probability with which an interval contains the rate.
const MASS: f64 = 0.9;
const HOUR_S: f64 = 3600.0;
/// What passes is gone after this time, s.
const PASSING_S: f64 = 30.0;
/// The area of a body that passes, m².
const BODY_M2: f64 = 0.25;
/// The number of passages before any look: Jeffreys' prior of a rate.
const PRIOR_PASSAGES: f64 = 0.5;

/// A place where something changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// Its number, which it keeps over all sessions.
    pub number: u32,
    /// The name that the user has given; `None` without one.
    pub name: Option<String>,
    /// What it looks like.
    #[serde(flatten)]
    pub kind: PlaceKind,
    /// The middle of the cells, m.
    pub x_m: f64,
    /// The middle of the cells, m.
    pub y_m: f64,
    /// The lower left corner of the rectangle around the cells, m.
    pub low_m: [f64; 2],
    /// The upper right corner of this rectangle, m.
    pub high_m: [f64; 2],
    /// The area of the cells that changed, m².
    pub area_m2: f64,
    /// The number of changes that were seen in the cell with the most changes.
    pub changes: u32,
    /// How often it changes; `None` where the times of the log are unusable.
    #[serde(flatten)]
    pub rates: Option<PlaceRates>,
    /// Its cells, by their index.
    #[serde(skip)]
    pub cells: Vec<usize>,
}

/// What a place looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum PlaceKind {
    /// A line that sweeps or slides.
    Door {
        /// The number of the [`mapper::Door`].
        thing: u32,
    },
    /// Something that comes and goes as a whole: a chair, a box, a parked robot.
    Object {
        /// The number of the [`mapper::ObjectReport`].
        thing: u32,
    },
    /// Something wider than a [line](is_line) comes again and again, and is gone soon: people, carts, robots.
    Traffic,
    /// Something changed; what it is, is not known.
    Unknown,
}

impl PlaceKind {
    /// The number of the door; `None` for what is none.
    pub fn door(self) -> Option<u32> {
        if let Self::Door { thing } = self { Some(thing) } else { None }
    }
}

/// How often a place changes, and when: it follows from the times of the readings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceRates {
    /// The cycles per hour (blocked, free, blocked again): the openings of a door, or those of the cell with the median rate.
    pub cycles_per_hour: f64,
    /// The ends of the 90 % credible interval of this rate, 1/h; the upper one is `null` without an upper bound.
    pub cycles_per_hour_90: [Option<f64>; 2],
    /// The number of times that something came in view, in the spot of half a meter where this happened most often; of a door, an
    /// object, or what mostly changed out of view: the cycles in view.
    pub passages: u32,
    /// The number of times that the cell (door, object) was found blocked or free otherwise than before, after a time out of view.
    pub changes_after_gap: u32,
    /// The number of times that it was looked at, with times out of view between.
    pub looks: u32,
    /// The time in view of this spot (door, object), s.
    pub spot_observed_s: f64,
    /// The passages per hour in view; `null` where they do not say how often it changes: of a door, an object, what mostly changed out
    /// of view, and if the spot was never in view between two readings.
    pub passages_per_hour: Option<f64>,
    /// The ends of the 90 % credible interval of this rate, 1/h.
    pub passages_per_hour_90: Option<[f64; 2]>,
    /// The mean share of the time that the cells are blocked, from 0 to 1.
    pub share_blocked: f64,
    /// The time of the last change, s.
    pub last_change_s: f64,
}

impl PlaceRates {
    /// Whether a full cycle was seen: something came, was gone, and came again, in view or not. Less says nothing about the time of
    /// a cycle.
    pub fn has_cycle(&self) -> bool {
        self.passages >= 2 || self.passages_per_hour.is_none() && self.changes_after_gap >= 3
    }
}

/// The places where something changes, the liveliest first. Their numbers and names are those of the book.
pub(crate) fn places(mapper: &Mapper, log: &ChangeLog, book: &PlaceBook) -> Vec<Place> {
    let mut found: Vec<(Place, Group)> = Vec::new();
    for group in groups(mapper) {
        let spot = book.passages.busiest(mapper, &group.cells);
        let place = place(mapper, log, &group, spot).filter(|place| group.counts(mapper, place.changes));
        found.extend(place.map(|place| (place, group)));
    }
    found.sort_by(|(a, _), (b, _)| liveliness(b).total_cmp(&liveliness(a)));
    let (mut places, groups): (Vec<Place>, Vec<Group>) = found.into_iter().unzip();
    let numbers = book.numbers(mapper, &groups);
    places.iter_mut().zip(&numbers).for_each(|(place, number)| place.number = *number);
    book::give(&mut places, &book.names);
    places
}

/// How lively a place is: the lower end of the interval of the passages, or of the cycles, so that places that were
/// seen for seconds do not come first. What is smaller than a body can be noise, and counts for less.
fn liveliness(place: &Place) -> f64 {
    let least =
        |rates: &PlaceRates| rates.passages_per_hour_90.map(|[low, _]| low).or(rates.cycles_per_hour_90[0]);
    let least_per_hour = place.rates.as_ref().and_then(least);
    (place.area_m2 / BODY_M2).min(1.0) * least_per_hour.unwrap_or_default()
}

fn place(mapper: &Mapper, log: &ChangeLog, group: &Group, spot: Spot) -> Option<Place> {
    let (frame, cells) = (mapper.frame(), &group.cells);
    let centers: Vec<Point2<f64>> = cells.iter().map(|index| frame.center(frame.cell(*index))).collect();
    let half_m = frame.resolution_m() / 2.0;
    let spans = centers.iter().map(|at| (*at, *at));
    let (low, high) = spans.reduce(|(low, high), (at, _)| (low.inf(&at), high.sup(&at)))?;
    let mut by_rate: Vec<(f64, usize)> = cells.iter().map(|cell| (mapper.rate(*cell), *cell)).collect();
    by_rate.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let (rate_hz, median) = by_rate[by_rate.len() / 2];
    let door = mapper.doors().iter().find(|door| group.kind.and_then(PlaceKind::door) == Some(door.id));
    let of_kind = |kind| mapper.objects().find(|object| kind == PlaceKind::Object { thing: object.id });
    let object = group.kind.and_then(of_kind);
    let (evidence, (per_hour, ends)) = match (door, object) {
        (Some(door), _) => (door.evidence().clone(), door.openings_per_hour()),
        (None, Some(object)) => (object.evidence, (object.cycles_per_hour, object.cycles_per_hour_90)),
        (None, None) => {
            let ends: [f64; 2] = mapper.credible_interval(median, MASS).into();
            (mapper.evidence(median), (rate_hz * HOUR_S, ends.map(|end_hz| end_hz * HOUR_S)))
        }
    };
    let is_passed = group.kind.is_none() && !evidence.is_mostly_after_gap();
    let [came, went] = evidence.events();
    let (passages, spot_s) = match is_passed {
        true => (spot.all(), spot.observed_s),
        false => (came.max(went), evidence.in_view_s()),
    };
    let events = PRIOR_PASSAGES + f64::from(passages);
    let rate = (is_passed && spot_s > 0.0).then(|| RateDistribution { events, time: spot_s / HOUR_S });
    let rates = PlaceRates {
        cycles_per_hour: per_hour,
        cycles_per_hour_90: ends.map(|end| Some(end).filter(|end| end.is_finite())),
        passages,
        changes_after_gap: evidence.changes_after_gap(),
        looks: evidence.looks(),
        spot_observed_s: spot_s,
        passages_per_hour: rate.map(|rate| f64::from(passages) / rate.time),
        passages_per_hour_90: rate.map(|rate| rate.interval(MASS).into()),
        share_blocked: cells.iter().map(|cell| share_blocked(mapper, *cell)).sum::<f64>()
            / cells.len() as f64,
        last_change_s: cells.iter().filter_map(|index| log.last_s(*index)).reduce(f64::max)?,
    };
    Some(Place {
        number: 0,
        name: None,
        kind: kind(mapper, group, &rates),
        x_m: centers.iter().map(|at| at.x).sum::<f64>() / centers.len() as f64,
        y_m: centers.iter().map(|at| at.y).sum::<f64>() / centers.len() as f64,
        low_m: [low.x - half_m, low.y - half_m],
        high_m: [high.x + half_m, high.y + half_m],
        area_m2: cells.len() as f64 * frame.resolution_m().powi(2),
        changes: cells.iter().map(|index| mapper.statistics(*index).events()).max()?,
        rates: Some(rates),
        cells: cells.clone(),
    })
}

fn kind(mapper: &Mapper, group: &Group, rates: &PlaceRates) -> PlaceKind {
    if let Some(kind) = group.kind {
        return kind;
    }
    let stays = |index: &usize| {
        let seen = mapper.statistics(*index);
        (seen.free_events > 0).then(|| seen.watched_blocked / f64::from(seen.free_events))
    };
    let is_short = median(group.cells.iter().filter_map(stays)).is_some_and(|stay_s| stay_s <= PASSING_S);
    let is_mostly_free = rates.share_blocked <= 0.5;
    if is_short && is_mostly_free && rates.has_cycle() && !is_line(mapper, &group.cells) {
        PlaceKind::Traffic
    } else {
        PlaceKind::Unknown
    }
}
