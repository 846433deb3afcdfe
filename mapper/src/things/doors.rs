//! Lines become doorways, and doorways become doors.

use super::Things;
use super::door::Door;
use super::doorway::Doorway;
use super::line::Line;
use crate::change::CellMap;

/// The largest number of lines, and of doorways.
const MAX_LINES: usize = 48;
const MAX_DOORWAYS: usize = 64;

impl Things {
    /// Adds a line; returns whether it is a part of a door.
    pub(super) fn add_line(&mut self, line: Line, cells: &CellMap) -> bool {
        let known = self.doorways.iter_mut().position(|doorway| doorway.add(&line, cells));
        let doorway = match known {
            Some(known) => {
                self.lines.iter().for_each(|other| self.doorways[known].confirm_open(other, &line));
                Some(self.merge(known))
            }
            None => self.add_doorway(&line, cells),
        };
        let mut is_open_leaf = false;
        if known.is_none() {
            for doorway in &mut self.doorways {
                is_open_leaf |= doorway.add_open(&line, &self.lines) && doorway.thing.is_some();
            }
        }
        self.lines.push(line);
        if self.lines.len() > MAX_LINES {
            self.lines.remove(0);
        }
        doorway.is_some_and(|doorway| self.place_door(doorway, cells)) || is_open_leaf
    }

    /// Adds the doorway in which a line is, if there is one; returns its position.
    fn add_doorway(&mut self, line: &Line, cells: &CellMap) -> Option<usize> {
        let mut doorway = Doorway::of(line, cells)?;
        for other in &self.lines {
            doorway.add_open(other, std::slice::from_ref(line));
        }
        if self.doorways.len() >= MAX_DOORWAYS {
            let others = self.doorways.iter().enumerate().filter(|(_, doorway)| doorway.thing.is_none());
            let oldest = others.min_by(|(_, a), (_, b)| a.last_s.total_cmp(&b.last_s)).map(|(at, _)| at);
            self.doorways.remove(oldest?);
        }
        self.doorways.push(doorway);
        Some(self.merge(self.doorways.len() - 1))
    }

    /// Merges a doorway with others that it has turned out to be the same as; returns its position then.
    fn merge(&mut self, mut doorway: usize) -> usize {
        let is_same = |a: &Doorway, b: &Doorway| a.closed.is_near(&b.closed);
        while let Some(other) = (0..self.doorways.len())
            .find(|&other| other != doorway && is_same(&self.doorways[other], &self.doorways[doorway]))
        {
            let removed = self.doorways.remove(other.max(doorway));
            doorway = other.min(doorway);
            if let Some(thing) = self.doorways[doorway].join(removed) {
                self.doors.retain(|other| other.id != thing);
            }
        }
        doorway
    }

    /// Makes a door of a doorway with enough evidence, or refines the door that it is. Returns whether it is one.
    fn place_door(&mut self, position: usize, cells: &CellMap) -> bool {
        let doorway = &self.doorways[position];
        if doorway.thing.is_none() && !doorway.is_door() {
            return false;
        }
        let (closed, open, lines) = (doorway.closed, doorway.open_leaf(cells), doorway.lines);
        let id = doorway.thing.unwrap_or(self.next_door);
        self.doorways[position].thing = Some(id);
        if id == self.next_door {
            self.next_door += 1;
            self.doors.push(Door::new(id, closed, lines.iter().sum(), cells));
        }
        for door in self.doors.iter_mut().filter(|door| door.id == id) {
            door.place(closed, open, cells.frame());
            // Its leaf can have passed for an object before.
            self.objects.forget(&door.cells);
        }
        true
    }
}
