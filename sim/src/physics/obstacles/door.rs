use crate::physics::chance::{Purpose, Uniform};
use crate::physics::snapshot::{Played, Tape};
use crate::physics::spec::{DoorSpec, Opening};

/// Times are sums of steps: this much too early is in time, s.
const SLACK_S: f64 = 5e-7;

/// What has become of a door.
#[derive(Clone)]
pub(super) struct Door {
    /// How far it is open: 0 closed, 1 open.
    pub(super) openness: f64,
    /// Of a door that opens at random: whether it is told to be open, and when it is told again, s.
    is_told_open: bool,
    next_s: f64,
    chance: Uniform,
}

impl Door {
    /// The door in place `index` of the obstacles, at the start.
    pub(super) fn new(spec: &DoorSpec, index: usize, seed: u64) -> Self {
        let mut door = Self {
            openness: f64::from(u8::from(spec.starts_open)),
            is_told_open: spec.starts_open,
            next_s: 0.0,
            chance: Uniform::new(seed, Purpose::Door, index),
        };
        door.next_s = door.stay_s(spec);
        door
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.f64(&mut self.openness)?;
        tape.bool(&mut self.is_told_open)?;
        tape.f64(&mut self.next_s)?;
        self.chance.play(tape)
    }

    /// How far it would be open after a step that ends at `time_s`.
    pub(super) fn next(&mut self, spec: &DoorSpec, time_s: f64, step_s: f64) -> f64 {
        let most = step_s / spec.move_s;
        let by = if self.is_told_open(spec, time_s) { most } else { -most };
        (self.openness + by).clamp(0.0, 1.0)
    }

    /// Whether it is told to be open at a time, s. Time never goes back.
    fn is_told_open(&mut self, spec: &DoorSpec, time_s: f64) -> bool {
        let time_s = time_s + SLACK_S;
        match &spec.opening {
            Opening::Periodic { closed_s, open_s } => {
                let since_s = time_s % (closed_s + open_s);
                if spec.starts_open { since_s < *open_s } else { since_s >= *closed_s }
            }
            Opening::Scripted { switches_s } => {
                let switches = switches_s.partition_point(|switch_s| *switch_s <= time_s);
                spec.starts_open != (switches % 2 == 1)
            }
            Opening::Random { .. } => {
                while time_s >= self.next_s {
                    self.is_told_open = !self.is_told_open;
                    self.next_s += self.stay_s(spec);
                }
                self.is_told_open
            }
        }
    }

    /// How long it is told to be as it is now, s.
    fn stay_s(&mut self, spec: &DoorSpec) -> f64 {
        match spec.opening {
            // The exponential distribution by inversion.
            Opening::Random { closed_s, open_s } => {
                let mean_s = if self.is_told_open { open_s } else { closed_s };
                -mean_s * libm::log(1.0 - self.chance.between(0.0..1.0))
            }
            Opening::Periodic { .. } | Opening::Scripted { .. } => f64::INFINITY,
        }
    }
}
