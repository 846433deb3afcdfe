use crate::physics::snapshot::{Values, value};
use crate::physics::spec::DisplacementSpec;
use interfaces::{RandomStream, rotation};
use nalgebra::{Point2, Vector2};
use std::f64::consts::PI;

/// Displacements that are due at random times.
#[derive(Clone)]
pub(in crate::physics) struct Displacements {
    spec: DisplacementSpec,
    random: RandomStream,
    /// The time of the next displacement, s.
    next_s: f64,
}

impl Displacements {
    /// The first displacement is a random time after the start.
    pub(super) fn new(spec: DisplacementSpec, mut random: RandomStream) -> Self {
        let next_s = random.exponential(spec.every_s);
        Self { spec, random, next_s }
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![value(&mut self.random), value(&mut self.next_s)]
    }

    /// Whether a displacement is due at a time (s). The next one is then a random time later.
    pub(in crate::physics) fn is_due(&mut self, time_s: f64) -> bool {
        let is_due = time_s >= self.next_s;
        if is_due {
            // From now on, and not from the time at which it was due: never twice in one step.
            self.next_s = time_s + self.random.exponential(self.spec.every_s);
        }
        is_due
    }

    /// A random place (m) and heading (rad) that differ from the given ones by a displacement.
    pub(in crate::physics) fn draw(&mut self, from: &Point2<f64>, heading_rad: f64) -> (Point2<f64>, f64) {
        let DisplacementSpec { distance_m, turn_rad, .. } = self.spec;
        let direction_rad = self.random.uniform(-PI..PI);
        // The square root makes it uniform in the disc.
        let away_m = distance_m * self.random.uniform(0.0..1.0).sqrt();
        let turn_rad = self.random.uniform(-turn_rad..turn_rad);
        (from + rotation(direction_rad) * Vector2::x() * away_m, heading_rad + turn_rad)
    }
}
