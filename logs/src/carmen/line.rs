//! One line of a log.

use crate::doubts;
use crate::error::LogError;
use crate::lines::Lines;
use interfaces::{Scan, is_valid_pose};
use nalgebra::Isometry2;
use std::f64::consts::{FRAC_PI_2, PI};
use std::str::{FromStr, SplitAsciiWhitespace};

/// The largest number of readings of a scan: a line that claims more is invalid.
const MAX_READINGS: usize = 20_000;
/// The maximum range of a laser without a parameter, m: a SICK LMS 200 reports failures as 81.83 m and above.
const MAX_RANGE_M: f64 = 80.0;

/// What parameters say about the laser of FLASER lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Geometry {
    /// The distance of the laser in front of the center of the robot, m.
    pub(super) offset_m: f64,
    /// Ranges from here on are no measurements, m.
    pub(super) range_max_m: f64,
}

impl Default for Geometry {
    fn default() -> Self {
        Self { offset_m: 0.0, range_max_m: MAX_RANGE_M }
    }
}

/// A line.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Line {
    Odometry {
        time_s: f64,
        pose: Isometry2<f64>,
        /// The speed ahead (tv), m/s; many logs have 0.
        speed_mps: f64,
    },
    Scan(ScanLine),
    LaserOffset(f64),
    MaxRange(f64),
    /// Comments, other messages, and a last line that is cut off.
    Other {
        is_cut_off: bool,
    },
}

/// A line with a scan.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScanLine {
    pub(super) time_s: f64,
    /// The time of the recording, if the line has one.
    pub(super) recorded_s: Option<f64>,
    pub(super) scan: Scan,
    /// The typical range as written.
    pub(super) typical: Option<f32>,
    /// The pose of the laser in the line: the result of an earlier estimation in corrected logs.
    pub(super) reference: Option<Isometry2<f64>>,
}

/// The next line, `None` at the end.
pub(super) fn next(lines: &mut Lines, geometry: &Geometry) -> Result<Option<Line>, LogError> {
    let Some(text) = lines.next_line()? else { return Ok(None) };
    match parse(&text, geometry) {
        Ok(line) => Ok(Some(line)),
        Err(_) if !lines.is_complete => Ok(Some(Line::Other { is_cut_off: true })),
        Err(what) => Err(lines.error(what)),
    }
}

/// A line from its words. Comments may contain the names of messages: only the first word counts.
fn parse(text: &str, geometry: &Geometry) -> Result<Line, String> {
    let mut words = text.split_ascii_whitespace();
    match words.next() {
        Some("ODOM") => {
            let mut words = Words { message: "ODOM", words };
            let pose = words.pose("x, y and theta")?;
            let speed_mps = words.next("tv")?.parse().unwrap_or(0.0);
            words.skip(2, "rv and accel")?;
            Ok(Line::Odometry { time_s: words.time()?, pose, speed_mps })
        }
        Some("FLASER") => flaser(Words { message: "FLASER", words }, geometry).map(Line::Scan),
        Some("ROBOTLASER1") => robotlaser(Words { message: "ROBOTLASER1", words }).map(Line::Scan),
        Some("PARAM") => Ok(param(words)),
        _ => Ok(Line::Other { is_cut_off: false }),
    }
}

fn param(mut words: SplitAsciiWhitespace) -> Line {
    let name = words.next().unwrap_or_default();
    let value = words.next().and_then(|word| word.parse::<f64>().ok()).filter(|value| value.is_finite());
    match (name, value) {
        ("robot_frontlaser_offset", Some(value)) if value.abs() < 10.0 => Line::LaserOffset(value),
        ("robot_front_laser_max" | "laser_front_laser_max", Some(value)) if value > 0.1 => {
            Line::MaxRange(value)
        }
        _ => Line::Other { is_cut_off: false },
    }
}

fn flaser(mut words: Words, geometry: &Geometry) -> Result<ScanLine, String> {
    let count = words.count()?;
    let (ranges_m, typical) = words.ranges(count, geometry.range_max_m)?;
    let reference = words.pose("the pose of the laser")?;
    words.skip(3, "the pose of the robot")?;
    let steps = if count.is_multiple_of(2) { count } else { count - 1 };
    let scan = Scan {
        angle_min_rad: -FRAC_PI_2,
        angle_increment_rad: PI / steps.max(1) as f64,
        range_min_m: 0.0,
        range_max_m: geometry.range_max_m,
        sweep_s: 0.0,
        ranges_m,
    };
    let (time_s, recorded_s) = words.times()?;
    Ok(ScanLine { time_s, recorded_s, scan, typical, reference: Some(reference) })
}

fn robotlaser(mut words: Words) -> Result<ScanLine, String> {
    words.skip(1, "the type of the laser")?;
    let [angle_min_rad, fov_rad, increment_rad] =
        [words.number("start")?, words.number("fov")?, words.number("resolution")?];
    let max_m = words.number("max_range")?;
    words.skip(2, "accuracy and remission mode")?;
    let count = words.count()?;
    let range_max_m = if max_m > 0.1 { max_m } else { MAX_RANGE_M };
    let (ranges_m, typical) = words.ranges(count, range_max_m)?;
    let remissions = words.number("the number of remissions")?;
    if !(0.0..=MAX_READINGS as f64).contains(&remissions) {
        return Err(words.invalid("the number of remissions", &remissions.to_string()));
    }
    // Remissions, the poses of laser and robot, velocities and safety distances.
    words.skip(remissions as usize + 11, "remissions, poses, velocities and distances")?;
    let angle_increment_rad =
        if increment_rad > 0.0 { increment_rad } else { fov_rad / (count as f64 - 1.0).max(1.0) };
    let scan =
        Scan { angle_min_rad, angle_increment_rad, range_min_m: 0.0, range_max_m, sweep_s: 0.0, ranges_m };
    scan.check().map_err(|error| format!("ROBOTLASER1: {error}"))?;
    let (time_s, recorded_s) = words.times()?;
    Ok(ScanLine { time_s, recorded_s, scan, typical, reference: None })
}

/// The words after the name of a message.
struct Words<'a> {
    message: &'static str,
    words: SplitAsciiWhitespace<'a>,
}

impl Words<'_> {
    fn next(&mut self, what: &str) -> Result<&str, String> {
        self.words.next().ok_or_else(|| format!("{} ends before {what}", self.message))
    }

    fn invalid(&self, what: &str, word: &str) -> String {
        format!("{}: `{word}` is no valid value for {what}", self.message)
    }

    fn skip(&mut self, count: usize, what: &str) -> Result<(), String> {
        (0..count).try_for_each(|_| self.next(what).map(|_| ()))
    }

    fn parsed<T: FromStr>(&mut self, what: &str, is_valid: impl Fn(&T) -> bool) -> Result<T, String> {
        let word = self.next(what)?.to_owned();
        word.parse().ok().filter(is_valid).ok_or_else(|| self.invalid(what, &word))
    }

    fn number(&mut self, what: &str) -> Result<f64, String> {
        self.parsed(what, |number: &f64| number.is_finite())
    }

    /// A time; times that are not finite are found with all others that make no sense.
    fn time(&mut self) -> Result<f64, String> {
        self.parsed("the time", |_| true)
    }

    /// The time, and the time of the recording after the name of the host.
    fn times(&mut self) -> Result<(f64, Option<f64>), String> {
        let time_s = self.time()?;
        Ok((
            time_s,
            self.words.nth(1).and_then(|word| word.parse().ok()).filter(|time_s: &f64| time_s.is_finite()),
        ))
    }

    fn count(&mut self) -> Result<usize, String> {
        self.parsed("the number of readings", |count| (1..=MAX_READINGS).contains(count))
    }

    fn pose(&mut self, what: &str) -> Result<Isometry2<f64>, String> {
        let pose = interfaces::pose(self.number(what)?, self.number(what)?, self.number(what)?);
        is_valid_pose(&pose).then_some(pose).ok_or_else(|| format!("{}: the pose is too far", self.message))
    }

    /// Ranges, and the typical one as written; what is no measurement becomes NaN: a laser that sees nothing in a dark or shining surface reports the
    /// same number as in the open.
    fn ranges(&mut self, count: usize, max_m: f64) -> Result<(Vec<f32>, Option<f32>), String> {
        let mut written = Vec::with_capacity(count);
        let mut ranges_m = Vec::with_capacity(count);
        for _ in 0..count {
            let word = self.next("its last reading")?;
            let Ok(range_m) = word.parse::<f32>() else {
                let word = word.to_owned();
                return Err(self.invalid("a range", &word));
            };
            written.push(range_m);
            let is_measured = range_m > 0.0 && f64::from(range_m) < max_m;
            ranges_m.push(if is_measured { range_m } else { f32::NAN });
        }
        Ok((ranges_m, doubts::typical(written.into_iter())))
    }
}
