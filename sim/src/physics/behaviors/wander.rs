use super::pace::Pace;
use crate::physics::rays::Beams;
use crate::physics::snapshot::{Values, value};
use crate::physics::spec::{RobotSpec, WanderSpec};
use interfaces::{LaserReading, RandomStream, Twist};
use nalgebra::Vector2;
use std::ops::Range;

/// The width that must be free ahead, as a multiple of the width of the body.
const WIDTH: f64 = 1.1;
/// After a stop, this much additional space must be free before the robot continues, m.
const HYSTERESIS_M: f64 = 0.1;
/// Shares of the maximum turn rate: for a turn in place, and for the sharpest curve.
const TURN_SHARE: f64 = 0.5;
const CURVE_SHARE: f64 = 0.15;
/// The number of scans for which a curve lasts.
const CURVE_SCANS: Range<f64> = 10.0..50.0;

/// Drives without a goal: forward in long random curves. If an obstacle is too near ahead, the robot turns in place
/// toward the side with more space, until the way is free.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Wander {
    spec: WanderSpec,
    max_turn_radps: f64,
    /// The ranges at which the robot stops (below the first value on any beam) and continues (above the second
    /// value). 0 for beams that do not point ahead.
    stop_m: Vec<f32>,
    go_m: Vec<f32>,
    /// Which beams point to the left, and which point ahead.
    left: Vec<bool>,
    ahead: Vec<bool>,
    random: RandomStream,
    /// The rate of the turn in place, rad/s, while the way is blocked.
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
        random: RandomStream,
    ) -> Self {
        let pace = Pace::new(robot, spec.speed_mps, step_s);
        let needed_m = spec.clearance_m + pace.stopping_m;
        // A laser outside of the body is treated as if it were on the border of the body: obstacles ahead then seem
        // nearer.
        let mount = robot.laser.mount.translation.vector.cap_magnitude(robot.radius_m);
        let beams = super::in_robot_frame(robot, beams);
        let table = |free_m: f64| {
            beams.iter().map(|beam| length_within_m(&mount, beam, robot.radius_m, free_m) as f32).collect()
        };
        Self {
            spec,
            max_turn_radps: robot.drive.max_angular_radps,
            stop_m: table(needed_m),
            go_m: table(needed_m + HYSTERESIS_M),
            left: beams.iter().map(|beam| beam.y > 0.0).collect(),
            ahead: beams.iter().map(|beam| beam.x > 0.0).collect(),
            random,
            turning: None,
            curve_radps: 0.0,
            scans_left: 0,
        }
    }

    /// The present curve, rad/s; a new one after some scans.
    fn curve(&mut self) -> f64 {
        if self.scans_left == 0 {
            self.scans_left = self.random.uniform(CURVE_SCANS) as u32;
            self.curve_radps = self.random.uniform(-1.0..1.0) * self.max_turn_radps * CURVE_SHARE;
        }
        self.scans_left -= 1;
        self.curve_radps
    }

    /// +1: there is more space on the left; −1: on the right. Random where there is little difference.
    fn open_side(&mut self, reading: &LaserReading) -> f64 {
        let max_m = reading.scan.range_max_m as f32;
        let mut more_left_m = 0.0;
        for ((range_m, left), ahead) in reading.scan.ranges_m.iter().zip(&self.left).zip(&self.ahead) {
            if *ahead {
                let range_m = range_m.clamp(0.0, max_m);
                more_left_m += if *left { range_m } else { -range_m };
            }
        }
        let undecided = self.random.uniform(-1.0..1.0) * f64::from(max_m);
        1.0_f64.copysign(f64::from(more_left_m) + undecided)
    }

    /// The velocity until the next reading.
    pub(super) fn decide(&mut self, reading: &LaserReading) -> Twist {
        let ranges_m = &reading.scan.ranges_m;
        let free_m = if self.turning.is_some() { &self.go_m } else { &self.stop_m };
        // No early exit: comparing several beams at once is faster. Too close (−∞) is below any bound.
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

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![
            value(&mut self.random),
            value(&mut self.turning),
            value(&mut self.curve_radps),
            value(&mut self.scans_left),
        ]
    }
}

/// The length of a beam within the space that a body of `radius_m` fills while it drives `free_m` ahead, m;
/// 0 if the beam does not point ahead.
fn length_within_m(mount: &Vector2<f64>, beam: &Vector2<f64>, radius_m: f64, free_m: f64) -> f64 {
    if beam.x <= 0.0 {
        return 0.0;
    }
    let side_m = if beam.y == 0.0 {
        f64::INFINITY
    } else {
        (WIDTH * radius_m - mount.y * beam.y.signum()) / beam.y.abs()
    };
    // Through the round front: the farther root of |mount + t·beam − front| = radius.
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
        assert!((length_within_m(&middle, &beam(0.0), 0.2, 0.5) - 0.7).abs() < 1e-12);
        assert!(
            (length_within_m(&middle, &beam(80.0), 0.2, 0.5) - 0.22 / libm::sin(80_f64.to_radians())).abs()
                < 1e-12
        );
        assert_eq!(length_within_m(&middle, &beam(120.0), 0.2, 0.5), 0.0);
        // The body touches the point where a beam ends exactly when it has driven that far.
        for degrees in [-60.0, -20.0, 3.0, 15.0, 40.0] {
            let mount = Vector2::new(0.1, 0.05);
            let end = mount + beam(degrees) * length_within_m(&mount, &beam(degrees), 0.2, 0.5);
            let at_front = (end - Vector2::new(0.5, 0.0)).norm();
            assert!((at_front - 0.2).abs() < 1e-9 || (end.y.abs() - 0.22).abs() < 1e-9, "{degrees}: {end}");
        }
    }
}
