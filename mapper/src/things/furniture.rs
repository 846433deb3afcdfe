//! Furniture that stands elsewhere since: a place that was blocked for long and is free, and one that was free and is blocked.

use super::lasting::Change;
use super::segment;
use crate::Growth;
use crate::change::CellMap;
use interfaces::CellState;
use nalgebra::{Point2, Vector2};
use std::collections::VecDeque;

/// The smallest width of furniture, m, and the smallest number of cells that show it.
const MIN_WIDTH_M: f64 = 0.15;
const MIN_CELLS: usize = 12;
/// What is still so after this time stands, s: people move on.
const STANDS_S: f64 = 60.0;
/// Furniture has been in view for this time before it goes, and after it has come, s; its cells change at most this often.
const MIN_WATCHED_S: f64 = 10.0;
const MAX_CHANGES: u32 = 2;
/// The share of the cells that must be seen again, of which most may be inside, and the share of these that must be so still.
const SEEN: f64 = 0.15;
const AGREE: f64 = 0.8;
/// Places are those of one piece if they are at most this far apart, m, and their times at most this, s.
const SAME_M: f64 = 0.5;
const SAME_S: f64 = 300.0;
/// A piece is carried for at most this time, s.
const CARRIED_S: f64 = 120.0;
/// A piece is as large as before up to this factor: it is seen from other sides.
const SAME_SIZE: f64 = 1.7;
/// The largest number of places that may turn out to be furniture.
const MAX_PENDING: usize = 32;
/// One of them is checked after this number of readings: a piece of furniture has time.
pub(super) const READINGS: u32 = 8;

/// A place where furniture stood or stands.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Place {
    /// The center, m.
    pub center: Point2<f64>,
    /// The mean distance of the cells from the center, m.
    pub radius_m: f64,
    /// The cells, by their index.
    pub cells: Vec<u32>,
    /// It came or went between these times, s: that of the last look before, and that of the first look after.
    pub between_s: [f64; 2],
}

/// A piece of furniture.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Furniture {
    /// Where it stood; `None` if that was not seen.
    pub from: Option<Place>,
    /// Where it stands; `None` if that was not seen.
    pub to: Option<Place>,
}

impl Furniture {
    /// Its places.
    pub fn places(&self) -> impl Iterator<Item = &Place> {
        self.from.iter().chain(&self.to)
    }

    fn places_mut(&mut self) -> impl Iterator<Item = &mut Place> {
        self.from.iter_mut().chain(&mut self.to)
    }

    /// Takes over a place if it is one of this piece.
    pub(super) fn take(&mut self, place: &Place, is_blocked: bool) -> bool {
        if let Some(to) = self.to.take_if(|to| !is_blocked && to.is_near(place)) {
            // It has been moved again.
            self.from = Some(Place { between_s: place.between_s, ..to });
            return true;
        }
        let [own, other] = if is_blocked { [&self.to, &self.from] } else { [&self.from, &self.to] };
        let is_own = own.as_ref().is_some_and(|own| own.is_near(place) && own.is_within(place, SAME_S));
        let is_moved = own.is_none()
            && other.as_ref().is_some_and(|other| {
                let [from, to] = if is_blocked { [other, place] } else { [place, other] };
                from.precedes(to) && from.is_as_large(to)
            });
        match if is_blocked { &mut self.to } else { &mut self.from } {
            Some(own) if is_own => own.join(place),
            own if is_moved => *own = Some(place.clone()),
            _ => return false,
        }
        true
    }

    /// Whether it came from nowhere, and has gone: somebody stood there, or the leaf of a door that is not known yet.
    pub(super) fn was_passing(&self, cells: &CellMap) -> bool {
        self.from.is_none()
            && self.to.as_ref().is_some_and(|to| {
                let [agree, differ] = to.looks(true, cells);
                differ > agree
            })
    }

    pub(super) fn grow(&mut self, growth: &Growth) {
        self.places_mut().for_each(|place| place.grow(growth));
    }
}

impl Place {
    fn is_near(&self, other: &Self) -> bool {
        (self.center - other.center).norm() < SAME_M
    }

    /// Whether it came or went at most this time before or after another place, s.
    fn is_within(&self, other: &Self, time_s: f64) -> bool {
        self.between_s[0] - time_s <= other.between_s[1] && other.between_s[0] - time_s <= self.between_s[1]
    }

    /// Whether furniture can have gone here, and have come to another place soon after.
    fn precedes(&self, other: &Self) -> bool {
        self.between_s[0] <= other.between_s[1] && other.between_s[0] <= self.between_s[1] + CARRIED_S
    }

    /// The number of cells that were seen much later and are so still, and of those that are not.
    fn looks(&self, is_blocked: bool, cells: &CellMap) -> [f64; 2] {
        let mut looks = [0.0; 2];
        for index in self.cells.iter().map(|&cell| cell as usize) {
            let seen = cells.statistics(index);
            let is_now_blocked = cells.state(index) == CellState::Blocked;
            let watched_s = if is_now_blocked { seen.watched_blocked } else { seen.watched_free };
            // Cells that have just come back into view may need some more looks to change.
            if seen.last_seen >= self.between_s[1] + STANDS_S && watched_s >= MIN_WATCHED_S {
                let is_so = is_now_blocked == is_blocked && seen.events() <= MAX_CHANGES;
                looks[usize::from(!is_so)] += 1.0;
            }
        }
        looks
    }

    fn is_as_large(&self, other: &Self) -> bool {
        (1.0 / SAME_SIZE..SAME_SIZE).contains(&(self.radius_m / other.radius_m))
    }

    fn join(&mut self, other: &Self) {
        self.cells.extend(&other.cells);
        self.cells.sort_unstable();
        self.cells.dedup();
    }

    fn grow(&mut self, growth: &Growth) {
        self.cells.iter_mut().for_each(|cell| *cell = growth.index(*cell as usize) as u32);
    }
}

/// Places that may turn out to be furniture.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(super) struct Pending(VecDeque<(Place, bool)>);

impl Pending {
    /// Adds the changes of a motion, all of the same kind, if a piece of furniture can be there.
    pub(super) fn add(&mut self, changes: &[Change], cells: &CellMap) {
        let stood = |change: &&Change| {
            let seen = cells.statistics(change.cell as usize);
            let has_come = seen.block_events + seen.block_events_after_gap > 0;
            // People stop for some time: what has stood for long was there at two looks that are far apart.
            let stood_s =
                if has_come { seen.watched_blocked } else { change.seen_before_s - seen.first_seen };
            seen.events() <= MAX_CHANGES
                && (change.is_blocked || seen.watched_blocked >= MIN_WATCHED_S && stood_s >= STANDS_S)
        };
        let changes: Vec<&Change> = changes.iter().filter(stood).collect();
        let frame = cells.frame();
        let points: Vec<_> =
            changes.iter().map(|change| frame.center(frame.cell(change.cell as usize))).collect();
        if points.len() < MIN_CELLS || segment::width_m(&points) + frame.resolution_m() < MIN_WIDTH_M {
            return;
        }
        let median = |of: fn(&Change) -> f64| {
            let mut times_s: Vec<f64> = changes.iter().map(|change| of(change)).collect();
            times_s.sort_by(f64::total_cmp);
            times_s[times_s.len() / 2]
        };
        let between_s = [median(|change| change.seen_before_s), median(|change| change.time_s)];
        let center = points.iter().map(|point| point.coords).sum::<Vector2<f64>>() / points.len() as f64;
        let radius_m =
            points.iter().map(|point| (point.coords - center).norm()).sum::<f64>() / points.len() as f64;
        let place = Place {
            center: center.into(),
            radius_m,
            cells: changes.iter().map(|change| change.cell).collect(),
            between_s,
        };
        if self.0.len() >= MAX_PENDING {
            self.0.pop_front();
        }
        self.0.push_back((place, changes[0].is_blocked));
    }

    /// The place that is checked next, if it has turned out to be one of furniture; with whether it is blocked.
    pub(super) fn next(&mut self, cells: &CellMap) -> Option<(Place, bool)> {
        let (place, is_blocked) = self.0.pop_front()?;
        let [agree, differ] = place.looks(is_blocked, cells).map(|looks| looks / place.cells.len() as f64);
        if agree < SEEN && differ < SEEN {
            self.0.push_back((place, is_blocked));
            return None;
        }
        (agree >= AGREE * (agree + differ)).then_some((place, is_blocked))
    }

    pub(super) fn grow(&mut self, growth: &Growth) {
        self.0.iter_mut().for_each(|(place, _)| place.grow(growth));
    }
}
