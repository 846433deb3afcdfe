//! How much of what should be in view really is.

use super::things::Things;
use crate::view::{Outlook, Places};
use interfaces::Cell;
use mapper::Mapper;

/// For so long, in the unit of the readings' times, a view is believed to be what it should be.
const TRUST: f64 = 10.0;

/// The cells of a visit, and for how long each had been watched before.
#[derive(Clone, Debug)]
struct Visit {
    place: usize,
    duration: f64,
    watched: Vec<f64>,
}

/// The watches from each place: for how long each place in view should have been seen, and was.
/// Without them the robot would stay for ever where it sees nothing of what it came for, as behind
/// something that its own presence holds up.
#[derive(Clone, Debug, Default)]
pub(super) struct Sight {
    looks: Vec<Vec<[f32; 2]>>,
    visit: Option<Visit>,
}

/// For how long a place has been in view: the mean over its cells.
pub(super) fn watched(mapper: &Mapper, places: &Places, place: usize) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for cell in places.cells(place) {
        let seen = mapper.statistics(cell);
        sum += seen.watched_free + seen.watched_blocked;
        count += 1.0;
    }
    sum / count
}

impl Sight {
    /// Takes note of a visit that begins, when each place was `watched` for so long.
    pub(super) fn begin(&mut self, outlook: &mut Outlook, watched: &[f64], place: usize, duration: f64) {
        let watched = outlook.seen_from(place).iter().map(|&seen| watched[seen as usize]).collect();
        self.visit = Some(Visit { place, duration, watched });
    }

    /// Books the last visit, which is over. A robot that is not where it wanted to be has seen nothing
    /// from there.
    pub(super) fn end(&mut self, mapper: &Mapper, outlook: &mut Outlook, places: &Places, robot: Cell) {
        if self.looks.len() != places.count() {
            self.looks = vec![Vec::new(); places.count()];
            self.visit = None;
        }
        let Some(Visit { place, duration, watched: before }) = self.visit.take() else { return };
        let view = outlook.seen_from(place);
        // A wall that was found or lost on the way makes another view.
        if before.len() != view.len() {
            return;
        }
        let is_there = mapper.frame().index(robot).is_some_and(|robot| places.of(robot) == place);
        let looks = &mut self.looks[place];
        if looks.len() != view.len() {
            *looks = vec![[0.0; 2]; view.len()];
        }
        for ((look, before), &seen) in looks.iter_mut().zip(before).zip(view) {
            look[0] += duration as f32;
            if is_there {
                look[1] += (watched(mapper, places, seen as usize) - before).clamp(0.0, duration) as f32;
            }
        }
    }

    /// The share of a watch from a place for which each place of its view is seen, in their order;
    /// `None` for a place that was never visited, where all of it is believed to be seen.
    pub(super) fn share(&self, place: usize, view: &[u32]) -> Option<impl Iterator<Item = f64>> {
        let looks = &self.looks[place];
        let share = |[due, seen]: &[f32; 2]| (f64::from(*seen) + TRUST) / (f64::from(*due) + TRUST);
        (looks.len() == view.len() && !looks.is_empty()).then(|| looks.iter().map(share))
    }
}

/// What moving things hide, in a grid of cells as large as what moves.
///
/// A cell that changed is hidden for as long as one between it and the robot is blocked. And what
/// enters it from the cell beside it that lies towards the robot comes out of its own shadow: the
/// robot never sees the cell free and then blocked, finds both changes too late, and believes the cell
/// to change less than it does. Of the events of a cell with k neighbours that change, such a
/// neighbour takes 2 / k, for the event and the time that is booked without it.
#[derive(Clone, Debug)]
pub(super) struct Hiding<'a> {
    things: &'a Things,
    mapper: &'a Mapper,
    /// Per cell that changed, the probability that it is blocked.
    blocked: Vec<f64>,
}

impl<'a> Hiding<'a> {
    pub(super) fn new(mapper: &'a Mapper, things: &'a Things) -> Self {
        let mut blocked = vec![0.0; mapper.frame().len()];
        for cell in mapper.changed() {
            blocked[cell] = mapper.blocked_probability(cell);
        }
        Self { things, mapper, blocked }
    }

    /// How much of the events of a changed cell is seen from another, from 1 down to −1: less than
    /// nothing where watching misleads.
    pub(super) fn clear(&self, from: usize, to: usize) -> f64 {
        let frame = self.mapper.frame();
        let (start, end) = (frame.cell(from), frame.cell(to));
        let (dx, dy) = (end.x - start.x, end.y - start.y);
        let length = dx.abs().max(dy.abs());
        if length <= 1 {
            return 1.0;
        }
        // To the nearest cell, halves away from the robot.
        let part = |way: i32, step: i32| way.signum() * ((2 * way.abs() * step + length) / (2 * length));
        let index = |x: i32, y: i32| (start.y + y) as usize * frame.width() + (start.x + x) as usize;
        let mut clear = 1.0;
        for step in 1..length {
            clear *= 1.0 - self.blocked[index(part(dx, step), part(dy, step))];
        }
        let towards = match dx.abs().cmp(&dy.abs()) {
            std::cmp::Ordering::Greater => index(dx - dx.signum(), dy),
            std::cmp::Ordering::Less => index(dx, dy - dy.signum()),
            std::cmp::Ordering::Equal => return clear,
        };
        if self.things.has(towards) {
            clear *= 1.0 - 2.0 / f64::from(self.things.degree(to).max(1));
        }
        clear
    }
}
