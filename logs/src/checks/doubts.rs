//! What cannot be true of a log, as far as its numbers show it before anything is mapped.

use nalgebra::Isometry2;
use std::collections::{HashSet, VecDeque};
use xxhash_rust::xxh3::{xxh3_64, xxh3_64_with_seed};

/// Ranges whose median is beyond these are no meters: no laser of a robot is so far from what it sees, or so near.
const FARTHEST_M: f32 = 100.0;
const NEAREST_M: f32 = 0.05;
/// Larger numbers are millimeters, others centimeters: of most scans, since near a wall millimeters are small too.
const MIN_MILLIMETERS: f32 = 1000.0;
/// The units that ranges may be in instead of meters: the name, what the medians of ranges are then, the factor to meters, and what to
/// do.
const OTHER_UNITS: [(&str, &str, f32, &str); 3] = [
    ("kilometers", "below 0.05 m", 1000.0, "multiply them by 1000"),
    ("centimeters", "beyond 100 m", 0.01, "divide them by 100"),
    ("millimeters", "beyond 100 m", 0.001, "divide them by 1000"),
];
/// A log contains a part twice if this number of scans, and this share, come twice after the same scan. Scans that are as one
/// of the last ones are those of a robot that stands.
const MIN_REPEATED: usize = 20;
const MIN_REPEATED_SHARE: f64 = 0.2;
const RECENT: usize = 8;
/// The most scans that are compared.
const MAX_COMPARED: usize = 1 << 22;
/// A scan with fewer ranges says nothing about their unit.
const MIN_RANGES: usize = 10;
/// Times of the odometry that go back in this share of the steps are no times; they are near those of the scans, s.
const MAX_BACKWARD_SHARE: f64 = 0.1;
const NEAR_S: f64 = 10.0;
/// At least this number of ODOM lines is compared.
const MIN_LINES: usize = 20;

/// What the scans of a log say about each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Doubts {
    scans: usize,
    /// Scans with a range.
    seeing: usize,
    /// For each of the other units the scans whose ranges look like it, and the median range of the first one.
    in_unit: [(usize, f32); OTHER_UNITS.len()],
    /// The hashes of the last scans, and of all that came after another scan; the number of those that came twice.
    recent: VecDeque<u64>,
    moved: HashSet<u64>,
    repeated: usize,
}

impl Doubts {
    /// Adds a scan: the [`typical`] range as written, and the ranges that are used.
    pub(crate) fn add(&mut self, typical: Option<f32>, ranges_m: &[f32]) {
        self.scans += 1;
        self.seeing += usize::from(ranges_m.iter().any(|range_m| range_m.is_finite() && *range_m > 0.0));
        if let Some(typical) = typical.filter(|typical| !(NEAREST_M..=FARTHEST_M).contains(typical)) {
            let unit = usize::from(typical > FARTHEST_M) + usize::from(typical >= MIN_MILLIMETERS);
            let (count, first) = &mut self.in_unit[unit];
            if *count == 0 {
                *first = typical;
            }
            *count += 1;
        }
        self.compare(xxh3_64(
            &ranges_m.iter().flat_map(|range_m| range_m.to_le_bytes()).collect::<Vec<u8>>(),
        ));
    }

    fn compare(&mut self, scan: u64) {
        if self.recent.contains(&scan) || self.moved.len() == MAX_COMPARED {
            return;
        }
        if let Some(before) = self.recent.back() {
            let both = xxh3_64_with_seed(&before.to_le_bytes(), scan);
            self.repeated += usize::from(!self.moved.insert(both));
        }
        self.recent.push_back(scan);
        if self.recent.len() > RECENT {
            self.recent.pop_front();
        }
    }

    /// Why no map can be made of these scans, beside `invalid` ones. `stands`: whether the laser stands.
    pub(crate) fn impossible(&self, invalid: usize, stands: bool) -> Option<String> {
        let Self { scans, seeing, repeated, .. } = *self;
        let all = scans + invalid;
        let beyond: usize = self.in_unit.iter().map(|(count, _)| count).sum();
        if beyond * 2 > scans {
            return Some(self.other_unit(beyond));
        }
        if seeing == 0 {
            return Some(format!(
                "none of {scans} scans has a range between the limits of the laser: nothing is seen"
            ));
        }
        if invalid > scans {
            return Some(format!("{invalid} of {all} scans are invalid: what is left is no log of a place"));
        }
        let moved = self.moved.len() + repeated;
        if !stands && repeated >= MIN_REPEATED && repeated as f64 > MIN_REPEATED_SHARE * moved as f64 {
            return Some(format!(
                "{repeated} of {scans} scans are in the log twice, after the same scan as the first time: they would count \
                 twice; leave them out"
            ));
        }
        (scans == 1).then(|| "one scan: what changes is found by comparing scans, at least 2".to_owned())
    }

    /// That most ranges are not in meters, and what they are in by most of these scans.
    fn other_unit(&self, beyond: usize) -> String {
        let most = self.in_unit.iter().zip(OTHER_UNITS).max_by_key(|((count, _), _)| *count);
        let ((_, first), (unit, medians, to_meters, what)) = most.unwrap_or((&(0, 0.0), OTHER_UNITS[0]));
        format!(
            "the ranges look like {unit}: in {beyond} of {} scans, their median is {medians} (the first: {first}, which \
             would be {:.2} m); ranges are in meters: {what}",
            self.scans,
            first * to_meters
        )
    }
}

/// The median of the ranges as written, without those that are no measurement: many lasers write one large number where
/// nothing comes back. `None` if there are too few.
pub(crate) fn typical(ranges: impl Iterator<Item = f32>) -> Option<f32> {
    let mut ranges: Vec<f32> = ranges.filter(|range| range.is_finite() && *range > 0.0).collect();
    let largest = ranges.iter().copied().fold(0.0, f32::max);
    ranges.retain(|range| *range < largest);
    let middle = ranges.len() / 2;
    (ranges.len() >= MIN_RANGES).then(|| *ranges.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// Compares the times of ODOM lines, and their x, with the times of the scans.
#[derive(Clone, Debug, Default)]
pub(crate) struct OdometryTimes {
    last_s: Option<f64>,
    /// The lines that were compared, those whose time goes back, and those whose time and whose x is near that of a scan.
    lines: usize,
    back: usize,
    times_near: usize,
    x_near: usize,
}

impl OdometryTimes {
    /// Adds a line after the scan of this time.
    pub(crate) fn add(&mut self, time_s: f64, pose: &Isometry2<f64>, scan_s: f64) {
        let x = pose.translation.x;
        if x == 0.0 {
            return; // Corrected logs have lines without a time.
        }
        self.lines += 1;
        self.back += usize::from(self.last_s.replace(time_s).is_some_and(|last_s| time_s < last_s));
        self.times_near += usize::from((time_s - scan_s).abs() < NEAR_S);
        self.x_near += usize::from((x - scan_s).abs() < NEAR_S);
    }

    /// Why these are no times, if it is sure: they go back, and x goes ahead as the times of the scans do.
    pub(crate) fn impossible(&self, scans_s: &[f64]) -> Option<String> {
        let Self { lines, back, times_near, x_near, .. } = *self;
        let span_s = scans_s.first().zip(scans_s.last()).map_or(0.0, |(begin_s, end_s)| end_s - begin_s);
        let share = |count: usize| count as f64 / lines as f64;
        let is_swapped = lines >= MIN_LINES
            && span_s > 2.0 * NEAR_S
            && share(back) > MAX_BACKWARD_SHARE
            && share(x_near) > 1.0 - MAX_BACKWARD_SHARE
            && share(times_near) < 0.5;
        is_swapped.then(|| {
            format!(
                "x and the time look exchanged in the ODOM lines: in {back} of {lines}, the time goes back, while in {x_near} x is \
                 within {NEAR_S} s of the time of the scan before; a line is `ODOM x y theta tv rv accel time host logger_time`"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_is_that_of_most_scans() {
        let mut doubts = Doubts::default();
        // The first scan is near a wall: 0.9 m.
        for (scan, typical) in [900.0, 2500.0, 3100.0].into_iter().enumerate() {
            doubts.add(Some(typical), &[1.0 + scan as f32]);
        }
        let why = doubts.impossible(0, false).unwrap();
        assert!(why.starts_with("the ranges look like millimeters: in 3 of 3 scans"), "{why}");
        assert!(why.contains("(the first: 2500, which would be 2.50 m)"), "{why}");
    }
}
