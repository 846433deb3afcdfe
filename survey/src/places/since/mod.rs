//! What is different since the last session.
//!
//! A session is one visit of the robot: logs that follow each other within hours. Counts of two sessions are compared by the time
//! in view of each: with equal rates, the passages of both are divided in proportion to these times, which gives a binomial
//! test. Passages come in pairs, there and back: pairs are counted. Of many places, some differ by chance: the rate of false
//! findings is bounded as by Benjamini and Hochberg (1995).

mod compared;
mod lasting;

pub use lasting::Lasting;

use super::book::PlaceBook;
use super::passages::Key;
use super::session::looked;
use super::{Place, PlaceKind};
use crate::ChangeLog;
use compared::{Compared, significant};
use mapper::Mapper;
use serde::Serialize;

/// The share of findings that may be wrong.
const FALSE_FINDINGS: f64 = 0.05;
/// A place was looked at if its spot was in view for this time, s.
const LOOKED_S: f64 = 30.0;

/// How the passages at a place have changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trend {
    /// It changed for the first time, and would have changed before if the rate were the same.
    New,
    /// It changed for the first time, and was looked at before, but not for long enough to be sure.
    FirstChange,
    /// It changed for the first time, and was not looked at before.
    FirstSeen,
    /// It has changed before, and no more, though it was looked at for long enough.
    Gone,
    /// More passages per hour than before.
    Livelier,
    /// Fewer passages per hour than before.
    Quieter,
    /// It was not looked at, or for less than half a minute.
    NotSeen,
    /// No difference that could not be chance.
    Same,
}

/// A place in this session, and before it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceSince {
    /// The number of the place.
    pub number: u32,
    /// What is different.
    pub trend: Trend,
    /// Passages before this session, and in it.
    pub passages: [u32; 2],
    /// The time in view before this session, and in it, s.
    pub observed_s: [f64; 2],
    /// The probability of such a difference by chance, if the rate is the same; 1 if there is nothing to compare.
    pub p_value: f64,
}

/// What is different since the last session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Since {
    /// The number of the first log of this session.
    pub first_log: usize,
    /// Every place, in the order of the places.
    pub places: Vec<PlaceSince>,
    /// The places of doors that were found in this session.
    pub doors: Vec<u32>,
    /// What has come or gone, and stays so.
    pub lasting: Vec<Lasting>,
}

impl Since {
    /// Whether a place with this number is another one than before, by what could not be chance.
    pub fn is_different(&self, number: u32) -> bool {
        let is_it = |place: &&PlaceSince| place.number == number;
        let trend = self.places.iter().find(is_it).map(|place| place.trend);
        matches!(trend, Some(Trend::New | Trend::Gone | Trend::Livelier | Trend::Quieter))
    }
}

/// What is different since the last session, for these places; `None` in the first one.
pub(crate) fn since(book: &PlaceBook, mapper: &Mapper, log: &ChangeLog, places: &[Place]) -> Option<Since> {
    let session = &book.session;
    let is_new_door =
        |place: &&Place| matches!(place.kind, PlaceKind::Door { thing } if !session.doors.contains(&thing));
    (session.log > 0).then(|| Since {
        first_log: session.log,
        places: trends(book, mapper, places),
        doors: places.iter().filter(is_new_door).map(|place| place.number).collect(),
        lasting: lasting::lasting(mapper, log, &session.touched),
    })
}

fn trends(book: &PlaceBook, mapper: &Mapper, places: &[Place]) -> Vec<PlaceSince> {
    let looked = looked(mapper);
    let looked_s = |key| f64::from(looked.get(&key).copied().unwrap_or_default());
    let compared: Vec<Compared> =
        places.iter().map(|place| compared(book, mapper, place, looked_s)).collect();
    let p_values: Vec<f64> = compared.iter().map(Compared::p_value).collect();
    let is_found = significant(&p_values, FALSE_FINDINGS);
    let since = |((place, compared), is_found): ((&Place, &Compared), bool)| PlaceSince {
        number: place.number,
        trend: trend(place.number > book.session.last && compared.is_first, compared, is_found),
        passages: compared.passages,
        observed_s: compared.observed_s,
        p_value: compared.p_value(),
    };
    places.iter().zip(&compared).zip(is_found).map(since).collect()
}

fn trend(is_new: bool, compared: &Compared, is_found: bool) -> Trend {
    let [before_s, since_s] = compared.observed_s;
    match compared.passages {
        _ if is_new && before_s < LOOKED_S => Trend::FirstSeen,
        _ if is_new && is_found => Trend::New,
        _ if is_new => Trend::FirstChange,
        _ if since_s < LOOKED_S => Trend::NotSeen,
        [_, 0] if is_found => Trend::Gone,
        _ if is_found && compared.is_more() => Trend::Livelier,
        _ if is_found => Trend::Quieter,
        _ => Trend::Same,
    }
}

/// `looked_s`: for how long a spot was in view.
fn compared(book: &PlaceBook, mapper: &Mapper, place: &Place, looked_s: impl Fn(Key) -> f64) -> Compared {
    let spot = book.passages.busiest(mapper, &place.cells);
    let before_s = f64::from(book.session.looked.get(&spot.key).copied().unwrap_or_default());
    Compared {
        is_first: spot.before_in_all == 0,
        passages: spot.passages,
        observed_s: [before_s, (looked_s(spot.key) - before_s).max(0.0)],
    }
}
