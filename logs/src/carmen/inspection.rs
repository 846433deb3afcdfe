//! The first reading of a log: what it contains, and what makes no sense.

use super::geometry::{Geometry, MAX_RANGE_M, Mounts};
use super::line::{self, Line};
use super::{Lines, Rules};
use crate::assemble::Odometry;
use crate::bounds;
use crate::checks::times::{self, Times};
use crate::checks::{Doubts, Looks, OdometryTimes, Speeds, Standing, TimedLooks};
use crate::summary::{LogError, LogSummary, since_epoch};
use nalgebra::Isometry2;
use std::collections::BTreeSet;

/// A laser that measures this number of different ranges beyond a stated maximum has another one: failures have few values.
const MIN_BEYOND: usize = 20;
/// A pose that the odometry measures right after a scan is at most this far from it in time, s.
const SAME_TIME_S: f64 = 1.0;

/// Reads a log once: how its lines become readings, the times of the readings from the first on, strictly increasing, s, and
/// what the log contains.
pub(super) fn of(lines: &mut Lines, is_corrected: bool) -> Result<(Rules, TimedLooks, LogSummary), LogError> {
    let mut inspection = Inspection::default();
    while let Some(line) = line::next(lines, &inspection.geometry)? {
        inspection.add(line, lines)?;
    }
    let of_most = inspection.of_most_invalid();
    if let Some((line, what)) = of_most {
        return Err(LogError::line(&lines.file, line, what));
    }
    if inspection.times_s.is_empty() {
        let why = match lines.cut() {
            Some((packed, unpacked)) => format!(
                "the gzip file is cut off after {packed} bytes, and the {unpacked} bytes of text that could be unpacked have no \
                 whole scan (FLASER or ROBOTLASER1)"
            ),
            None => "no line is a scan (FLASER or ROBOTLASER1): not a CARMEN log".to_owned(),
        };
        return Err(LogError::Unusable { file: lines.file.clone(), why });
    }
    let (rules, looks, mut summary) = inspection.summarized(is_corrected);
    if let Some((packed, unpacked)) = lines.cut() {
        let note = format!(
            "the gzip file is cut off after {packed} bytes, and the rest is missing: {} lines ({unpacked} bytes of text) could be \
             read, up to {:.1} s after the first scan",
            lines.number, summary.duration_s
        );
        summary.notes.insert(0, note);
    }
    Ok((rules, looks, summary))
}

/// Lines that are left out: their number, and the first one.
#[derive(Default)]
struct Invalid {
    count: usize,
    first: Option<(u64, String)>,
}

impl Invalid {
    fn note(&self, one: &str, several: &str) -> Option<String> {
        let (line, what) = self.first.as_ref()?;
        Some(match self.count {
            1 => format!("1 {one} is invalid and left out, line {line}: {what}"),
            count => format!("{count} {several} are invalid and left out, the first in line {line}: {what}"),
        })
    }
}

/// The lines of a log so far.
#[derive(Default)]
struct Inspection {
    geometry: Geometry,
    /// The times of the scans as written, s.
    times_s: Vec<f64>,
    /// The times of their recording, s.
    recorded_s: Vec<f64>,
    /// The number of poses with a time, and of those without.
    with_time: usize,
    without_time: usize,
    /// The time and the pose in the last line, if it is a scan.
    scan: Option<(f64, Isometry2<f64>)>,
    /// The number of poses right after a scan that repeat its pose, at about its time, and at another one.
    repeated: [usize; 2],
    /// Different ranges beyond the maximum that a parameter states, as bits; at most [`MIN_BEYOND`].
    beyond: BTreeSet<u32>,
    /// Different ranges from 80 m up to a stated maximum, as bits; at most [`MIN_BEYOND`].
    far: BTreeSet<u32>,
    /// The numbers of readings of FLASER lines.
    counts: BTreeSet<usize>,
    mounts: Mounts,
    invalid_scans: Invalid,
    invalid_poses: Invalid,
    /// The poses without the lines that have no time, and these alone: whether they are origins is known at the end.
    timed: Odometry,
    untimed: Odometry,
    standing: Standing,
    speeds: Speeds,
    doubts: Doubts,
    odometry_times: OdometryTimes,
    looks: Looks,
    notes: Vec<String>,
}

impl Inspection {
    fn add(&mut self, line: Line, lines: &Lines) -> Result<(), LogError> {
        let before = self.scan.take();
        match line {
            Line::Odometry { time_s, pose, speed_mps } => {
                let scan_s = before.filter(|(_, reference)| *reference == pose).map(|(scan_s, _)| scan_s);
                let is_origin = scan_s.is_some_and(|scan_s| (time_s - scan_s).abs() > SAME_TIME_S);
                self.repeated[usize::from(is_origin)] += usize::from(scan_s.is_some());
                self.add_pose(if is_origin { 0.0 } else { time_s }, pose, speed_mps);
            }
            Line::Scan(mut scan) => {
                if scan.is_flaser {
                    self.counts.insert(scan.scan.ranges_m.len());
                }
                self.check_ranges(&mut scan.scan.ranges_m, scan.is_flaser);
                scan.mount.iter().for_each(|mount| self.mounts.add(mount));
                self.scan = scan.reference.map(|pose| (scan.time_s, pose));
                let is_full = |what| LogError::line(&lines.file, lines.number, what);
                bounds::one_more(self.times_s.len()).map_err(is_full)?;
                self.times_s.push(scan.time_s);
                self.timed.holes.add_scan(scan.time_s);
                self.recorded_s.extend(scan.recorded_s);
                self.doubts.add(scan.typical, &scan.scan.ranges_m);
                self.standing.add(&Isometry2::identity(), &scan.scan);
                self.looks.add(scan.time_s, &self.timed.newest().0, &scan.scan.ranges_m);
            }
            Line::Param { name, value } => self.geometry.set(&name, value),
            Line::Invalid { is_scan, what } => {
                let invalid = if is_scan { &mut self.invalid_scans } else { &mut self.invalid_poses };
                invalid.count += 1;
                invalid.first.get_or_insert((lines.number, what));
            }
            Line::Other { is_cut_off: true } => {
                self.notes.push(format!("line {}, the last one, is cut off and left out", lines.number));
            }
            Line::Other { is_cut_off: false } => {}
        }
        Ok(())
    }

    /// Removes ranges of FLASER lines beyond the stated maximum. Counts how many different ones there are, and how many from 80 m on.
    fn check_ranges(&mut self, ranges_m: &mut [f32], is_flaser: bool) {
        let note = |known: &mut BTreeSet<u32>, range_m: f32| {
            if known.len() < MIN_BEYOND {
                known.insert(range_m.to_bits());
            }
        };
        let max_m = self.geometry.stated_max_m.filter(|_| is_flaser).map(|max_m| max_m as f32);
        for range_m in ranges_m {
            if max_m.is_some_and(|max_m| *range_m >= max_m) {
                note(&mut self.beyond, *range_m);
                *range_m = f32::NAN;
            } else if *range_m >= MAX_RANGE_M as f32 {
                note(&mut self.far, *range_m);
            }
        }
    }

    /// The first invalid line, if most scans or most poses are invalid.
    fn of_most_invalid(&self) -> Option<(u64, String)> {
        let Self { invalid_scans, invalid_poses, .. } = self;
        let of_scans = invalid_scans.first.as_ref().filter(|_| invalid_scans.count > self.times_s.len());
        let poses = self.with_time + self.without_time;
        let of_poses = invalid_poses.first.as_ref().filter(|_| invalid_poses.count > poses);
        of_scans.into_iter().chain(of_poses).min().cloned()
    }

    fn add_pose(&mut self, time_s: f64, pose: Isometry2<f64>, speed_mps: f64) {
        if time_s == 0.0 {
            self.without_time += 1;
            self.timed.set_origin(pose);
            self.untimed.add(0.0, pose);
            return;
        }
        self.with_time += 1;
        self.timed.add(time_s, pose);
        self.speeds.add(time_s, pose.translation.vector, speed_mps);
        if let Some(scan_s) = self.times_s.last() {
            self.odometry_times.add(time_s, &pose, *scan_s);
        }
    }

    fn summarized(mut self, takes_scan_poses: bool) -> (Rules, TimedLooks, LogSummary) {
        self.looks.finish();
        [self.times_s, self.recorded_s] = [self.times_s, self.recorded_s].map(|it| self.looks.of_looks(it));
        let Self { mut geometry, mut notes, .. } = self;
        notes.extend(self.invalid_scans.note("scan", "scans"));
        notes.extend(self.invalid_poses.note("ODOM line", "ODOM lines"));
        geometry.has_codes = !self.far.is_empty() && self.far.len() < MIN_BEYOND;
        if geometry.has_codes {
            notes.push(format!(
                "the log states a maximum range above {MAX_RANGE_M} m, but the number of different ranges from there on is only {}: they \
                 are numbers for failures, and no measurements",
                self.far.len()
            ));
        }
        geometry.robotlaser_mount = self.mounts.fixed();
        if let Some(count) = self.counts.iter().find(|count| !geometry.field(**count).2) {
            notes.push(format!(
                "FLASER lines with {count} readings do not say their field of view: 180° is assumed; a line `PARAM \
                 laser_front_laser_fov DEGREES` before them states it"
            ));
        }
        geometry.is_max_sure = self.beyond.len() < MIN_BEYOND;
        if let Some(max_m) = geometry.stated_max_m.filter(|_| !geometry.is_max_sure) {
            notes.push(format!(
                "a parameter states a maximum range of {max_m} m, but beams measure more: it is ignored"
            ));
        }
        let has_origins = self.with_time > 0;
        let is_corrected = has_origins && self.repeated[1] > self.repeated[0];
        let (odometry, odometry_poses) =
            if has_origins { (self.timed, self.with_time) } else { (self.untimed, self.without_time) };
        if odometry_poses == 0 {
            notes.push("no ODOM line: the odometry stands still".to_owned());
        }
        let stands = odometry.stands() && self.standing.looks_so();
        if odometry.stands() && !stands && odometry_poses > 0 && !takes_scan_poses {
            notes.push(self.standing.note().to_owned());
        }
        let impossible = self.odometry_times.impossible(&self.times_s).or_else(|| odometry.pace.impossible());
        let impossible = impossible.or_else(|| self.speeds.impossible());
        let impossible = impossible.or_else(|| self.doubts.impossible(0, stands));
        let times = times::repaired(&self.times_s);
        let begin_s = since_epoch(times.begin_s).filter(|_| times.has_times);
        if times.has_times && has_origins {
            let begin_s = self.times_s.first().copied().unwrap_or_default();
            notes.extend(odometry.holes.note().into_iter().chain(odometry.restarts_note(begin_s)));
        }
        notes.extend(self.looks.notes.iter().cloned().chain(times.note.clone()));
        notes.extend(begin_s.and(times.date_note()));
        let Times { times_s, has_times, .. } = times;
        notes.extend(recorded_pace(&self.recorded_s, has_times, &times_s));
        if takes_scan_poses {
            notes
                .push("the poses are those of the FLASER lines, which another SLAM has corrected".to_owned());
        }
        let summary = LogSummary {
            scans: times_s.len(),
            duration_s: times_s.last().copied().unwrap_or_default(),
            has_times,
            begin_s,
            odometry_poses,
            stands,
            scan_topics: Vec::new(),
            notes,
            impossible,
        };
        let rules = Rules { geometry, has_times, has_origins, is_corrected, stands, takes_scan_poses: false };
        (rules, (times_s, self.looks), summary)
    }
}

/// A note if the scans took another time than their recording. Both are repaired by the same rules, since the clock of the
/// recording can be set as well.
fn recorded_pace(recorded_s: &[f64], has_times: bool, times_s: &[f64]) -> Option<String> {
    let recorded = times::repaired(recorded_s);
    let is_complete = has_times && recorded.has_times && recorded.times_s.len() == times_s.len();
    times::other_pace(*times_s.last()?, *recorded.times_s.last()?).filter(|_| is_complete)
}
