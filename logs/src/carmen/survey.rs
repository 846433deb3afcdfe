//! The first reading of a log: what it contains, and what makes no sense.

use super::Rules;
use super::line::{self, Geometry, Line};
use crate::bounds;
use crate::doubts::{Doubts, OdometryTimes};
use crate::error::LogError;
use crate::lines::Lines;
use crate::odometry::Odometry;
use crate::speeds::Speeds;
use crate::standing::{NO_MOTION, Standing};
use crate::summary::{LogSummary, PoseSource, since_epoch};
use crate::times::{self, Times};
use nalgebra::Isometry2;

/// Reads a log once: how its lines become readings, the times of the readings from the first on, strictly increasing, s, and
/// what the log contains.
pub(super) fn of(lines: &mut Lines) -> Result<(Rules, Vec<f64>, LogSummary), LogError> {
    let mut geometry = Geometry::default();
    let mut recorded_s = Vec::new();
    let (mut times_s, mut notes) = (Vec::new(), Vec::new());
    let (mut with_time, mut without_time) = (0, 0);
    let mut odom_origin = None;
    // With and without the lines that have no time: whether these are origins is known at the end.
    let (mut timed, mut untimed) = (Odometry::default(), Odometry::default());
    let mut standing = Standing::default();
    let (mut doubts, mut odometry_times) = (Doubts::default(), OdometryTimes::default());
    let mut speeds = Speeds::default();
    while let Some(line) = line::next(lines, &geometry)? {
        match line {
            Line::Odometry { time_s, pose, speed_mps } => {
                odom_origin.get_or_insert(pose);
                if time_s == 0.0 {
                    without_time += 1;
                    timed.set_origin(pose);
                    untimed.add(0.0, pose);
                } else {
                    with_time += 1;
                    timed.add(time_s, pose);
                    speeds.add(time_s, pose.translation.vector, speed_mps);
                    if let Some(scan_s) = times_s.last() {
                        odometry_times.add(time_s, &pose, *scan_s);
                    }
                }
            }
            Line::Scan(scan) => {
                bounds::one_more(times_s.len()).map_err(|what| lines.error(what))?;
                times_s.push(scan.time_s);
                recorded_s.extend(scan.recorded_s);
                doubts.add(scan.typical, &scan.scan.ranges_m);
                standing.add(&Isometry2::identity(), &scan.scan);
            }
            Line::LaserOffset(offset_m) => geometry.offset_m = offset_m,
            Line::MaxRange(range_max_m) => geometry.range_max_m = range_max_m,
            Line::Other { is_cut_off: true } => {
                notes.push(format!("line {}, the last one, is cut off and left out", lines.number));
            }
            Line::Other { is_cut_off: false } => {}
        }
    }
    if times_s.is_empty() {
        let why = "no line is a scan (FLASER or ROBOTLASER1): not a CARMEN log".to_owned();
        return Err(LogError::Unusable { file: lines.file.clone(), why });
    }
    let has_origins = with_time > 0;
    let odometry_poses = if has_origins { with_time } else { without_time };
    if odometry_poses == 0 {
        notes.push("no ODOM line: the odometry stands still".to_owned());
    }
    let odometry = if has_origins { timed } else { untimed };
    let begin_s = times_s.first().copied().and_then(since_epoch);
    let stands = odometry.stands() && standing.looks_so();
    if odometry.stands() && !stands && odometry_poses > 0 {
        notes.push(NO_MOTION.to_owned());
    }
    let impossible = odometry_times.impossible(&times_s).or_else(|| odometry.impossible());
    let impossible = impossible.or_else(|| speeds.impossible()).or_else(|| doubts.impossible(0, stands));
    let Times { times_s, has_times, note } = times::repaired(&times_s);
    notes.extend(note);
    // By the same rules, since the clock of the recording can be set as well.
    let recorded = times::repaired(&recorded_s);
    if has_times && recorded.has_times && recorded.times_s.len() == times_s.len() {
        let last_s = |times_s: &[f64]| times_s.last().copied().unwrap_or_default();
        notes.extend(times::other_pace(last_s(&times_s), last_s(&recorded.times_s)));
    }
    let summary = LogSummary {
        scans: times_s.len(),
        duration_s: times_s.last().copied().unwrap_or_default(),
        has_times,
        begin_s: begin_s.filter(|_| has_times),
        pose_source: if odometry_poses > 0 { PoseSource::OdometryLines } else { PoseSource::Standing },
        odometry_poses,
        stands,
        odom_origin: odom_origin.unwrap_or_default(),
        scan_topics: Vec::new(),
        notes,
        impossible,
    };
    Ok((Rules { geometry, has_times, has_origins, stands }, times_s, summary))
}
