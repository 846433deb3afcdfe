//! Numbers for beams without a return inside the limits of a laser: some drivers write 65.535 m, or a range below the maximum.

use interfaces::Scan;
use nalgebra::{Isometry2, Point2};
use std::collections::BTreeMap;
use std::ops::Bound::{Excluded, Unbounded};

/// A code comes at least this often, and this many times as often as the next smaller and the next larger range of the laser: ranges
/// of a real laser come up to 41 times as often, but then only 205 times, and codes 1712 times.
const MIN_COUNT: u32 = 1000;
const MIN_RATIO: u32 = 20;
/// A laser measures at least this many different ranges: of fewer, as of a drawing, each can be a surface.
const MIN_VALUES: usize = 100;
/// It comes without a surface beside it in at least this many of 32 sectors of the field of view: the robot itself is seen in some directions only.
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
    /// The sectors in which a range beside it is not near it.
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
            value.is_apart |= (at - value.first).norm() >= APART_M;
            let beside = [beam.checked_sub(1), Some(beam + 1)].into_iter().flatten();
            for other_m in beside.filter_map(|beside| ranges_m.get(beside)).filter(|other| **other != range_m)
            {
                let is_near = (other_m - range_m).abs() < NEAR_SHARE * range_m;
                let count = if is_near { &mut value.near } else { &mut value.far };
                *count = count.saturating_add(1);
                value.sectors |= u32::from(!is_near) << (32 * beam / ranges_m.len());
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
                values.len() >= MIN_VALUES
                    && value.count >= MIN_COUNT
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

#[cfg(test)]
mod tests {
    use super::*;

    const BEAMS: usize = 90;

    /// What a robot sees that drives 4 m through a room of 6 m while it turns, and stands from half of the way on for as long again. Ranges
    /// are multiples of `step_m` (0: exact), after noise up to `noise_m`; through an opening, nothing comes back.
    fn codes_of(step_m: f64, noise_m: f64, no_return: f32, moves: bool) -> Vec<(f32, u32)> {
        let mut codes = Codes::default();
        let mut random = 1_u64;
        for number in 0..1600_u32 {
            let driven = f64::from(if moves { number.min(800) + number.saturating_sub(1200) } else { 0 });
            let pose = interfaces::pose(driven / 300.0 - 2.0, 0.5, driven * 0.05);
            let range_m = |beam: usize| {
                let angle_rad = driven * 0.05 + beam as f64 * 0.07;
                let (sin, cos) = angle_rad.sin_cos();
                let (at, to) =
                    (pose.translation.vector, |at: f64, along: f64| (3.0_f64.copysign(along) - at) / along);
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let noise_m = noise_m * (random >> 33) as f64 / (1_u64 << 31) as f64;
                let exact_m = to(at.x, cos).min(to(at.y, sin)) + noise_m;
                let measured_m = if step_m > 0.0 { (exact_m / step_m).round() * step_m } else { exact_m };
                if interfaces::wrap_rad(angle_rad).abs() < 0.2 { no_return } else { measured_m as f32 }
            };
            let mut ranges_m: Vec<f32> = (0..BEAMS).map(range_m).collect();
            // Posts of the robot itself.
            [3, 30, 33, 60].into_iter().for_each(|beam| ranges_m[beam] = 0.25);
            codes.add(&pose, None, &Scan { ranges_m, ..Scan::default() });
        }
        codes.finish().iter().map(|code| (code.range_m, code.count)).collect()
    }

    #[test]
    fn one_number_in_all_directions_without_a_surface_beside_it_is_a_code() {
        for code in [65.535, 5.999, 2.85] {
            // Millimeters, and so many different ranges that the rare ones are forgotten.
            for step_m in [0.001, 0.0] {
                let found = codes_of(step_m, 0.03, code, true);
                assert!(
                    matches!(found[..], [(range_m, 4000..)] if range_m == code),
                    "{step_m} {code}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn ranges_that_are_measured_are_no_codes() {
        for (step_m, noise_m) in [(0.0, 0.0), (0.001, 0.0), (0.01, 0.0), (0.01, 0.03), (0.05, 0.02)] {
            assert_eq!(codes_of(step_m, noise_m, f32::INFINITY, true), [], "{step_m} {noise_m}");
            // Of a robot that stands, every range can be measured.
            assert_eq!(codes_of(step_m, noise_m, 5.999, false), [], "{step_m} {noise_m}");
        }
    }

    #[test]
    fn a_code_becomes_no_return_for_its_laser_only() {
        let mounts = [0.1, 0.2].map(|x| interfaces::pose(x, 0.0, 0.0));
        let code = Code { mount: Some(mounts[0]), range_m: 2.85, count: 1000 };
        let removed = |mount| {
            let mut ranges_m = [2.85, 2.851];
            code.remove(mount, &mut ranges_m);
            ranges_m
        };
        assert_eq!([removed(&mounts[0]), removed(&mounts[1])], [[f32::INFINITY, 2.851], [2.85, 2.851]]);
    }
}
