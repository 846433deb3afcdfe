//! Odometry: the sum of its motions, and its pose at the time of a scan.

use crate::jumps::Jumps;
use crate::standing::{MIN_MOTION_M, MIN_MOTION_RAD};
use interfaces::{LaserReading, Scan, Twist, VelocitySample, heading_rad, wrap_rad};
use nalgebra::Isometry2;

/// Between two poses that are farther apart than this, s, the odometry is not interpolated.
const LONGEST_GAP_S: f64 = 2.0;
/// Intervals that overlap by less than this do so by rounding, s.
const MIN_OVERLAP_S: f64 = 1e-6;
/// A gap this many times as long as the step before it is a hole: some logs have a pose every few seconds.
const HOLE: f64 = 10.0;
/// A robot that moves slower than this in nearly all of at least this number of steps is none, m/s and rad/s: 0.15 m/s and more
/// are usual, a thousandth of it with times in milliseconds.
const MIN_MPS: f64 = 0.002;
const MIN_RADPS: f64 = 0.005;
const MIN_STEPS: usize = 100;
/// The number of poses that are kept: some messages arrive later than others.
const KEPT: usize = 256;
/// The same of poses as written: scans wait for corrections up to half a second, and there are 1000 poses per second and more.
const KEPT_AS_WRITTEN: usize = 1024;

/// Poses of another SLAM that demand a higher speed than this have been corrected in between, m/s and rad/s: robots indoors drive
/// at most 2 m/s.
const MAX_MPS: f64 = 3.0;
const MAX_RADPS: f64 = 4.0;

/// The recent poses of a robot by odometry, as the sum of its motions since the first one: the first pose is the origin.
#[derive(Debug, Default)]
pub struct Odometry {
    /// The first and the last pose as written.
    first: Option<Isometry2<f64>>,
    written: Option<Isometry2<f64>>,
    /// The times (s) and the sums of the motions, the newest last.
    samples: Vec<(f64, Isometry2<f64>)>,
    /// The largest distance from the first pose, m, and the largest turn since then, rad.
    farthest_m: f64,
    farthest_rad: f64,
    /// The number of steps with a motion, and of those at the speed of a robot.
    moving: usize,
    fast: usize,
    /// The time of the last scan without a pose near it, s, and the number of gaps with such scans.
    unknown_s: Option<f64>,
    holes: usize,
    /// Whether the poses are kept as written, with their jumps.
    is_as_written: bool,
    jumps: Jumps,
}

impl Odometry {
    /// Keeps poses as they are written, in a frame in which another SLAM has them. A jump is no motion: the motion before it goes on
    /// until then.
    pub(crate) fn as_written() -> Self {
        Self { is_as_written: true, ..Self::default() }
    }

    /// Adds a pose as written.
    pub fn add(&mut self, time_s: f64, pose: Isometry2<f64>) {
        let is_hole = self.is_hole(time_s);
        self.holes += usize::from(is_hole);
        let before = self.written.filter(|_| !is_hole);
        let motion = before.map_or(Isometry2::identity(), |before| before.inv_mul(&pose));
        self.first.get_or_insert(pose);
        self.written = Some(pose);
        let mut at = self.last() * motion;
        at.rotation.renormalize();
        if self.is_as_written {
            at = pose;
        }
        let (step_m, step_rad) = (motion.translation.vector.norm(), heading_rad(&motion).abs());
        let elapsed_s = self.samples.last().map_or(0.0, |(last_s, _)| time_s - last_s);
        if elapsed_s > 0.0 && (step_m > MIN_MOTION_M || step_rad > MIN_MOTION_RAD) {
            self.moving += 1;
            self.fast += usize::from(step_m > MIN_MPS * elapsed_s || step_rad > MIN_RADPS * elapsed_s);
        }
        let since_first = if self.is_as_written { self.origin().inv_mul(&at) } else { at };
        self.farthest_m = self.farthest_m.max(since_first.translation.vector.norm());
        self.farthest_rad = self.farthest_rad.max(heading_rad(&since_first).abs());
        let is_too_fast = step_m > MAX_MPS * elapsed_s || step_rad > MAX_RADPS * elapsed_s;
        if self.is_as_written && elapsed_s > 0.0 && is_too_fast {
            let (last, Twist { linear_mps, angular_radps }) = self.newest();
            let on_s = elapsed_s.min(LONGEST_GAP_S);
            let unjumped = last * interfaces::pose(linear_mps * on_s, 0.0, angular_radps * on_s);
            self.jumps.add(time_s, &unjumped.inv_mul(&pose));
            self.keep(time_s, unjumped);
        }
        self.keep(time_s, at);
    }

    fn keep(&mut self, time_s: f64, pose: Isometry2<f64>) {
        if self.samples.len() == if self.is_as_written { KEPT_AS_WRITTEN } else { KEPT } {
            self.samples.remove(0);
        }
        self.samples.push((time_s, pose));
    }

    /// The jumps of poses that are kept as written.
    pub(crate) fn jumps(&self) -> &Jumps {
        &self.jumps
    }

    /// Whether there is a pose at a time, or at most 2 s before it.
    pub(crate) fn knows(&self, time_s: f64) -> bool {
        self.samples.iter().rev().any(|(sample_s, _)| (0.0..=LONGEST_GAP_S).contains(&(time_s - sample_s)))
    }

    /// Whether the poses until now are missing, while there were scans: with the motion of the whole gap in the next step, the
    /// odometry would contradict these scans twice. They have found the way by themselves.
    fn is_hole(&self, time_s: f64) -> bool {
        let [.., (before_s, _), (last_s, _)] = self.samples[..] else { return false };
        if self.is_as_written {
            return false;
        }
        let gap_s = time_s - last_s;
        let had_scans = self.unknown_s.is_some_and(|unknown_s| unknown_s > last_s);
        had_scans && gap_s > LONGEST_GAP_S && gap_s > HOLE * (last_s - before_s)
    }

    /// The first pose, as written: the origin of all others.
    pub fn origin(&self) -> Isometry2<f64> {
        self.first.unwrap_or_default()
    }

    /// Whether the robot has not moved so far, except for a drift.
    pub(crate) fn stands(&self) -> bool {
        self.farthest_m < MIN_MOTION_M && self.farthest_rad < MIN_MOTION_RAD
    }

    /// Why the times cannot be in seconds, if it is sure: the robot moves far slower than any robot.
    pub(crate) fn impossible(&self) -> Option<String> {
        let Self { moving, fast, .. } = *self;
        (moving >= MIN_STEPS && fast * 100 < moving).then(|| {
            format!(
                "the times look like milliseconds: in {} of the {moving} steps in which the odometry moves, it is slower than \
                 {MIN_MPS} m/s and {MIN_RADPS} rad/s; times are in seconds",
                moving - fast
            )
        })
    }

    /// Motions are measured from this pose on.
    pub fn set_origin(&mut self, pose: Isometry2<f64>) {
        self.written = Some(pose);
        // The older poses were written in another frame, but their motions are true.
    }

    /// The newest pose.
    fn last(&self) -> Isometry2<f64> {
        self.samples.last().map_or(Isometry2::identity(), |(_, pose)| *pose)
    }

    /// The times of the oldest and the newest pose that are kept, s; `None` without a pose.
    pub fn span_s(&self) -> Option<(f64, f64)> {
        Some((self.samples.first()?.0, self.samples.last()?.0))
    }

    /// Whether a later pose can be nearer to this time, where the log is read until `now_s`.
    pub fn must_wait(&self, time_s: f64, now_s: f64) -> bool {
        self.samples.last().is_some_and(|(last_s, _)| *last_s < time_s && now_s - last_s < LONGEST_GAP_S)
    }

    /// The pose and the velocity at a time; the newest pose where the time is not between two poses.
    fn at(&self, time_s: f64) -> (Isometry2<f64>, Twist) {
        let around = |pair: &&[(f64, Isometry2<f64>)]| pair[0].0 <= time_s && time_s <= pair[1].0;
        match self.samples.windows(2).rev().find(around) {
            Some([from, to]) if to.0 - from.0 <= LONGEST_GAP_S && to.0 > from.0 => {
                between(from, to, (time_s - from.0) / (to.0 - from.0))
            }
            _ => self.newest(),
        }
    }

    /// Notes a scan of a log: without a pose near it, the last pose holds on until the odometry returns.
    pub(crate) fn note_scan(&mut self, time_s: f64) {
        if self.samples.last().is_some_and(|(last_s, _)| time_s > last_s + LONGEST_GAP_S) {
            self.unknown_s = Some(time_s);
        }
    }

    /// A note if the odometry is missing at times.
    pub(crate) fn holes_note(&self) -> Option<String> {
        let holes = self.holes;
        (holes > 0).then(|| {
            format!(
                "the odometry is missing for more than {LONGEST_GAP_S} s while there are scans, in {holes} places: the way \
                 there is that of the scans alone"
            )
        })
    }

    /// The reading of a scan that ends at a time.
    pub fn reading(&self, time_s: f64, mount: Isometry2<f64>, scan: Scan) -> LaserReading {
        let (pose, twist) = self.at(time_s);
        let sweeps = scan.sweep_s > 0.0;
        let velocities = if sweeps { self.during(time_s - scan.sweep_s, time_s) } else { Vec::new() };
        LaserReading { time_s, pose, twist, velocities, mount, scan }
    }

    /// The mean velocities between the poses in an interval, the earliest first; the last one ends with the interval.
    fn during(&self, from_s: f64, to_s: f64) -> Vec<VelocitySample> {
        let overlaps = |pair: &&[(f64, Isometry2<f64>)]| {
            pair[0].0 + MIN_OVERLAP_S < to_s
                && from_s + MIN_OVERLAP_S < pair[1].0
                && pair[1].0 > pair[0].0
                && pair[1].0 - pair[0].0 <= LONGEST_GAP_S
        };
        let pairs = self.samples.windows(2).filter(overlaps);
        let sample = |pair: &[(f64, Isometry2<f64>)]| {
            let (_, twist) = between(&pair[0], &pair[1], 1.0);
            VelocitySample { time_s: pair[1].0.min(to_s), twist }
        };
        pairs.map(sample).collect()
    }

    /// The newest pose and its velocity.
    pub(crate) fn newest(&self) -> (Isometry2<f64>, Twist) {
        match self.samples.as_slice() {
            [.., from, to] if to.0 > from.0 && to.0 - from.0 <= LONGEST_GAP_S => between(from, to, 1.0),
            _ => (self.last(), Twist::STOP),
        }
    }
}

fn between(from: &(f64, Isometry2<f64>), to: &(f64, Isometry2<f64>), share: f64) -> (Isometry2<f64>, Twist) {
    let (from_s, from) = from;
    let elapsed_s = to.0 - from_s;
    let turn_rad = wrap_rad(heading_rad(&to.1) - heading_rad(from));
    let step = to.1.translation.vector - from.translation.vector;
    let at = from.translation.vector + step * share;
    let twist = Twist {
        linear_mps: from.inv_mul(&to.1).translation.x / elapsed_s,
        angular_radps: turn_rad / elapsed_s,
    };
    (interfaces::pose(at.x, at.y, heading_rad(from) + turn_rad * share), twist)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drives at 1 m/s, without poses from 2 s to 12 s, with or without scans in between.
    fn after_hole(has_scans: bool) -> f64 {
        let mut odometry = Odometry::default();
        for tenth in (0..20).chain(120..130) {
            let time_s = 0.1 * f64::from(tenth);
            if tenth == 120 && has_scans {
                (20..120).for_each(|tenth| {
                    odometry.note_scan(0.1 * f64::from(tenth));
                });
            }
            odometry.add(time_s, interfaces::pose(time_s, 0.0, 0.0));
        }
        odometry.newest().0.translation.x
    }

    #[test]
    fn the_motion_in_a_hole_counts_if_there_were_no_scans() {
        assert!((after_hole(false) - 12.9).abs() < 1e-9);
        // The pose that the scans of the hole were given holds on: 1.9 m, and then 0.9 m more.
        assert!((after_hole(true) - 2.8).abs() < 1e-9);
    }
}
