//! Where what passes through a spot goes.
//!
//! The cells around a spot become blocked in the order in which something passes over them. A line through their times and
//! positions gives its velocity; its direction is counted in one of sixteen sectors. A change takes the same time whatever was
//! seen before.

use super::passages::{Key, SIDE_M, cell_key, spot_key};
use crate::change_log::events;
use interfaces::Event;
use mapper::{Mapper, share_interval};
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// What passes a spot is seen in this number of spots around it as well: in 1.5 m, a person is seen five times at 3 scans per
/// second.
const AROUND: i32 = 1;
/// Nothing became blocked for this time, s: what passed is gone.
const OVER_S: f64 = 1.5;
/// A passage needs this number of changes, at this number of times.
const MIN_CHANGES: u32 = 8;
const MIN_TIMES: u32 = 3;
/// The velocity explains at least this share of the variance of the times: less is two bodies, or one that turns.
const MIN_EXPLAINED: f64 = 0.5;
/// Slower things do not pass, and faster ones are errors, m/s.
const SPEEDS_MPS: std::ops::Range<f64> = 0.1..4.0;
/// The standard deviation of the positions along the way is at least this, m: that of a way of half a meter.
const MIN_SPREAD_M: f64 = 0.14;
/// The variance of a position across the way that says nothing, m²: a cell, and the edge of a body.
const NOISE_M2: f64 = 0.01;
/// The number of sectors of a full turn.
const SECTORS: usize = 16;
/// A direction is known from this number of passages on.
const MIN_PASSAGES: u32 = 5;
/// The mean resultant length of the axes of all passages is at least this: 0 if they go everywhere, 1 if all have the same axis.
const MIN_RESULTANT: f64 = 0.5;
/// The logarithm of the probability that the axes of passages without a common one agree as well (Rayleigh's test): 1 %.
const MIN_EVIDENCE: f64 = 4.6;
/// The probability with which the interval contains the share.
const MASS: f64 = 0.9;

/// Where most of what passes goes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Direction {
    /// The heading of most passages, rad.
    pub heading_rad: f64,
    /// The share of the passages along this axis that have this heading; the others go the opposite way.
    pub share: f64,
    /// The ends of the 90 % interval of this share.
    pub share_90: [f64; 2],
    /// The number of passages whose direction was seen.
    pub passages: u32,
    /// The number of these passages that go across.
    pub across: u32,
}

/// What passes a spot now: sums over the changes of the time since the first one, s, and of the position from the middle of the
/// spot, m, and of their products.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
struct Trace {
    begin_s: f64,
    last_s: f64,
    changes: u32,
    times: u32,
    /// Whether a cell of the spot itself has changed.
    is_inside: bool,
    sum: Vector3<f64>,
    products: Matrix3<f64>,
}

impl Trace {
    fn begin(now_s: f64) -> Self {
        Self { begin_s: now_s, last_s: f64::NEG_INFINITY, ..Self::default() }
    }

    fn add(&mut self, now_s: f64, [x_m, y_m]: [f64; 2], is_inside: bool) {
        let sample = Vector3::new(now_s - self.begin_s, x_m, y_m);
        self.times += u32::from(now_s > self.last_s);
        self.last_s = now_s;
        self.changes += 1;
        self.is_inside |= is_inside;
        self.sum += sample;
        self.products += sample * sample.transpose();
    }

    /// The heading of what has passed, rad; `None` if it cannot be told.
    fn heading_rad(&self) -> Option<f64> {
        if !self.is_inside || self.changes < MIN_CHANGES || self.times < MIN_TIMES {
            return None;
        }
        let mean = self.sum / f64::from(self.changes);
        let covariance = self.products / f64::from(self.changes) - mean * mean.transpose();
        let of_place: Matrix2<f64> = covariance.fixed_view::<2, 2>(1, 1).into();
        let with_time: Vector2<f64> = covariance.fixed_view::<2, 1>(1, 0).into();
        // The time is a linear function of the place; its gradient is the inverse of the velocity.
        let slowness = (of_place + Matrix2::identity() * NOISE_M2).try_inverse()? * with_time;
        let explained = slowness.dot(&with_time) / covariance[(0, 0)];
        let speed_mps = 1.0 / slowness.norm();
        let along = slowness * speed_mps;
        let spread_m = along.dot(&(of_place * along)).max(0.0).sqrt();
        let is_known =
            explained >= MIN_EXPLAINED && SPEEDS_MPS.contains(&speed_mps) && spread_m >= MIN_SPREAD_M;
        is_known.then(|| libm::atan2(along.y, along.x))
    }
}

/// The passages through each spot by their directions.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(crate) struct Directions {
    counts: BTreeMap<Key, [u32; SECTORS]>,
    traces: BTreeMap<Key, Trace>,
}

impl Directions {
    /// Learns from the changes of the last reading.
    pub(super) fn note(&mut self, mapper: &Mapper) {
        let (frame, now_s) = (mapper.frame(), mapper.time());
        let Self { counts, traces } = self;
        traces.retain(|spot, trace| {
            let is_over = now_s - trace.last_s > OVER_S;
            if is_over {
                count(counts, *spot, trace);
            }
            !is_over
        });
        for (index, _) in events(mapper).filter(|(_, event)| *event == Event::Block) {
            let (cell, own) = (cell_key(frame, index), spot_key(frame, index));
            for spot in own.square(AROUND) {
                let at =
                    [(cell.x, spot.x), (cell.y, spot.y)].map(|(cell, spot)| from_middle_m(cell, spot, frame));
                let trace = traces.entry(spot).or_insert_with(|| Trace::begin(now_s));
                trace.add(now_s, at, spot == own);
            }
        }
    }

    /// A new session begins: what passes now is not seen to its end.
    pub(super) fn begin_session(&mut self) {
        for (spot, trace) in std::mem::take(&mut self.traces) {
            count(&mut self.counts, spot, &trace);
        }
    }

    /// Where most of what passes a spot goes; `None` if too few passages were seen, or if they have no common axis.
    pub(super) fn of(&self, spot: Key) -> Option<Direction> {
        let mut counts = self.counts.get(&spot).copied().unwrap_or_default();
        // What passes now is not counted yet.
        let last = self.traces.get(&spot).and_then(Trace::heading_rad);
        last.into_iter().for_each(|heading_rad| counts[sector(heading_rad)] += 1);
        direction(&counts)
    }
}

fn count(counts: &mut BTreeMap<Key, [u32; SECTORS]>, spot: Key, trace: &Trace) {
    if let Some(heading_rad) = trace.heading_rad() {
        counts.entry(spot).or_default()[sector(heading_rad)] += 1;
    }
}

/// The position of a cell from the middle of a spot along one axis, m.
fn from_middle_m(cell: i32, spot: i32, frame: &interfaces::GridFrame) -> f64 {
    let cell_m = frame.resolution_m();
    let side = (SIDE_M / cell_m).round().max(1.0);
    (f64::from(cell) + 0.5 - (f64::from(spot) + 0.5) * side) * cell_m
}

fn sector(heading_rad: f64) -> usize {
    (heading_rad / TAU * SECTORS as f64).round().rem_euclid(SECTORS as f64) as usize
}

fn direction(counts: &[u32; SECTORS]) -> Option<Direction> {
    let passages: u32 = counts.iter().sum();
    let headings = counts.iter().enumerate().map(|(sector, &count)| {
        let heading_rad = sector as f64 / SECTORS as f64 * TAU;
        (heading_rad, f64::from(count))
    });
    // Twice the angle: opposite headings have the same axis (Mardia and Jupp, Directional Statistics, 2000).
    let sum = headings.clone().fold(Vector2::zeros(), |sum, (heading_rad, count)| {
        sum + Vector2::new(libm::cos(2.0 * heading_rad), libm::sin(2.0 * heading_rad)) * count
    });
    let resultant = sum.norm() / f64::from(passages.max(1));
    let is_common = resultant >= MIN_RESULTANT && f64::from(passages) * resultant.powi(2) >= MIN_EVIDENCE;
    if passages < MIN_PASSAGES || !is_common {
        return None;
    }
    let axis_rad = 0.5 * libm::atan2(sum.y, sum.x);
    let [mut along, mut against] = [0.0, 0.0];
    for (heading_rad, count) in headings {
        match libm::cos(heading_rad - axis_rad) {
            cos if cos > std::f64::consts::FRAC_1_SQRT_2 => along += count,
            cos if cos < -std::f64::consts::FRAC_1_SQRT_2 => against += count,
            _ => {}
        }
    }
    let opposite_rad = if against > along { std::f64::consts::PI } else { 0.0 };
    let (most, fewest) = (along.max(against), along.min(against));
    Some(Direction {
        heading_rad: interfaces::wrap_rad(axis_rad + opposite_rad),
        share: most / (most + fewest),
        share_90: share_interval([most, fewest], MASS),
        passages,
        across: passages - (along + against) as u32,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(of: &[(usize, u32)]) -> [u32; SECTORS] {
        let mut counts = [0; SECTORS];
        of.iter().for_each(|&(sector, count)| counts[sector] = count);
        counts
    }

    #[test]
    fn a_direction_needs_passages_with_a_common_axis() {
        let found = direction(&counts(&[(4, 15), (5, 1), (12, 4)])).unwrap();
        assert!((found.heading_rad - TAU / 4.0).abs() < 0.03, "{found:?}");
        assert_eq!((found.share, found.passages, found.across), (0.8, 20, 0));
        assert!(found.share_90[0] > 0.6 && found.share_90[1] < 0.92, "{found:?}");
        let crossed = direction(&counts(&[(0, 3), (8, 20), (4, 2)])).unwrap();
        assert!((crossed.heading_rad.abs() - TAU / 2.0).abs() < 1e-9 && crossed.across == 2, "{crossed:?}");
        for unknown in [counts(&[(3, 4)]), [5; SECTORS], counts(&[(0, 9), (4, 8)]), counts(&[])] {
            assert_eq!(direction(&unknown), None, "{unknown:?}");
        }
    }

    #[test]
    fn sectors_are_a_full_turn() {
        let at = |sector: f64| sector / SECTORS as f64 * TAU;
        assert_eq!([0.0, 4.4, 7.6, 15.6, -0.4, -1.0].map(|from| sector(at(from))), [0, 4, 8, 0, 0, 15]);
    }
}
