//! Numbers for beams without a return inside the limits of a laser: some drivers write 65.535 m, or a range below the maximum.

use std::collections::BTreeMap;

/// A code comes at least this often, and this many times as often as the next smaller and the next larger range: ranges of a real laser
/// came up to 41 times as often, but then only 205 times, and codes 1712 times.
const MIN_COUNT: u32 = 1000;
const MIN_RATIO: u32 = 20;
/// It comes beside ranges that are not near it in at least this many of 32 sectors of the field of view: beside a range of a surface is
/// the same surface, and the robot itself is seen in some directions only.
const MIN_SECTORS: u32 = 8;
/// Ranges that differ by less than this share can be of one surface.
const NEAR_SHARE: f32 = 0.05;
/// The most different ranges that are counted; of more, the rare ones are forgotten (lossy counting, Manku & Motwani 2002). Lasers that
/// measure millimeters have fewer.
const MAX_VALUES: usize = 1 << 16;

/// Counts the ranges of the scans of a log. Its lasers are counted together: mostly, they have one driver.
#[derive(Debug, Default)]
pub(crate) struct Codes {
    /// For each range, by its bits, which are in the order of the ranges: how often it comes, and the sectors (bits) in which a range
    /// beside it is not near it.
    values: BTreeMap<u32, (u32, u32)>,
    /// Ranges that came at most this often were forgotten.
    forgotten: u32,
    /// The codes, at the end, m.
    pub(crate) found: Vec<f32>,
}

impl Codes {
    /// Adds the ranges of the next scan.
    pub(crate) fn add(&mut self, ranges_m: &[f32]) {
        for (beam, &range_m) in ranges_m.iter().enumerate().filter(|(_, it)| it.is_finite() && **it > 0.0) {
            if self.values.len() == MAX_VALUES {
                self.forgotten += 1;
                self.values.retain(|_, (count, _)| *count > self.forgotten);
            }
            let (count, sectors) = self.values.entry(range_m.to_bits()).or_default();
            *count = count.saturating_add(1);
            let is_near = |other_m: &f32| (other_m - range_m).abs() < NEAR_SHARE * range_m;
            let mut beside = ranges_m[beam.saturating_sub(1)..ranges_m.len().min(beam + 2)].iter();
            *sectors |= u32::from(!beside.all(is_near)) << (32 * beam / ranges_m.len());
        }
    }

    /// Ends the log; returns what to note.
    pub(crate) fn finish(&mut self) -> Vec<String> {
        let values = std::mem::take(&mut self.values);
        let is_code = |(bits, (count, sectors)): &(&u32, &(u32, u32))| {
            let beside = [values.range(..*bits).next_back(), values.range(*bits + 1..).next()];
            *count >= MIN_COUNT
                && sectors.count_ones() >= MIN_SECTORS
                && beside.into_iter().flatten().all(|(_, (other, _))| *other <= count / MIN_RATIO)
        };
        self.found = values.iter().filter(is_code).map(|(bits, _)| f32::from_bits(*bits)).collect();
        let means =
            "in all directions, without a surface beside it: it is a number for beams without a return";
        let note = |m: &f32| format!("the range {m} m comes more than {MIN_COUNT} times, {means}");
        self.found.iter().map(note).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEAMS: usize = 90;

    /// What a robot sees that drives 4 m through a room of 6 m while it turns, and stands from half of the way on for as long again. Ranges
    /// are multiples of `step_m` (0: exact), after noise up to `noise_m`; through an opening, nothing comes back.
    fn codes_of(step_m: f64, noise_m: f64, no_return: f32, moves: bool) -> Vec<f32> {
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
            codes.add(&ranges_m);
        }
        assert_eq!(codes.finish().len(), codes.found.len());
        codes.found
    }

    #[test]
    fn one_number_in_all_directions_without_a_surface_beside_it_is_a_code() {
        for code in [65.535, 5.999, 2.85] {
            // Millimeters, and more different ranges than are counted: the rare ones are forgotten.
            for step_m in [0.001, 0.0] {
                let found = codes_of(step_m, 0.03, code, true);
                assert_eq!(found, [code], "{step_m}");
            }
        }
    }

    #[test]
    fn ranges_that_are_measured_are_no_codes() {
        for (step_m, noise_m) in [(0.0, 0.0), (0.001, 0.0), (0.01, 0.0), (0.01, 0.03), (0.05, 0.02)] {
            assert_eq!(codes_of(step_m, noise_m, f32::INFINITY, true), [0.0; 0], "{step_m} {noise_m}");
            // Of a robot that stands, every range can be measured.
            assert_eq!(codes_of(step_m, noise_m, 5.999, false), [0.0; 0], "{step_m} {noise_m}");
        }
    }
}
