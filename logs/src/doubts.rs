//! What cannot be true of a log, as far as its numbers show it before anything is mapped.

use nalgebra::Isometry2;

/// Ranges whose median is beyond this are no metres: no laser of a robot sees so far.
const FARTHEST_M: f32 = 200.0;
/// A scan with fewer ranges says nothing about their unit.
const LEAST_RANGES: usize = 10;
/// Times of the odometry that go back in this share of the steps are no times; numbers that do so in less are.
const MOST_BACK: f64 = 0.1;
const RARELY_BACK: f64 = 0.01;
/// At least this number of ODOM lines is compared.
const LEAST_LINES: usize = 20;

/// What the scans of a log say about each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Doubts {
    scans: usize,
    /// Scans with a range.
    seeing: usize,
    /// Scans whose ranges are no metres, and the median range of the first one.
    beyond: usize,
    first_beyond: f32,
}

impl Doubts {
    /// Adds a scan: the [`typical`] range as written, and the ranges that are used.
    pub(crate) fn add(&mut self, typical: Option<f32>, ranges_m: &[f32]) {
        self.scans += 1;
        self.seeing += usize::from(ranges_m.iter().any(|range_m| range_m.is_finite() && *range_m > 0.0));
        if let Some(typical) = typical.filter(|typical| *typical > FARTHEST_M) {
            if self.beyond == 0 {
                self.first_beyond = typical;
            }
            self.beyond += 1;
        }
    }

    /// Why no map can be made of these scans, beside `invalid` ones that are none.
    pub(crate) fn impossible(&self, invalid: usize) -> Option<String> {
        let Self { scans, seeing, beyond, first_beyond } = *self;
        let all = scans + invalid;
        if beyond * 2 > scans {
            return Some(format!(
                "the ranges look like millimetres: in {beyond} of {scans} scans, their median is beyond {FARTHEST_M} m (the \
                 first: {first_beyond}, which would be {} m); ranges are in metres: divide them by 1000",
                first_beyond / 1000.0
            ));
        }
        if seeing == 0 {
            return Some(format!(
                "none of {scans} scans has a range between the limits of the laser: nothing is seen"
            ));
        }
        if invalid > scans {
            return Some(format!("{invalid} of {all} scans are invalid: what is left is no log of a place"));
        }
        (scans == 1).then(|| "one scan: what changes is found by comparing scans, at least 2".to_owned())
    }
}

/// The median of the ranges as written, without those that are no measurement: many lasers write one large number where
/// nothing comes back. `None` if there are too few.
pub(crate) fn typical(ranges: impl Iterator<Item = f32>) -> Option<f32> {
    let mut ranges: Vec<f32> = ranges.filter(|range| range.is_finite() && *range > 0.0).collect();
    let largest = ranges.iter().copied().fold(0.0, f32::max);
    ranges.retain(|range| *range < largest);
    let middle = ranges.len() / 2;
    (ranges.len() >= LEAST_RANGES).then(|| *ranges.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// Compares the times of ODOM lines with their x.
#[derive(Clone, Debug, Default)]
pub(crate) struct OdometryTimes {
    last: Option<(f64, f64)>,
    steps: usize,
    times_back: usize,
    x_back: usize,
    /// The least and the largest x.
    x: (f64, f64),
}

impl OdometryTimes {
    pub(crate) fn add(&mut self, time_s: f64, pose: &Isometry2<f64>) {
        let x = pose.translation.x;
        if x == 0.0 {
            return; // Corrected logs have lines without a time.
        }
        if let Some((last_s, last_x)) = self.last.replace((time_s, x)) {
            self.steps += 1;
            self.times_back += usize::from(time_s < last_s);
            self.x_back += usize::from(x <= last_x);
            self.x = (self.x.0.min(x), self.x.1.max(x));
        } else {
            self.x = (x, x);
        }
    }

    /// Why these are no times, if it is sure: they go back, and x goes ahead as the times of the scans do.
    pub(crate) fn impossible(&self, scans_s: &[f64]) -> Option<String> {
        let Self { steps, times_back, x_back, x, .. } = *self;
        let ends_s = scans_s.first().copied().zip(scans_s.last().copied());
        let margin_s = |begin_s: f64, end_s: f64| 0.1 * (end_s - begin_s) + 1.0;
        let is_time = |(begin_s, end_s): (f64, f64)| {
            x.0 > begin_s - margin_s(begin_s, end_s)
                && x.1 < end_s + margin_s(begin_s, end_s)
                && x.1 - x.0 > 0.5 * (end_s - begin_s)
        };
        let is_swapped = steps >= LEAST_LINES
            && times_back as f64 > MOST_BACK * steps as f64
            && (x_back as f64) < RARELY_BACK * steps as f64
            && ends_s.is_some_and(is_time);
        is_swapped.then(|| {
            format!(
                "x and the time look exchanged in the ODOM lines: their times go back in {times_back} of {steps} steps, while x \
                 goes from {} to {} as the times of the scans do; a line is `ODOM x y theta tv rv accel time host logger_time`",
                x.0, x.1
            )
        })
    }
}
