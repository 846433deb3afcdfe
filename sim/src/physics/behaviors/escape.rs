use super::Chassis;
use super::legs::{LegScan, Legs, NARROW_SHARE, Patience};
use interfaces::{LaserReading, RandomStream, Twist, Values, values};
use nalgebra::{Point2, UnitComplex, Vector2};
use std::f64::consts::{PI, TAU};

/// A robot that stays within this distance, m, for this time, s, and the time of a full turn, does not get away by
/// its usual rules. The distance is twice that of a robot that is said to stand: otherwise a short move ends the wait,
/// although the robot remains in a place of that size.
const PLACE_M: f64 = 0.2;
const STANDS_S: f64 = 25.0;
/// The time between two attempts, s.
const RETRY_S: f64 = 5.0;
/// The longest distance of an escape, m.
const FAR_M: f64 = 1.0;
/// The free space that is kept ahead and beside the body, m.
const CLEARANCE_M: f64 = 0.02;
const SIDE_MARGIN_M: f64 = 0.005;
/// The number of directions that are compared, at most.
const DIRECTIONS: usize = 90;

/// The direction of an escape, a unit vector, and its end, m.
type Leg = (Vector2<f64>, Point2<f64>);

/// Ends a standstill: a robot that does not leave its place, whether it turns or not, turns to a direction in which
/// the laser sees space, and drives there slowly.
///
/// The direction is random: the farther it is free, the more probable. A fixed choice could lead back and forth
/// between two dead ends.
#[derive(Clone, Debug)]
pub(super) struct Escape {
    patience: Patience,
    pub(super) legs: Legs,
    /// During an escape.
    leg: Option<Leg>,
    /// The number of scans until the end of the escape at the latest, and that number at its start.
    scans_left: u32,
    most_scans: u32,
}

impl Escape {
    /// The escapes of a robot whose usual speed is `speed_mps`.
    pub(super) fn new(chassis: Chassis, speed_mps: f64) -> Self {
        let (slow_mps, turn_radps) = (NARROW_SHARE * speed_mps, chassis.robot.drive.max_angular_radps);
        // Twice the time that is needed if nothing holds the robot back.
        let most_s = 2.0 * (PI / turn_radps + FAR_M / slow_mps);
        Self {
            patience: Patience::with_place(chassis, speed_mps, STANDS_S + TAU / turn_radps, PLACE_M),
            legs: Legs::new(chassis, slow_mps, CLEARANCE_M),
            leg: None,
            scans_left: 0,
            most_scans: (most_s / chassis.period_s()).ceil() as u32,
        }
    }

    /// The velocity until the next reading, if the robot is escaping. To be called once for each reading.
    pub(super) fn drive(&mut self, reading: &LaserReading, random: &mut RandomStream) -> Option<Twist> {
        let stands = self.patience.is_over(&reading.pose);
        if stands {
            self.patience.wait_again(RETRY_S);
        }
        if stands && self.leg.is_none() {
            self.leg = self.free_leg(reading, random);
            self.scans_left = self.most_scans;
            self.legs.start_turning();
        }
        let (along, end) = self.leg?;
        let remaining_m = along.dot(&(end - Point2::from(reading.pose.translation.vector)));
        self.scans_left = self.scans_left.saturating_sub(1);
        let twist = self.legs.drive(reading, &along, remaining_m, |legs, scan| {
            (legs.free_m(scan, SIDE_MARGIN_M, remaining_m), 0.0)
        });
        if remaining_m < CLEARANCE_M || self.scans_left == 0 || self.legs.blocked {
            self.leg = None;
        }
        Some(twist)
    }

    /// A random free direction among those of the beams, and the end of the way there.
    fn free_leg(&self, reading: &LaserReading, random: &mut RandomStream) -> Option<Leg> {
        let beams = &self.legs.beams;
        let ways: Vec<(Vector2<f64>, f64)> = beams
            .iter()
            .step_by(beams.len().div_ceil(DIRECTIONS))
            .map(|beam| {
                let lean = UnitComplex::from_cos_sin_unchecked(beam.x, beam.y).inverse();
                let scan = LegScan { reading, lean };
                let free_m = self.legs.free_m(&scan, SIDE_MARGIN_M, f64::INFINITY) - self.legs.needed_m();
                (reading.pose.rotation * beam, free_m.clamp(0.0, FAR_M))
            })
            .collect();
        // Squared: a long way out of a narrow place has few directions.
        let total: f64 = ways.iter().map(|(_, way_m)| way_m * way_m).sum();
        let mut drawn = if total > 0.0 { random.uniform(0.0..total) } else { return None };
        let (along, way_m) = ways.iter().find(|(_, way_m)| {
            drawn -= way_m * way_m;
            drawn < 0.0
        })?;
        Some((*along, (reading.pose.translation.vector + along * *way_m).into()))
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        values![self.leg, self.scans_left; self.patience, self.legs]
    }
}
