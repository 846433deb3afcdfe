//! Numbers for beams without a return inside the limits of a laser: some drivers write 65.535 m, or a range below the maximum.

use interfaces::Scan;
use nalgebra::{Isometry2, Point2};
use std::collections::BTreeMap;
use std::ops::Bound::{Excluded, Unbounded};

/// A code comes at least this often, and this many times as often as the next smaller and the next larger range of the laser: ranges
/// of a real laser come up to 41 times as often, but then only 205 times, and codes 1712 times.
const MIN_COUNT: u32 = 1000;
const MIN_RATIO: u32 = 20;
/// It comes in at least this many of 32 sectors of the field of view: the robot itself is seen in some directions only.
const MIN_SECTORS: u32 = 8;
/// It comes from poses that are this far apart, m.
const APART_M: f64 = 1.0;
/// At least this share of the other ranges beside it are not near it: beside a range of a surface is the same surface.
const MIN_FAR_SHARE: f64 = 0.75;
/// Ranges that differ by less than this share can be of one surface.
const NEAR_SHARE: f32 = 0.05;
/// The most different ranges of a laser that are counted; of more, the rare ones are forgotten (lossy counting, Manku & Motwani 2002).
/// Lasers that measure millimeters have fewer.
const MAX_VALUES: usize = 1 << 16;
/// Lasers beyond this number have no codes.
const MAX_LASERS: usize = 8;

/// How often a range comes, and where.
#[derive(Debug, Default)]
struct Value {
    count: u32,
    sectors: u32,
    first: Point2<f64>,
    is_apart: bool,
    /// The other ranges beside it that are near it, and those that are not.
    near: u32,
    far: u32,
}

/// A range of a laser that means no return.
#[derive(Clone, Debug)]
pub(crate) struct Code {
    /// `None`: of all lasers.
    mount: Option<Isometry2<f64>>,
    range_m: f32,
    count: u32,
}

impl Code {
    /// Turns the code into no return in a scan.
    pub(crate) fn remove(&self, mount: &Isometry2<f64>, ranges_m: &mut [f32]) {
        if self.mount.is_none_or(|of| of == *mount) {
            ranges_m.iter_mut().filter(|it| **it == self.range_m).for_each(|it| *it = f32::INFINITY);
        }
    }

    /// What to note.
    pub(crate) fn note(&self) -> String {
        let Self { range_m, count, .. } = self;
        format!(
            "the range {range_m} m comes {count} times, in all directions and without a surface beside it: it is a number for beams \
             without a return, which count as such"
        )
    }
}

/// The ranges of one laser.
#[derive(Debug, Default)]
struct Laser {
    mount: Option<Isometry2<f64>>,
    /// By their bits, which are in the order of the ranges.
    values: BTreeMap<u32, Value>,
    /// Ranges that came at most this often were forgotten.
    forgotten: u32,
}

/// Counts the ranges of the scans of a log.
#[derive(Debug, Default)]
pub(crate) struct Codes(Vec<Laser>);

impl Codes {
    /// Adds the next scan of the laser with this mount.
    pub(crate) fn add(&mut self, pose: &Isometry2<f64>, mount: Option<Isometry2<f64>>, scan: &Scan) {
        let known = self.0.iter().position(|laser| laser.mount == mount);
        let number = known.unwrap_or(self.0.len());
        if number == MAX_LASERS {
            return;
        }
        if known.is_none() {
            self.0.push(Laser { mount, ..Laser::default() });
        }
        let Laser { values, forgotten, .. } = &mut self.0[number];
        let (at, ranges_m) = (Point2::from(pose.translation.vector), &scan.ranges_m);
        for (beam, &range_m) in ranges_m.iter().enumerate().filter(|(_, it)| it.is_finite() && **it > 0.0) {
            if values.len() == MAX_VALUES {
                *forgotten += 1;
                values.retain(|_, value| value.count > *forgotten);
            }
            let new = || Value { first: at, ..Value::default() };
            let value = values.entry(range_m.to_bits()).or_insert_with(new);
            value.count = value.count.saturating_add(1);
            value.sectors |= 1 << (32 * beam / ranges_m.len());
            value.is_apart |= (at - value.first).norm() >= APART_M;
            let beside = [beam.checked_sub(1), Some(beam + 1)].into_iter().flatten();
            for other_m in beside.filter_map(|beside| ranges_m.get(beside)).filter(|other| **other != range_m)
            {
                let is_near = (other_m - range_m).abs() < NEAR_SHARE * range_m;
                let count = if is_near { &mut value.near } else { &mut value.far };
                *count = count.saturating_add(1);
            }
        }
    }

    /// The codes, in the order of the lasers and the ranges.
    pub(crate) fn finish(self) -> Vec<Code> {
        let of_laser = |laser: &Laser| {
            let Laser { mount, values, .. } = laser;
            let count = |next: Option<(&u32, &Value)>| next.map_or(0, |(_, value)| value.count);
            let is_code = |(bits, value): &(&u32, &Value)| {
                let below = count(values.range(..*bits).next_back());
                let above = count(values.range((Excluded(*bits), Unbounded)).next());
                value.count >= MIN_COUNT
                    && value.count / MIN_RATIO >= below.max(above)
                    && value.sectors.count_ones() >= MIN_SECTORS
                    && value.is_apart
                    && f64::from(value.far) >= MIN_FAR_SHARE * (f64::from(value.near) + f64::from(value.far))
            };
            let codes = values.iter().filter(is_code);
            codes
                .map(|(bits, value)| Code {
                    mount: *mount,
                    range_m: f32::from_bits(*bits),
                    count: value.count,
                })
                .collect()
        };
        self.0.iter().flat_map(|laser| -> Vec<Code> { of_laser(laser) }).collect()
    }
}
