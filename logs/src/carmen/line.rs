//! One line of a log.

use super::Lines;
use super::geometry::{Geometry, MAX_RANGE_M};
use crate::checks::typical;
use crate::summary::LogError;
use interfaces::{Scan, is_valid_pose};
use nalgebra::Isometry2;
use ros::MAX_BEAMS;
use std::str::{FromStr, SplitAsciiWhitespace};

const ODOM: &str = "ODOM";
/// The most characters of a word in a message.
const MAX_WORD: usize = 40;

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
    Param {
        name: String,
        value: f64,
    },
    /// A scan or a pose that is left out, and why.
    Invalid {
        is_scan: bool,
        what: String,
    },
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
    pub(super) is_flaser: bool,
    /// In a FLASER line the pose of the laser, the result of an earlier estimation in corrected logs; `None` if it is invalid.
    pub(super) reference: Option<Isometry2<f64>>,
    /// In a ROBOTLASER1 line the pose of the laser in the frame of the robot; `None` if one of its poses is invalid.
    pub(super) mount: Option<Isometry2<f64>>,
}

/// The next line, `None` at the end.
pub(super) fn next(lines: &mut Lines, geometry: &Geometry) -> Result<Option<Line>, LogError> {
    let Some(text) = lines.next_line()? else { return Ok(None) };
    match parse(&text, geometry) {
        Ok(line) => Ok(Some(line)),
        Err(_) if !lines.is_complete => Ok(Some(Line::Other { is_cut_off: true })),
        Err(what) => {
            let is_scan = text.split_ascii_whitespace().next() != Some(ODOM);
            Ok(Some(Line::Invalid { is_scan, what }))
        }
    }
}

/// A line from its words. Comments may contain the names of messages: only the first word counts.
fn parse(text: &str, geometry: &Geometry) -> Result<Line, String> {
    let mut words = text.split_ascii_whitespace();
    match words.next() {
        Some(ODOM) => {
            let mut words = Words { message: ODOM, words };
            let pose = words.pose("x, y and theta")?;
            let speed_mps = words.next("tv")?.parse().unwrap_or(0.0);
            words.skip(2, "rv and accel")?;
            Ok(Line::Odometry { time_s: words.time()?, pose, speed_mps })
        }
        Some("FLASER") => flaser(Words { message: "FLASER", words }, geometry).map(Line::Scan),
        Some("ROBOTLASER1") => robotlaser(Words { message: "ROBOTLASER1", words }, geometry).map(Line::Scan),
        Some("PARAM") => Ok(param(words)),
        _ => Ok(Line::Other { is_cut_off: false }),
    }
}

fn param(mut words: SplitAsciiWhitespace) -> Line {
    let name = words.next().unwrap_or_default().to_owned();
    let value = words.next().and_then(|word| word.parse().ok()).filter(|value: &f64| value.is_finite());
    value.map_or(Line::Other { is_cut_off: false }, |value| Line::Param { name, value })
}

fn flaser(mut words: Words, geometry: &Geometry) -> Result<ScanLine, String> {
    let count = words.count()?;
    let range_max_m = geometry.range_max_m();
    let (ranges_m, typical) = words.ranges(count, range_max_m)?;
    let reference = words.optional_pose("the pose of the laser")?;
    words.skip(3, "the pose of the robot")?;
    let (fov_rad, angle_increment_rad, _) = geometry.field(count);
    let scan = Scan {
        angle_min_rad: -0.5 * fov_rad,
        angle_increment_rad,
        range_min_m: 0.0,
        range_max_m,
        sweep_s: 0.0,
        ranges_m,
    };
    let (time_s, recorded_s) = words.times()?;
    Ok(ScanLine { time_s, recorded_s, scan, typical, is_flaser: true, reference, mount: None })
}

fn robotlaser(mut words: Words, geometry: &Geometry) -> Result<ScanLine, String> {
    words.skip(1, "the type of the laser")?;
    let [angle_min_rad, fov_rad, increment_rad] =
        [words.number("start")?, words.number("fov")?, words.number("resolution")?];
    let max_m = words.number("max_range")?;
    words.skip(2, "accuracy and remission mode")?;
    let count = words.count()?;
    let range_max_m = geometry.limited_m(if max_m > 0.1 { max_m } else { MAX_RANGE_M });
    let (ranges_m, typical) = words.ranges(count, range_max_m)?;
    let remissions = words.number("the number of remissions")?;
    if !(0.0..=MAX_BEAMS as f64).contains(&remissions) {
        return Err(words.invalid("the number of remissions", &remissions.to_string()));
    }
    words.skip(remissions as usize, "its last remission")?;
    let [laser, robot] =
        [words.optional_pose("the pose of the laser")?, words.optional_pose("the pose of the robot")?];
    let mount = laser.zip(robot).map(|(laser, robot)| robot.inv_mul(&laser));
    words.skip(5, "velocities and distances")?;
    let angle_increment_rad =
        if increment_rad > 0.0 { increment_rad } else { fov_rad / (count as f64 - 1.0).max(1.0) };
    let scan =
        Scan { angle_min_rad, angle_increment_rad, range_min_m: 0.0, range_max_m, sweep_s: 0.0, ranges_m };
    scan.check().map_err(|error| format!("ROBOTLASER1: {error}"))?;
    let (time_s, recorded_s) = words.times()?;
    Ok(ScanLine { time_s, recorded_s, scan, typical, is_flaser: false, reference: None, mount })
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
        let shown: String = word.chars().take(MAX_WORD).collect();
        let more = if shown.len() < word.len() { "…" } else { "" };
        format!("{}: `{shown}{more}` is no valid value for {what}", self.message)
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
        self.parsed("the number of readings", |count| (1..=MAX_BEAMS).contains(count))
    }

    fn pose(&mut self, what: &str) -> Result<Isometry2<f64>, String> {
        let pose = interfaces::pose(self.number(what)?, self.number(what)?, self.number(what)?);
        is_valid_pose(&pose).then_some(pose).ok_or_else(|| format!("{}: the pose is too far", self.message))
    }

    /// A pose that few logs need; `None` if it is invalid.
    fn optional_pose(&mut self, what: &str) -> Result<Option<Isometry2<f64>>, String> {
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            *number = self.next(what)?.parse().unwrap_or(f64::NAN);
        }
        let [x, y, theta] = numbers;
        let is_valid = numbers.iter().all(|number| number.is_finite());
        Ok(is_valid.then(|| interfaces::pose(x, y, theta)).filter(is_valid_pose))
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
            // As `f32`: the nearest one to a maximum can be below it as `f64`.
            let is_measured = range_m > 0.0 && range_m < max_m as f32;
            ranges_m.push(if is_measured { range_m } else { f32::NAN });
        }
        Ok((ranges_m, typical(written.into_iter())))
    }
}
