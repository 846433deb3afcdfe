use crate::physics::spec::{DoorSpec, Opening};
use crate::routine::Routine;
use interfaces::{Purpose, RandomStream};
use serde::{Deserialize, Serialize};

/// Times are sums of steps: a time within this of an event counts as the time of the event, s.
const SLACK_S: f64 = 5e-7;

/// A door whose way is blocked for this long moves back, s.
const PATIENCE_S: f64 = 2.0;
/// The time for which a door that moved back stays there before it tries again, s.
const PAUSE_S: f64 = 5.0;

/// The state of a door.
#[derive(Clone, Deserialize, Serialize)]
pub(super) struct Door {
    /// The openness of the door: 0 closed, 1 open.
    pub(super) openness: f64,
    /// For a door that opens at random: whether it must be open now, and the time of the next change, s.
    is_to_open: bool,
    next_s: f64,
    random: RandomStream,
    /// For how long something has been in the way, s.
    blocked_s: f64,
    retreat: Option<Retreat>,
}

/// A motion against the schedule of a door, since something is in its way.
#[derive(Clone, Copy, Deserialize, Serialize)]
struct Retreat {
    is_to_open: bool,
    /// The rest of the pause at the end of the motion, s.
    pause_s: f64,
}

/// What opens and closes a door with a schedule.
pub(super) struct Calls<'a> {
    pub(super) routine: Option<&'a mut Routine>,
    /// Whether a robot needs the door, which waits for it, to get to its dock.
    pub(super) is_needed: bool,
}

impl Door {
    /// The obstacle with an index, a door, at the start.
    pub(super) fn new(spec: &DoorSpec, index: usize, seed: u64) -> Self {
        let mut door = Self {
            openness: f64::from(u8::from(spec.starts_open)),
            is_to_open: spec.starts_open,
            next_s: 0.0,
            random: RandomStream::new(seed, Purpose::Door(index)),
            blocked_s: 0.0,
            retreat: None,
        };
        door.next_s = door.stay_s(spec);
        door
    }

    /// The openness after a step that ends at `time_s`, if nothing is in the way. The direction of the motion
    /// changes at the exact time of a change, also within the step.
    pub(super) fn next(&mut self, spec: &DoorSpec, mut calls: Calls, time_s: f64, step_s: f64) -> f64 {
        if let Some(retreat) = self.retreat {
            let (is_to_open, _) = self.target(spec, &mut calls, time_s - step_s);
            if is_to_open != retreat.is_to_open && retreat.pause_s > SLACK_S {
                return self.back(spec, retreat, step_s);
            }
            self.retreat = None;
        }
        let (mut openness, mut left_s) = (self.openness, step_s);
        while left_s > SLACK_S {
            let (is_to_open, until_s) = self.target(spec, &mut calls, time_s - left_s);
            let for_s = left_s.min(until_s - (time_s - left_s));
            let by = for_s / spec.move_s;
            openness = (openness + if is_to_open { by } else { -by }).clamp(0.0, 1.0);
            left_s -= for_s;
        }
        openness
    }

    /// The time until which the door does not move, s, from `time_s` on; `None` if it moves now.
    pub(super) fn rests_until_s(&mut self, spec: &DoorSpec, mut calls: Calls, time_s: f64) -> Option<f64> {
        let (is_to_open, until_s) = self.target(spec, &mut calls, time_s);
        let is_there = self.openness == f64::from(u8::from(is_to_open));
        (is_there && self.retreat.is_none() && self.blocked_s == 0.0).then_some(until_s)
    }

    /// The openness after a step of a retreat, if nothing is in the way.
    fn back(&mut self, spec: &DoorSpec, retreat: Retreat, step_s: f64) -> f64 {
        let end = f64::from(u8::from(retreat.is_to_open));
        if self.openness == end {
            self.retreat = Some(Retreat { pause_s: retreat.pause_s - step_s, ..retreat });
        }
        let by = step_s / spec.move_s;
        (self.openness + if retreat.is_to_open { by } else { -by }).clamp(0.0, 1.0)
    }

    /// Takes over the openness `next` if the way is free. Otherwise the door waits, and later moves back, or
    /// forward again if it was moving back.
    pub(super) fn end_step(&mut self, next: f64, is_free: bool, step_s: f64) {
        if is_free {
            (self.openness, self.blocked_s) = (next, 0.0);
            return;
        }
        self.blocked_s += step_s;
        if self.blocked_s >= PATIENCE_S - SLACK_S {
            self.blocked_s = 0.0;
            let retreat = Retreat { is_to_open: next < self.openness, pause_s: PAUSE_S };
            self.retreat = if self.retreat.is_some() { None } else { Some(retreat) };
        }
    }

    /// Whether the door must be open from a time on, and the time of the next change, s. The time must not decrease
    /// between calls.
    fn target(&mut self, spec: &DoorSpec, calls: &mut Calls, time_s: f64) -> (bool, f64) {
        let time_s = time_s + SLACK_S;
        match &spec.opening {
            Opening::Periodic { closed_s, open_s } => {
                let first_s = if spec.starts_open { open_s } else { closed_s };
                let since_s = time_s % (closed_s + open_s);
                let is_first = since_s < *first_s;
                let end_s = if is_first { *first_s } else { closed_s + open_s };
                (is_first == spec.starts_open, time_s + (end_s - since_s))
            }
            Opening::Scripted { switches_s } => {
                let switches = switches_s.partition_point(|switch_s| *switch_s <= time_s);
                let until_s = switches_s.get(switches).copied().unwrap_or(f64::INFINITY);
                (spec.starts_open != (switches % 2 == 1), until_s)
            }
            Opening::Scheduled { .. } => match &mut calls.routine {
                Some(routine) => (!routine.is_blocked(time_s) || calls.is_needed, routine.next_s()),
                None => (spec.starts_open, f64::INFINITY),
            },
            Opening::Random { .. } => {
                while time_s >= self.next_s {
                    self.is_to_open = !self.is_to_open;
                    self.next_s += self.stay_s(spec);
                }
                (self.is_to_open, self.next_s)
            }
        }
    }

    /// The time until the next change of a door that opens at random, s; infinite for other doors.
    fn stay_s(&mut self, spec: &DoorSpec) -> f64 {
        let Opening::Random { closed_s, open_s } = spec.opening else { return f64::INFINITY };
        self.random.exponential(if self.is_to_open { open_s } else { closed_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::spec::Leaf;
    use nalgebra::Vector2;

    /// The openness of a door that needs 2 s to open, at some times, in steps of 0.05 s.
    fn opennesses(opening: Opening, starts_open: bool, times_s: &[f64]) -> Vec<f64> {
        let leaf = Leaf::Sliding { by_m: Vector2::x() };
        let spec = DoorSpec { leaf, opening, move_s: 2.0, starts_open };
        let mut door = Door::new(&spec, 0, 0);
        let (mut steps, mut time_s) = (0.0, 0.0);
        let at = times_s.iter().map(|until_s| {
            while time_s < until_s - SLACK_S {
                steps += 1.0;
                time_s = steps * 0.05;
                door.openness = door.next(&spec, Calls { routine: None, is_needed: false }, time_s, 0.05);
            }
            (door.openness * 1e9).round() / 1e9
        });
        at.collect()
    }

    #[test]
    fn doors_move_from_the_times_of_changes() {
        let scripted = |switches_s: &[f64]| Opening::Scripted { switches_s: switches_s.to_vec() };
        let times_s = [1.0, 1.05, 2.0, 3.0, 5.0, 5.05, 6.0, 9.0];
        let expected = [0.0, 0.025, 0.5, 1.0, 1.0, 0.975, 0.5, 0.0];
        assert_eq!(opennesses(scripted(&[1.0, 5.0]), false, &times_s), expected);
        assert_eq!(
            opennesses(scripted(&[1.0, 5.0]), true, &times_s),
            [1.0, 0.975, 0.5, 0.0, 0.0, 0.025, 0.5, 1.0]
        );
        // In the middle of a step, and three times in one.
        assert_eq!(opennesses(scripted(&[1.02]), false, &[1.0, 1.05, 2.0]), [0.0, 0.015, 0.49]);
        assert_eq!(opennesses(scripted(&[1.01, 1.02, 1.04]), false, &[1.05, 1.1]), [0.005, 0.03]);
        let periodic = Opening::Periodic { closed_s: 3.0, open_s: 4.0 };
        let times_s = [3.0, 4.0, 5.0, 7.0, 8.0, 9.0, 10.0, 11.0, 706.0, 707.0];
        let expected = [0.0, 0.5, 1.0, 1.0, 0.5, 0.0, 0.0, 0.5, 1.0, 1.0];
        assert_eq!(opennesses(periodic.clone(), false, &times_s), expected);
        assert_eq!(
            opennesses(periodic, true, &[4.0, 5.0, 6.0, 7.0, 8.0, 9.0]),
            [1.0, 0.5, 0.0, 0.0, 0.5, 1.0]
        );
    }
}
