//! What is different since the last session.
//!
//! A session is one visit of the robot: logs that follow each other within hours. Counts of two sessions are compared by the time
//! in view of each: with equal rates, the passages of both are divided in proportion to these times, which gives a binomial
//! test. Passages come in pairs, there and back: pairs are counted. Of many places, some differ by chance: the rate of false
//! findings is bounded as by Benjamini and Hochberg (1995).

use super::book::PlaceBook;
use super::passages::{Key, cell_key, looked};
use super::{Place, PlaceKind};
use crate::ChangeLog;
use crate::masks::cells_of_doors;
use interfaces::CellState;
use mapper::Mapper;
use nalgebra::Vector2;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

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
        lasting: lasting(mapper, log, &session.touched),
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

/// Passages at one place, before the session and in it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Compared {
    /// Whether nothing passed before, in no spot of the place: a place that was divided anew is not new.
    is_first: bool,
    passages: [u32; 2],
    /// The time in view, s.
    observed_s: [f64; 2],
}

/// Passages come there and back.
const PER_PAIR: f64 = 2.0;
/// A smaller factor between two rates is of no interest.
const MIN_FACTOR: f64 = 1.5;

impl Compared {
    /// Whether there is more per hour in the session than before.
    fn is_more(&self) -> bool {
        let [before, since] = self.passages.map(f64::from);
        since * self.observed_s[0] > before * self.observed_s[1]
    }

    /// The probability of a difference at least as large, if both rates are the same: twice that of one side.
    fn p_value(&self) -> f64 {
        let [before, since] = self.passages.map(|passages| (f64::from(passages) / PER_PAIR).round() as u32);
        let total_s = self.observed_s[0] + self.observed_s[1];
        let share = self.observed_s[1] / total_s;
        if total_s <= 0.0 || share <= 0.0 || share >= 1.0 || before + since == 0 || !self.is_large() {
            return 1.0;
        }
        let all = before + since;
        let range = if self.is_more() { since..=all } else { 0..=since };
        let side: f64 = range.map(|count| libm::exp(log_binomial(count, all, share))).sum();
        (2.0 * side).min(1.0)
    }

    fn is_large(&self) -> bool {
        let [before, since] = self.passages.map(|passages| f64::from(passages) + 0.5);
        let factor = (since / self.observed_s[1]) / (before / self.observed_s[0]);
        !(1.0 / MIN_FACTOR..MIN_FACTOR).contains(&factor)
    }
}

/// The logarithm of the probability of `count` of `all` independent draws with this probability each.
fn log_binomial(count: u32, all: u32, probability: f64) -> f64 {
    let factorial = |number: u32| libm::lgamma(f64::from(number) + 1.0);
    factorial(all) - factorial(count) - factorial(all - count)
        + f64::from(count) * libm::log(probability)
        + f64::from(all - count) * libm::log1p(-probability)
}

/// Which of these tests find something, if at most this share of the findings may be wrong.
fn significant(p_values: &[f64], share: f64) -> Vec<bool> {
    let mut sorted = p_values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let limit = |rank: usize| share * (rank + 1) as f64 / sorted.len() as f64;
    let last = (0..sorted.len()).rev().find(|rank| sorted[*rank] <= limit(*rank));
    let largest = last.map_or(-1.0, |rank| sorted[rank]);
    p_values.iter().map(|p_value| *p_value <= largest).collect()
}

/// Cells are those of one thing if they are at most this far apart, m.
const APART_M: f64 = 0.15;
/// The smallest area of a thing, m².
const MIN_M2: f64 = 0.04;
/// What stays so was still so this time after its last change, s, and was in view for this time where it is or was.
const STAYS_S: f64 = 10.0;
/// A cell that changed more often, in all sessions, belongs to something that moves.
const MAX_CHANGES: u32 = 4;

/// Something that came or went since the last session, and was still so at the end.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lasting {
    /// Whether something is where nothing was before; otherwise something is gone.
    pub is_new: bool,
    /// Its middle, m.
    pub x_m: f64,
    /// Its middle, m.
    pub y_m: f64,
    /// The area of its cells, m².
    pub area_m2: f64,
}

/// What has come or gone, the largest first. `touched`: cells that changed in the session, and whether each was blocked before.
fn lasting(mapper: &Mapper, log: &ChangeLog, touched: &BTreeMap<Key, bool>) -> Vec<Lasting> {
    let frame = mapper.frame();
    let stays = |index: &usize| {
        let (seen, last_s) = (mapper.statistics(*index), log.last_s(*index));
        let is_still = last_s.is_some_and(|last_s| seen.last_seen - last_s >= STAYS_S);
        is_still && seen.watched_blocked >= STAYS_S && seen.events() <= MAX_CHANGES
    };
    let of_doors = cells_of_doors(mapper);
    let lasts = |index: &usize| stays(index) && of_doors.binary_search(&(*index as u32)).is_err();
    let [mut gone, mut new] = [BTreeSet::new(), BTreeSet::new()];
    for index in mapper.changed().filter(lasts) {
        match (touched.get(&cell_key(frame, index)), mapper.states().cells()[index]) {
            (Some(true), CellState::Free) => gone.insert(index),
            (Some(false), CellState::Blocked) => new.insert(index),
            _ => false,
        };
    }
    let reach = (APART_M / frame.resolution_m()).round().max(1.0) as i32;
    let mut found = Vec::new();
    for (is_new, mut left) in [(false, gone), (true, new)] {
        while let Some(cells) = frame.take_connected(&mut left, reach) {
            let centers = cells.iter().map(|index| frame.center(frame.cell(*index)).coords);
            let middle = centers.sum::<Vector2<f64>>() / cells.len() as f64;
            let area_m2 = cells.len() as f64 * frame.resolution_m().powi(2);
            found.push(Lasting { is_new, x_m: middle.x, y_m: middle.y, area_m2 });
        }
    }
    found.retain(|lasting| lasting.area_m2 >= MIN_M2);
    found.sort_by(|a, b| b.area_m2.total_cmp(&a.area_m2));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compared(passages: [u32; 2], minutes: [f64; 2]) -> Compared {
        Compared { is_first: false, passages, observed_s: minutes.map(|minutes| 60.0 * minutes) }
    }

    #[test]
    fn more_in_the_same_time_is_livelier_and_a_few_are_chance() {
        let lively = compared([10, 60], [60.0, 60.0]);
        assert!(lively.p_value() < 1e-3 && lively.is_more(), "{}", lively.p_value());
        let quiet = compared([60, 0], [60.0, 60.0]);
        assert!(quiet.p_value() < 1e-6 && !quiet.is_more(), "{}", quiet.p_value());
        // Twice as many in twice the time, three more, and nothing at all.
        for same in
            [compared([20, 40], [60.0, 120.0]), compared([1, 4], [60.0, 60.0]), compared([0, 0], [9.0, 9.0])]
        {
            assert!(same.p_value() > 0.1, "{same:?}: {}", same.p_value());
        }
        assert_eq!(compared([0, 9], [0.0, 60.0]).p_value(), 1.0);
    }

    /// With 10 heads of 10 throws of a coin.
    #[test]
    fn probabilities_are_those_of_the_binomial_distribution() {
        let all_heads = compared([0, 20], [60.0, 60.0]).p_value();
        assert!((all_heads - 2.0 / 1024.0).abs() < 1e-12, "{all_heads}");
        let sum: f64 = (0..=17).map(|count| libm::exp(log_binomial(count, 17, 0.3))).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn of_many_tests_a_small_share_of_the_findings_is_wrong() {
        assert_eq!(significant(&[0.001, 0.8, 0.02, 0.5], 0.05), [true, false, true, false]);
        assert_eq!(significant(&[0.04, 0.9, 0.9], 0.05), [false; 3]);
        assert_eq!(significant(&[], 0.05), [false; 0]);
    }
}
