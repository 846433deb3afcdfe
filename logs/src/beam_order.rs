//! In which order a spinning laser measures its beams. Many drivers reverse the beams of a scan and not their times, or deskew the
//! scan and keep `time_increment`.

use interfaces::{LaserReading, Scan, approximate_atan2, heading_rad, rotation};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::TAU;

/// The turn of the robot during a scan, rad: below the first, the scan is a reference; above the second, the order shows.
const STANDS_RAD: f64 = 0.005;
const TURNS_RAD: f64 = 0.03;
/// Scans are compared with a reference at most this far away, m.
const MAX_AWAY_M: f64 = 0.15;
/// The longest time between two scans of which the rate of the turn is known, s.
const MAX_PAUSE_S: f64 = 0.5;
/// The heading by odometry can be off by this much, rad: drift, and a clock that is late.
const MAX_OFF_RAD: f64 = 0.3;
/// Steps in which the heading is searched, rad, and the number of beams that are compared.
const STEPS_RAD: [f64; 2] = [0.02, 0.004];
const BEAMS: usize = 360;
/// Differences of ranges count up to this, m.
const MAX_DIFFERENCE_M: f64 = 0.3;
/// At least this number of scans in turns to the left, and to the right: turns to one side alone look like a clock that is late. Further scans
/// are not compared.
const MIN_SCANS: usize = 6;
const MAX_SCANS: usize = 200;
/// Another order is taken if its scans differ from the references by less than this share of the difference in the order as written.
const CLEARLY: f64 = 0.7;

/// How the beams of a scan follow each other in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Order {
    /// As written: the first beam first.
    #[default]
    Written,
    /// The last beam first.
    Reversed,
    /// All at once: the scan is deskewed already.
    AtOnce,
}

const ORDERS: [Order; 3] = [Order::Written, Order::Reversed, Order::AtOnce];

impl Order {
    /// The share of the scan that is left when a beam is measured.
    fn left(self, beam: usize, beams: usize) -> f64 {
        let passed = beam as f64 / (beams.max(2) - 1) as f64;
        match self {
            Self::Written => 1.0 - passed,
            Self::Reversed => passed,
            Self::AtOnce => 0.0,
        }
    }

    fn note(self) -> Option<&'static str> {
        match self {
            Self::Written => None,
            Self::Reversed => Some(
                "on turns, the scans fit only if the last beam of a message is measured first: they are used in this order; the driver reverses \
                 the beams (parameters as `inverted` or `reversion`) and not their times: its time_increment must be negative",
            ),
            Self::AtOnce => Some(
                "on turns, the scans fit only if all beams of a message are measured at once: they are not deskewed; if the driver does that \
                 already, its time_increment must be 0",
            ),
        }
    }
}

/// Finds the order of the beams of a laser, from the scans of a robot that turns, by its odometry.
#[derive(Clone, Debug, Default)]
pub(crate) struct BeamOrder {
    /// The time of the last scan, s, and the pose of the laser.
    last: Option<(f64, Isometry2<f64>)>,
    /// The last scan at rest, and the pose of the laser.
    reference: Option<(Isometry2<f64>, Scan)>,
    /// The sums of the differences from references, m, for each order.
    differences_m: [f64; ORDERS.len()],
    /// The scans that were compared in turns to the left and to the right.
    scans: [usize; 2],
    order: Order,
}

impl BeamOrder {
    /// Learns from the next reading, as it was measured.
    pub(crate) fn add(&mut self, reading: &LaserReading) {
        if reading.scan.sweep_s == 0.0 || reading.scan.check().is_err() {
            return;
        }
        let (pose, scan) = (reading.pose * reading.mount, &reading.scan);
        let Some((last_s, last)) = self.last.replace((reading.time_s, pose)) else { return };
        let elapsed_s = reading.time_s - last_s;
        if !(elapsed_s > 0.0 && elapsed_s <= MAX_PAUSE_S) {
            self.reference = None;
            return;
        }
        let skew_rad = heading_rad(&last.inv_mul(&pose)) * scan.sweep_s / elapsed_s;
        if skew_rad.abs() < STANDS_RAD {
            self.reference = Some((pose, scan.clone()));
            return;
        }
        let Some((at, reference)) = self.reference.as_ref().filter(|_| skew_rad.abs() >= TURNS_RAD) else {
            return;
        };
        let motion = at.inv_mul(&pose);
        let side = usize::from(skew_rad < 0.0);
        if motion.translation.vector.norm() < MAX_AWAY_M && self.scans[side] < MAX_SCANS {
            let differences_m = ORDERS.map(|order| difference_m(reference, scan, order, &motion, skew_rad));
            let [Some(_), Some(_), Some(_)] = differences_m else { return };
            self.differences_m.iter_mut().zip(differences_m).for_each(|(sum, m)| *sum += m.unwrap_or(0.0));
            self.scans[side] += 1;
        }
    }

    /// Decides by the scans so far what [`apply`](Self::apply) does. Returns a note if that is another order than before.
    pub(crate) fn judge(&mut self) -> Option<String> {
        let before = self.order;
        let [written_m, ..] = self.differences_m;
        let ranked = ORDERS.into_iter().zip(self.differences_m);
        let (order, best_m) = ranked.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        let is_clear = self.scans.iter().all(|scans| *scans >= MIN_SCANS) && best_m < CLEARLY * written_m;
        self.order = if is_clear { order } else { Order::Written };
        self.order.note().filter(|_| self.order != before).map(str::to_owned)
    }

    /// Puts the beams of a scan in the order in which they are measured.
    pub(crate) fn apply(&self, reading: &mut LaserReading) {
        let scan = &mut reading.scan;
        match self.order {
            Order::Written => {}
            Order::Reversed => {
                scan.angle_min_rad = scan.angle_rad(scan.ranges_m.len().saturating_sub(1));
                scan.angle_increment_rad = -scan.angle_increment_rad;
                scan.ranges_m.reverse();
            }
            Order::AtOnce => scan.sweep_s = 0.0,
        }
    }
}

/// The mean difference of the ranges of a scan from those of a reference, in the heading in which they differ least, m. The laser has
/// moved by `motion` since the reference, and turned by `skew_rad` during the scan. `None` if too few beams can be compared.
fn difference_m(
    reference: &Scan,
    scan: &Scan,
    order: Order,
    motion: &Isometry2<f64>,
    skew_rad: f64,
) -> Option<f64> {
    let beams = scan.ranges_m.len();
    let end = |beam: usize| {
        let angle_rad = scan.angle_rad(beam) - skew_rad * order.left(beam, beams);
        let at =
            motion * Point2::from(rotation(angle_rad) * Vector2::new(f64::from(scan.ranges_m[beam]), 0.0));
        (approximate_atan2(at.y, at.x), at.coords.norm())
    };
    let compared = (0..beams).step_by(beams.div_ceil(BEAMS).max(1));
    let ends: Vec<_> = compared.filter(|beam| scan.ranges_m[*beam].is_finite()).map(end).collect();
    let around = TAU / reference.angle_increment_rad.abs();
    let of_heading = |off_rad: f64| {
        let (mut sum_m, mut count) = (0.0, 0);
        for (angle_rad, range_m) in &ends {
            let step = (angle_rad + off_rad - reference.angle_min_rad) / reference.angle_increment_rad;
            let known_m = reference.ranges_m.get(step.rem_euclid(around).round() as usize);
            if let Some(known_m) = known_m.filter(|known_m| known_m.is_finite()) {
                sum_m += (range_m - f64::from(*known_m)).abs().min(MAX_DIFFERENCE_M);
                count += 1;
            }
        }
        if 4 * count >= ends.len().max(40) { sum_m / count as f64 } else { f64::INFINITY }
    };
    let mut best = (of_heading(0.0), 0.0);
    let mut reach_rad = MAX_OFF_RAD + skew_rad.abs();
    for step_rad in STEPS_RAD {
        let (center_rad, steps) = (best.1, (reach_rad / step_rad) as i32);
        for step in -steps..=steps {
            let off_rad = center_rad + f64::from(step) * step_rad;
            let difference_m = of_heading(off_rad);
            if difference_m < best.0 {
                best = (difference_m, off_rad);
            }
        }
        reach_rad = step_rad;
    }
    best.0.is_finite().then_some(best.0)
}

#[cfg(test)]
mod tests;
