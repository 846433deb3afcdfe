use crate::physics::spec::RobotSpec;

/// Steering toward a heading, 1/s.
pub(super) const HEADING_GAIN: f64 = 3.0;
/// The share of the speed and of the turn rate in a narrow place.
pub(super) const NARROW_SHARE: f64 = 0.25;
/// The minimum speed of an approach, m/s: with a speed proportional to the distance, the robot would never arrive.
pub(super) const CREEP_MPS: f64 = 0.02;

/// How fast a robot that receives one command per scan can stop and turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    speed_mps: f64,
    /// The stopping distance, m: from the command until the robot stands, the reaction time included.
    pub(super) stopping_m: f64,
    /// The time until a command takes effect, s.
    reaction_s: f64,
    braking_mps2: f64,
    turn_braking_radps2: f64,
    pub(super) max_turn_radps: f64,
}

impl Pace {
    /// The pace of `robot` at `speed_mps`.
    pub(super) fn new(robot: &RobotSpec, speed_mps: f64, step_s: f64) -> Self {
        // Commands come with scans: the robot brakes with half of its maximum deceleration, so that a late command
        // is early enough.
        let braking_mps2 = robot.drive.max_linear_acceleration_mps2 / 2.0;
        let reaction_s = (robot.laser.period_steps + 1) as f64 * step_s;
        Self {
            speed_mps,
            stopping_m: speed_mps * (reaction_s + speed_mps / (4.0 * braking_mps2)),
            reaction_s,
            braking_mps2,
            turn_braking_radps2: robot.drive.max_angular_acceleration_radps2 / 2.0,
            max_turn_radps: robot.drive.max_angular_radps,
        }
    }

    /// The highest speed from which the robot can stop within `distance_m`, if the next command comes one reading
    /// later: the root of v·t + v²/2b = distance. At least the minimum speed of an approach.
    pub(super) fn approach_mps(&self, distance_m: f64) -> f64 {
        let (t, b) = (self.reaction_s, self.braking_mps2);
        let fastest_mps = b * ((t * t + 2.0 * distance_m.max(0.0) / b).sqrt() - t);
        self.speed_mps.min(fastest_mps).max(CREEP_MPS)
    }

    /// The highest turn rate from which the robot can stop at `angle_rad`.
    pub(super) fn turn_radps(&self, angle_rad: f64) -> f64 {
        let fastest = (2.0 * self.turn_braking_radps2 * angle_rad.abs()).sqrt();
        // Proportional at the end: the root would overshoot between two readings.
        let rate = fastest.min(self.max_turn_radps).min(HEADING_GAIN * angle_rad.abs());
        rate.copysign(angle_rad)
    }
}
