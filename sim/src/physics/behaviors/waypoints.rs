use super::Chassis;
use super::legs::{Legs, Patience};
use super::wander::Wander;
use crate::physics::spec::{Repeat, WanderSpec, WaypointsSpec};
use interfaces::{LaserReading, RandomStream, Twist, Values, values};
use nalgebra::Point2;
use std::ops::Range;

/// A waypoint counts as reached within this distance, m.
const ARRIVED_M: f64 = 0.02;
/// The free space that is kept beside the body, m: less than the distance that the legs are known to keep from
/// walls.
const SIDE_MARGIN_M: f64 = 0.03;

/// A robot that reached a waypoint this far from where it was blocked is out of that place, m.
const AWAY_M: f64 = 0.5;
/// The duration of a detour, s. At random, so that two robots do not meet again and again.
const DETOUR_S: Range<f64> = 3.0..10.0;
/// The duration of the detour after an escape, s.
const LONG_DETOUR_S: Range<f64> = 10.0..30.0;

/// Drives straight from point to point by odometry, turns in place at the points, and waits while the laser
/// measures an obstacle in the way.
///
/// A robot that has waited too long turns round: it visits the points in reverse order, since the leg behind it was
/// free. If it is blocked there as well, before it reached a point away from the first place, it makes a detour: it
/// wanders for some seconds, and then tries the next point. If it does not leave its place for long, it escapes, and
/// then makes a longer detour.
#[derive(Clone, Debug)]
pub(crate) struct Waypoints {
    spec: WaypointsSpec,
    legs: Legs,
    /// The index of the next point; `None` after the last one.
    next: Option<usize>,
    is_returning: bool,
    patience: Patience,
    /// The x and y at which the robot last turned round, m, until it is out of that place.
    turned_at: Option<Point2<f64>>,
    wander: Wander,
    /// The number of scans until the end of the detour.
    detour_scans: u32,
}

impl Waypoints {
    pub(super) fn new(spec: WaypointsSpec, chassis: Chassis, random: RandomStream) -> Self {
        let WaypointsSpec { speed_mps, clearance_m, .. } = spec;
        let wander = WanderSpec { speed_mps, clearance_m };
        Self {
            legs: Legs::new(chassis, speed_mps, clearance_m),
            next: Some(0),
            is_returning: false,
            patience: Patience::new(chassis, speed_mps),
            turned_at: None,
            wander: Wander::new(wander, chassis, random),
            detour_scans: 0,
            spec,
        }
    }

    /// The index of the point after `point`.
    fn after(&mut self, point: usize) -> Option<usize> {
        let last = self.spec.points.len() - 1;
        if self.spec.repeat == Repeat::Loop {
            let ahead = if self.is_returning { last } else { 1 };
            return Some((point + ahead) % (last + 1));
        }
        if self.spec.repeat == Repeat::Once && !self.is_returning && point == last {
            return None;
        }
        self.is_returning = if self.is_returning { point > 0 } else { point == last };
        Some(if self.is_returning { point.saturating_sub(1) } else { (point + 1).min(last) })
    }

    /// Continues in reverse order with the point before `next`.
    fn turn_round(&mut self, next: usize) {
        self.is_returning = !self.is_returning;
        self.next = self.after(next);
    }

    /// Ends a wait on the way to the point `next`.
    fn give_way(&mut self, at: &Point2<f64>, next: usize) {
        if self.turned_at.is_none() {
            self.turned_at = Some(*at);
            self.turn_round(next);
            return;
        }
        self.detour_scans = self.wander.scans(DETOUR_S);
        match self.after(next) {
            Some(after) => self.next = Some(after),
            // The last point remains to be reached.
            None => self.turn_round(next),
        }
    }

    /// The next point that is not reached yet; `None` after the last one.
    fn goal(&mut self, at: &Point2<f64>) -> Option<usize> {
        // At most one round: if all points are within reach, the robot has nothing to do.
        for _ in 0..self.spec.points.len() {
            let next = self.next.filter(|next| *next < self.spec.points.len())?;
            if (self.spec.points[next] - at).norm() >= ARRIVED_M {
                return Some(next);
            }
            self.turned_at = self.turned_at.filter(|turned_at| (at - turned_at).norm() < AWAY_M);
            self.next = self.after(next);
        }
        None
    }

    /// The velocity until the next reading.
    pub(super) fn decide(&mut self, reading: &LaserReading) -> Twist {
        let at = Point2::from(reading.pose.translation.vector);
        let goal = if self.detour_scans > 0 { self.next } else { self.goal(&at) };
        let Some(goal) = goal else { return Twist::STOP };
        if let Some(twist) = self.wander.escape(reading) {
            if self.detour_scans == 0 {
                self.detour_scans = self.wander.scans(LONG_DETOUR_S);
            }
            return twist;
        }
        if self.detour_scans > 0 {
            self.detour_scans -= 1;
            return self.wander.roam(reading);
        }
        if self.patience.is_over(&reading.pose) {
            self.give_way(&at, goal);
            return Twist::STOP;
        }
        let leg = self.spec.points[goal] - at;
        let remaining_m = leg.norm();
        self.legs.drive(reading, &(leg / remaining_m), remaining_m, |legs, scan| {
            (legs.free_m(scan, SIDE_MARGIN_M, remaining_m), 0.0)
        })
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        let Self { next, is_returning, turned_at, detour_scans, patience, wander, legs, .. } = self;
        values![*next, *is_returning, *turned_at, *detour_scans; patience, wander, legs]
    }
}
