//! What the behaviors drive with: straight legs, the pace that lets a robot stop, and the end of its patience.

use super::Chassis;
use crate::physics::shape::TOUCH_M;
use crate::physics::snapshot::{pose, value};
use interfaces::{LaserReading, Twist, Values, values};
use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};

/// Steering toward a heading, 1/s.
const HEADING_GAIN: f64 = 3.0;
/// The share of the speed and of the turn rate in a narrow place.
pub(super) const NARROW_SHARE: f64 = 0.25;
/// The minimum speed of an approach, m/s: with a speed proportional to the distance, the robot would never arrive.
const CREEP_MPS: f64 = 0.02;

/// The robot turns in place if its heading differs from the leg by more than the first angle, and drives again if
/// the difference is below the second angle, rad.
const TURN_BEYOND_RAD: f64 = 0.5;
const TURNED_RAD: f64 = 0.03;
/// An obstacle is in the way if less than this space is left between it and the robot at the end of the leg, m.
const END_MARGIN_M: f64 = 0.03;
/// A way counts as free if nothing is nearer than this beyond the minimum range, m.
const FREE_M: f64 = 1.0;
/// After a stop, this much additional space must be free before the robot continues, m: this avoids stop-and-go at
/// the limit.
const HYSTERESIS_M: f64 = 0.05;

/// How long a robot waits for a free way, s.
const PATIENCE_S: f64 = 5.0;
/// A robot that has moved this far, m, or turned this far, rad, does not wait; a slow robot needs to reach only a
/// share of the distance or angle that its limits allow in this time.
const PROGRESS_M: f64 = 0.05;
const PROGRESS_RAD: f64 = 0.2;
const PROGRESS_SHARE: f64 = 0.2;

/// Drives along straight legs by odometry: the robot turns in place if the next leg has another direction, and
/// stops while the laser measures an obstacle ahead.
#[derive(Clone, Debug)]
pub(super) struct Legs {
    pub(super) radius_m: f64,
    clearance_m: f64,
    /// The unit vectors of the beams of the laser in the frame of the robot.
    pub(super) beams: Vec<Vector2<f64>>,
    pace: Pace,
    turning: bool,
    /// Whether something was in the way at the last reading.
    pub(super) blocked: bool,
    /// Where a surface ahead would stop the center of the robot, by odometry, as it was measured last: nearer than the minimum
    /// range, no laser measures it. Beyond the minimum range if the way was free.
    ahead: Option<Point2<f64>>,
}

/// A reading on a leg.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegScan<'a> {
    pub(super) reading: &'a LaserReading,
    /// The rotation from the frame of the robot to the frame of the leg.
    pub(super) lean: UnitComplex<f64>,
}

impl Legs {
    pub(super) fn new(chassis: Chassis, speed_mps: f64, clearance_m: f64) -> Self {
        Self {
            radius_m: chassis.robot.radius_m,
            clearance_m,
            beams: chassis.beam_directions(),
            pace: Pace::new(chassis, speed_mps),
            turning: false,
            blocked: false,
            ahead: None,
        }
    }

    /// The free distance ahead, m, below which the robot stops.
    pub(super) fn needed_m(&self) -> f64 {
        self.clearance_m + self.pace.stopping_m
    }

    /// Starts a new leg with a turn in place, to the exact direction of the leg.
    pub(super) fn start_turning(&mut self) {
        (self.turning, self.blocked) = (true, false);
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        values![self.turning, self.blocked, self.ahead]
    }

    /// The velocity on the leg in the direction of the unit vector `along`, `remaining_m` before its end. `look`
    /// returns the free distance ahead, m, and the heading to steer to, rad from the direction of the leg.
    pub(super) fn drive(
        &mut self,
        reading: &LaserReading,
        along: &Vector2<f64>,
        remaining_m: f64,
        look: impl FnOnce(&Self, &LegScan) -> (f64, f64),
    ) -> Twist {
        let lean = UnitComplex::from_cos_sin_unchecked(along.x, along.y).inverse() * reading.pose.rotation;
        let lean_rad = libm::atan2(lean.im, lean.re);
        let scan = LegScan { reading, lean };
        self.remember(&scan, along);
        self.turning = lean_rad.abs() > if self.turning { TURNED_RAD } else { TURN_BEYOND_RAD };
        if self.turning {
            return Twist { linear_mps: 0.0, angular_radps: self.pace.turn_radps(-lean_rad) };
        }
        let (gap_m, heading_rad) = look(self, &scan);
        let hysteresis_m = if self.blocked { HYSTERESIS_M } else { 0.0 };
        let needed_m = self.needed_m() + hysteresis_m;
        // A body behind the end of the leg is not in the way.
        self.blocked = gap_m < needed_m.min(remaining_m + END_MARGIN_M);
        if self.blocked {
            return Twist::STOP;
        }
        Twist {
            linear_mps: self.pace.approach_mps(remaining_m),
            angular_radps: HEADING_GAIN * (heading_rad - lean_rad),
        }
    }

    /// The end points of the beams, in the frame of the leg, m.
    pub(super) fn points(&self, scan: &LegScan) -> impl Iterator<Item = Vector2<f64>> {
        self.ends(scan, |range_m| range_m.is_finite().then_some(range_m.into()))
    }

    /// The points on the beams at the distance that `at_m` makes of their ranges, in the frame of the leg, m.
    fn ends(&self, scan: &LegScan, at_m: impl Fn(f32) -> Option<f64>) -> impl Iterator<Item = Vector2<f64>> {
        let LegScan { reading, lean } = *scan;
        let mount = reading.mount.translation.vector;
        let beams = reading.scan.ranges_m.iter().zip(&self.beams);
        beams.filter_map(move |(range_m, beam)| Some(lean * (mount + beam * at_m(*range_m)?)))
    }

    /// Remembers the surface ahead while the laser measures it.
    fn remember(&mut self, scan: &LegScan, along: &Vector2<f64>) {
        let is_ahead = |point: &Vector2<f64>| point.x > 0.0 && point.y.abs() < self.radius_m + END_MARGIN_M;
        let has_minimum_range = scan.reading.scan.range_min_m > 0.0;
        if !has_minimum_range || self.blind_ends(scan).any(|end| is_ahead(&end)) {
            return;
        }
        let points = self.points(scan).filter(is_ahead);
        let blind_m = blind_m(scan.reading);
        let gap_m = points.fold(blind_m + FREE_M, |gap_m, point| gap_m.min(self.gap_m(&point)));
        self.ahead = Some(Point2::from(scan.reading.pose.translation.vector) + along * gap_m);
    }

    /// Whether what is too close to be measured is the wall behind the end of the leg: the surface that was measured before is
    /// behind the end, and now nearer than the minimum range. Of a leg that was never measured, nothing else is known.
    fn is_wall_behind_end(&self, &LegScan { reading, lean }: &LegScan, remaining_m: f64) -> bool {
        let Some(stop) = self.ahead else { return true };
        let from_robot = stop - Point2::from(reading.pose.translation.vector);
        let way = lean * reading.pose.rotation.inverse() * from_robot;
        let is_on_leg = way.x > -self.radius_m && way.y.abs() < self.radius_m;
        // Without a margin: noise lets the nearest point seem nearer than the wall is.
        !is_on_leg || (remaining_m..blind_m(reading)).contains(&way.x)
    }

    /// The points at the minimum range on the beams that measure something nearer (−∞), in the frame of the leg, m.
    fn blind_ends(&self, scan: &LegScan) -> impl Iterator<Item = Vector2<f64>> {
        let range_min_m = scan.reading.scan.range_min_m;
        self.ends(scan, move |range_m| (range_m == f32::NEG_INFINITY).then_some(range_min_m))
    }

    /// Where something is too close to be measured (−∞), in the frame of the leg, m: as far to the side as the minimum range
    /// reaches, and not farther ahead than a touch. A beam beyond the minimum range would have measured it, so that a wall
    /// beside the way is not in the way. The wall behind the end of the leg, `remaining_m` ahead, is not in the way either.
    pub(super) fn too_close(&self, scan: &LegScan, remaining_m: f64) -> impl Iterator<Item = Vector2<f64>> {
        let is_wall = self.is_wall_behind_end(scan, remaining_m);
        let behind_m = if is_wall { remaining_m + END_MARGIN_M } else { f64::INFINITY };
        let on_leg = self.blind_ends(scan).filter(move |at| self.gap_m(at) < behind_m);
        on_leg.map(move |at| Vector2::new(at.x.min(self.nose_m(&at) + TOUCH_M), at.y))
    }

    /// The distance that the round body can drive along the leg, m, with a free space at both sides; the leg ends `remaining_m`
    /// ahead.
    pub(super) fn free_m(&self, scan: &LegScan, side_margin_m: f64, remaining_m: f64) -> f64 {
        let open_m = self.radius_m + side_margin_m;
        let points = self.points(scan).chain(self.too_close(scan, remaining_m));
        let ahead = points.filter(|point| point.x > 0.0 && point.y.abs() < open_m);
        ahead.fold(f64::INFINITY, |free_m, point| free_m.min(self.gap_m(&point)))
    }

    /// The distance that the round body can drive before it touches a point ahead, m.
    pub(super) fn gap_m(&self, point: &Vector2<f64>) -> f64 {
        point.x - self.nose_m(point)
    }

    /// How far the round body reaches ahead, m, as far to the side as a point.
    fn nose_m(&self, point: &Vector2<f64>) -> f64 {
        (self.radius_m * self.radius_m - point.y * point.y).max(0.0).sqrt()
    }
}

/// Farther from the center of the robot than this, m, the laser measures a surface.
fn blind_m(reading: &LaserReading) -> f64 {
    reading.mount.translation.vector.norm() + reading.scan.range_min_m
}

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
    max_turn_radps: f64,
}

impl Pace {
    /// The pace of a robot at `speed_mps`.
    pub(super) fn new(Chassis { robot, step_s, .. }: Chassis, speed_mps: f64) -> Self {
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

/// Notices that a robot does not get ahead, for whatever reason.
#[derive(Clone, Debug)]
pub(super) struct Patience {
    readings: u32,
    period_s: f64,
    moved_m: f64,
    /// The cosine of the angle that counts as a turn.
    turned_cos: f64,
    /// The pose from which the robot has not got ahead, and the number of readings since.
    from: Isometry2<f64>,
    waited: u32,
}

impl Patience {
    /// The patience of a robot that drives at `speed_mps`.
    pub(super) fn new(chassis: Chassis, speed_mps: f64) -> Self {
        let max_turn_radps = chassis.robot.drive.max_angular_radps;
        let turned_rad = PROGRESS_RAD.min(PROGRESS_SHARE * max_turn_radps * PATIENCE_S);
        Self {
            turned_cos: libm::cos(turned_rad),
            ..Self::with_place(chassis, speed_mps, PATIENCE_S, PROGRESS_M)
        }
    }

    /// The patience for a time, s, with a robot that does not leave a place of the radius `place_m`, whether it turns
    /// or not.
    pub(super) fn with_place(chassis: Chassis, speed_mps: f64, patience_s: f64, place_m: f64) -> Self {
        let period_s = chassis.period_s();
        Self {
            readings: (patience_s / period_s).ceil() as u32,
            period_s,
            moved_m: place_m.min(PROGRESS_SHARE * speed_mps * patience_s),
            turned_cos: f64::NEG_INFINITY,
            from: chassis.robot.pose,
            waited: 0,
        }
    }

    /// Shortens the wait that has begun anew to a time, s.
    pub(super) fn wait_again(&mut self, patience_s: f64) {
        self.waited = self.readings.saturating_sub((patience_s / self.period_s).ceil() as u32);
    }

    /// Whether the robot has waited too long at its pose. It then begins to wait anew.
    pub(super) fn is_over(&mut self, pose: &Isometry2<f64>) -> bool {
        let moved_m = (pose.translation.vector - self.from.translation.vector).norm();
        let turned = self.from.rotation.inverse() * pose.rotation;
        if moved_m > self.moved_m || turned.re < self.turned_cos {
            self.from = *pose;
            self.waited = 0;
        }
        self.waited += 1;
        let is_over = self.waited > self.readings;
        if is_over {
            self.waited = 0;
        }
        is_over
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![pose(&mut self.from), value(&mut self.waited)]
    }
}
