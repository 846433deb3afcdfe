use super::pace::Pace;
use crate::physics::chance::Uniform;
use crate::physics::rays::Beams;
use crate::physics::snapshot::{Played, Tape};
use crate::physics::spec::{RobotSpec, WanderSpec};
use interfaces::{LaserReading, Twist};
use nalgebra::Vector2;
use std::ops::Range;

/// Ahead this much more than the body's width must be free.
const WIDTH: f64 = 1.1;
/// Once stopped, so much more space must be free to go on, m.
const HYSTERESIS_M: f64 = 0.1;
/// It turns in place at this share of what its drive can do, or in a curve on its way.
const TURN_SHARE: f64 = 0.5;
const CURVE_SHARE: f64 = 0.15;
/// It goes on with a curve for so many scans.
const CURVE_SCANS: Range<f64> = 10.0..50.0;

/// A mind without a goal: it goes ahead in long random curves, and where something comes too near
/// ahead it turns in place, towards the side that is more open, until the way is free.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Wander {
    spec: WanderSpec,
    max_turn_radps: f64,
    /// Below the first range on a beam the robot stops, and goes on above the second; 0 for beams
    /// that don't look ahead.
    stop_m: Vec<f32>,
    go_m: Vec<f32>,
    /// Which beams look to the left half of what is ahead, and which to the right.
    left: Vec<bool>,
    ahead: Vec<bool>,
    chance: Uniform,
    /// The turn in place, rad/s, while the way is not free.
    turning: Option<f64>,
    curve_radps: f64,
    scans_left: u32,
}

impl Wander {
    pub(super) fn new(
        spec: WanderSpec,
        robot: &RobotSpec,
        step_s: f64,
        beams: &Beams,
        chance: Uniform,
    ) -> Self {
        let pace = Pace::new(robot, spec.speed_mps, step_s);
        let needed_m = spec.clearance_m + pace.stopping_m;
        // What sticks out counts as if it were at the border: then things seem nearer.
        let mount = robot.laser.mount.translation.vector.cap_magnitude(robot.radius_m);
        let beams = super::in_robot_frame(robot, beams);
        let table = |free_m: f64| {
            beams.iter().map(|beam| way_m(&mount, beam, robot.radius_m, free_m) as f32).collect()
        };
        Self {
            spec,
            max_turn_radps: robot.drive.max_angular_radps,
            stop_m: table(needed_m),
            go_m: table(needed_m + HYSTERESIS_M),
            left: beams.iter().map(|beam| beam.y > 0.0).collect(),
            ahead: beams.iter().map(|beam| beam.x > 0.0).collect(),
            chance,
            turning: None,
            curve_radps: 0.0,
            scans_left: 0,
        }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        self.chance.play(tape)?;
        tape.option(&mut self.turning, || 0.0, Tape::f64)?;
        tape.f64(&mut self.curve_radps)?;
        tape.u32(&mut self.scans_left)
    }

    pub(super) fn decide(&mut self, reading: &LaserReading) -> Twist {
        let ranges_m = &reading.scan.ranges_m;
        let free_m = if self.turning.is_some() { &self.go_m } else { &self.stop_m };
        // No early end: the comparisons of several beams at once are worth more. Too close (−∞)
        // is below any bound.
        let is_blocked = ranges_m.iter().zip(free_m).fold(false, |any, (range, free)| any | (range < free));
        if !is_blocked {
            self.turning = None;
            return Twist { linear_mps: self.spec.speed_mps, angular_radps: self.curve() };
        }
        let turn_radps = match self.turning {
            Some(turn) => turn,
            None => self.open_side(reading) * self.max_turn_radps * TURN_SHARE,
        };
        self.turning = Some(turn_radps);
        Twist { linear_mps: 0.0, angular_radps: turn_radps }
    }

    /// The present curve, rad/s; a new one from time to time.
    fn curve(&mut self) -> f64 {
        if self.scans_left == 0 {
            self.scans_left = self.chance.between(CURVE_SCANS) as u32;
            self.curve_radps = self.chance.between(-1.0..1.0) * self.max_turn_radps * CURVE_SHARE;
        }
        self.scans_left -= 1;
        self.curve_radps
    }

    /// +1 if there is more space on the left, −1 if on the right; by chance if they are alike.
    fn open_side(&mut self, reading: &LaserReading) -> f64 {
        let max_m = reading.scan.range_max_m as f32;
        let mut more_left_m = 0.0;
        for ((range_m, left), ahead) in reading.scan.ranges_m.iter().zip(&self.left).zip(&self.ahead) {
            if *ahead {
                let range_m = range_m.clamp(0.0, max_m);
                more_left_m += if *left { range_m } else { -range_m };
            }
        }
        let undecided = self.chance.between(-1.0..1.0) * f64::from(max_m);
        1.0_f64.copysign(f64::from(more_left_m) + undecided)
    }
}

/// How far a beam goes before it leaves the space that a body of `radius_m` fills on its next
/// `free_m` ahead, m; 0 if it does not look ahead.
fn way_m(mount: &Vector2<f64>, beam: &Vector2<f64>, radius_m: f64, free_m: f64) -> f64 {
    if beam.x <= 0.0 {
        return 0.0;
    }
    let side_m = if beam.y == 0.0 {
        f64::INFINITY
    } else {
        (WIDTH * radius_m - mount.y * beam.y.signum()) / beam.y.abs()
    };
    // Out of the round front: the farther root of |mount + t·beam − front| = radius.
    let to_front = Vector2::new(free_m, 0.0) - mount;
    let b = to_front.dot(beam);
    let root2 = b * b - to_front.norm_squared() + radius_m * radius_m;
    let front_m = if root2 > 0.0 { b + root2.sqrt() } else { f64::INFINITY };
    side_m.min(front_m.max(0.0)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_space_ahead_is_the_body_moved_on() {
        let middle = Vector2::zeros();
        let beam = |degrees: f64| {
            let (y, x) = libm::sincos(degrees.to_radians());
            Vector2::new(x, y)
        };
        assert!((way_m(&middle, &beam(0.0), 0.2, 0.5) - 0.7).abs() < 1e-12);
        assert!(
            (way_m(&middle, &beam(80.0), 0.2, 0.5) - 0.22 / libm::sin(80_f64.to_radians())).abs() < 1e-12
        );
        assert_eq!(way_m(&middle, &beam(120.0), 0.2, 0.5), 0.0);
        // A point where a beam ends is touched by the body just when it has gone so far.
        for degrees in [-60.0, -20.0, 3.0, 15.0, 40.0] {
            let mount = Vector2::new(0.1, 0.05);
            let end = mount + beam(degrees) * way_m(&mount, &beam(degrees), 0.2, 0.5);
            let at_front = (end - Vector2::new(0.5, 0.0)).norm();
            assert!((at_front - 0.2).abs() < 1e-9 || (end.y.abs() - 0.22).abs() < 1e-9, "{degrees}: {end}");
        }
    }
}
