//! Odometry: the sum of its motions, and its pose at the time of a scan.

use crate::checks::{Holes, Jumps, LONGEST_GAP_S, MIN_MOTION_M, MIN_MOTION_RAD, Pace};
use interfaces::{LaserReading, Scan, Twist, VelocitySample, heading_rad, wrap_rad};
use nalgebra::Isometry2;

/// Intervals that overlap by less than this do so by rounding, s.
const MIN_OVERLAP_S: f64 = 1e-6;
/// The number of poses that are kept: some messages arrive later than others.
const KEPT: usize = 256;
/// The same of poses as written: scans wait for corrections up to half a second, and there are 1000 poses per second and more.
const KEPT_AS_WRITTEN: usize = 1024;

/// Poses of another SLAM that demand a higher speed than this have been corrected in between, m/s and rad/s: robots indoors drive
/// at most 2 m/s.
const MAX_MPS: f64 = 3.0;
const MAX_RADPS: f64 = 4.0;
/// An odometry that demands such a speed over a longer step than this, m and rad, starts anew: its driver was started again. A pose
/// that is wrong once makes two such steps. Where more of them follow each other, lengths or times are in another unit.
const MIN_RESTART_M: f64 = 0.5;
const MIN_RESTART_RAD: f64 = 0.5;
const MAX_RESTARTS: usize = 2;

/// The recent poses of a robot by odometry, as the sum of its motions since the first one: the first pose is the origin.
#[derive(Debug, Default)]
pub struct Odometry {
    /// The first and the last pose as written.
    first: Option<Isometry2<f64>>,
    written: Option<Isometry2<f64>>,
    /// The origin of the motions since the odometry was missing or started anew.
    origin: Option<Isometry2<f64>>,
    /// The times (s) and the sums of the motions, the newest last.
    samples: Vec<(f64, Isometry2<f64>)>,
    /// The largest distance from the first pose, m, and the largest turn since then, rad.
    farthest_m: f64,
    farthest_rad: f64,
    pub(crate) pace: Pace,
    /// Where scans have no pose near them: there, the last pose holds on until the odometry returns.
    pub(crate) holes: Holes,
    /// The number of starts anew, and the first one: its time, s, and its step; the number of such steps up to the last pose.
    restarts: usize,
    first_restart: Option<(f64, Isometry2<f64>)>,
    leaps: usize,
    /// Whether the poses are kept as written, with their jumps.
    is_as_written: bool,
    pub(crate) jumps: Jumps,
}

impl Odometry {
    /// Keeps poses as they are written, in a frame in which another SLAM has them. A jump is no motion: the motion before it goes on
    /// until then.
    pub(crate) fn as_written() -> Self {
        Self { is_as_written: true, ..Self::default() }
    }

    /// Adds a pose as written. Returns its step, in the frame of the pose before it, if the odometry starts anew with it: that is no
    /// motion.
    pub fn add(&mut self, time_s: f64, pose: Isometry2<f64>) -> Option<Isometry2<f64>> {
        let is_hole = !self.is_as_written && self.holes.add_pose(time_s);
        let elapsed_s = self.samples.last().map_or(0.0, |(last_s, _)| time_s - last_s);
        let before = self.written.filter(|_| !is_hole);
        let mut motion = before.map_or(Isometry2::identity(), |before| before.inv_mul(&pose));
        let (step_m, step_rad) = (motion.translation.vector.norm(), heading_rad(&motion).abs());
        let is_too_fast = step_m > MAX_MPS * elapsed_s || step_rad > MAX_RADPS * elapsed_s;
        // Over two steps: after a gap, the time of one pose can be late.
        let since_s = self.samples.iter().rev().nth(1).map_or(elapsed_s, |(before_s, _)| time_s - before_s);
        let is_leap = elapsed_s > 0.0
            && (step_m > MIN_RESTART_M.max(MAX_MPS * since_s)
                || step_rad > MIN_RESTART_RAD.max(MAX_RADPS * since_s));
        self.leaps = if is_leap { self.leaps + 1 } else { 0 };
        let is_restart = is_leap && self.leaps <= MAX_RESTARTS && !self.is_as_written;
        let restart = is_restart.then_some(motion);
        if let Some(step) = restart {
            self.restarts += 1;
            self.first_restart.get_or_insert((time_s, step));
            motion = Isometry2::identity();
        }
        self.first.get_or_insert(pose);
        self.written = Some(pose);
        let mut at = self.last() * motion;
        at.rotation.renormalize();
        if self.is_as_written {
            at = pose;
        }
        if is_hole || restart.is_some() {
            self.origin = Some(pose * at.inverse());
        }
        self.pace.add(elapsed_s, &motion);
        let since_first = if self.is_as_written { self.first().inv_mul(&at) } else { at };
        self.farthest_m = self.farthest_m.max(since_first.translation.vector.norm());
        self.farthest_rad = self.farthest_rad.max(heading_rad(&since_first).abs());
        if self.is_as_written && elapsed_s > 0.0 && is_too_fast {
            let (last, Twist { linear_mps, angular_radps }) = self.newest();
            let on_s = elapsed_s.min(LONGEST_GAP_S);
            let unjumped = last * interfaces::pose(linear_mps * on_s, 0.0, angular_radps * on_s);
            self.jumps.add(time_s, &unjumped.inv_mul(&pose));
            self.keep(time_s, unjumped);
        }
        self.keep(time_s, at);
        restart
    }

    fn keep(&mut self, time_s: f64, pose: Isometry2<f64>) {
        if self.samples.len() == if self.is_as_written { KEPT_AS_WRITTEN } else { KEPT } {
            self.samples.remove(0);
        }
        self.samples.push((time_s, pose));
    }

    /// Whether there is a pose at a time, or at most 2 s before it.
    pub(crate) fn knows(&self, time_s: f64) -> bool {
        self.samples.iter().rev().any(|(sample_s, _)| (0.0..=LONGEST_GAP_S).contains(&(time_s - sample_s)))
    }

    /// A note if the odometry starts anew, with times after `begin_s`.
    pub(crate) fn restarts_note(&self, begin_s: f64) -> Option<String> {
        let (time_s, step) = self.first_restart?;
        let times = if self.restarts == 1 { "once" } else { &format!("{} times", self.restarts) };
        Some(format!(
            "the odometry jumps faster than any robot moves, {times} (the first time by {:.2} m and {:.1}° at {:.1} s): such a jump is \
             a new start of the odometry, and no motion",
            step.translation.vector.norm(),
            heading_rad(&step).to_degrees().abs(),
            time_s - begin_s
        ))
    }

    /// The first pose, as written: the origin of all others, until the odometry starts anew; the identity without a pose.
    pub fn first(&self) -> Isometry2<f64> {
        self.first.unwrap_or_default()
    }

    /// The origin of the newest poses: `origin * pose` is the pose as it is written at that time. It is the first pose, until the
    /// odometry starts anew.
    pub fn origin(&self) -> Isometry2<f64> {
        self.origin.unwrap_or_else(|| self.first())
    }

    /// Whether the robot has not moved so far, except for a drift.
    pub(crate) fn stands(&self) -> bool {
        self.farthest_m < MIN_MOTION_M && self.farthest_rad < MIN_MOTION_RAD
    }

    /// Motions are measured from this pose on.
    pub fn set_origin(&mut self, pose: Isometry2<f64>) {
        self.written = Some(pose);
        self.origin = Some(pose * self.last().inverse());
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
        self.samples.last().is_some_and(|(last_s, _)| *last_s < time_s && now_s - time_s < LONGEST_GAP_S)
    }

    /// The pose and the velocity at a time; the nearer pose in a long time without one, and the newest pose after all.
    fn at(&self, time_s: f64) -> (Isometry2<f64>, Twist) {
        let around = |pair: &&[(f64, Isometry2<f64>)]| pair[0].0 <= time_s && time_s <= pair[1].0;
        match self.samples.windows(2).rev().find(around) {
            Some([from, to]) if to.0 - from.0 <= LONGEST_GAP_S && to.0 > from.0 => {
                between(from, to, (time_s - from.0) / (to.0 - from.0))
            }
            Some([from, to]) => {
                let nearer = if time_s - from.0 <= to.0 - time_s { from } else { to };
                (nearer.1, Twist::STOP)
            }
            _ => self.newest(),
        }
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
                    odometry.holes.add_scan(0.1 * f64::from(tenth));
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

    /// Drives 0.1 m per pose, in this unit of length, at 10 Hz; then `change` gives the pose as written, by its number.
    fn driven(unit_m: f64, change: impl Fn(u32, f64) -> [f64; 3]) -> Odometry {
        let mut odometry = Odometry::default();
        for step in 0..100 {
            let [x, y, theta] = change(step, 0.1 * f64::from(step) / unit_m);
            odometry.add(0.1 * f64::from(step), interfaces::pose(x, y, theta));
        }
        odometry
    }

    #[test]
    fn an_odometry_that_starts_anew_does_not_move() {
        let restarted = driven(1.0, |step, x| if step < 60 { [x, 0.0, 0.0] } else { [0.0, x - 6.0, 1.57] });
        let turned = driven(1.0, |step, x| [x, 0.0, if step < 60 { 0.0 } else { 3.0 }]);
        let at = |odometry: &Odometry| odometry.newest().0.translation.x;
        // The motion of one step is not known.
        assert!((at(&restarted) - 9.8).abs() < 0.01, "{}", at(&restarted));
        let note = restarted.restarts_note(1.0).unwrap();
        let expected = "the odometry jumps faster than any robot moves, once (the first time by 5.90 m and 90.0° at 5.0 s): such a \
                        jump is a new start of the odometry, and no motion";
        assert_eq!(note, expected);
        assert!(turned.restarts_note(0.0).unwrap().contains("171.9° at 6.0 s"));
        // The pose as written is known all the same.
        let in_frame = restarted.origin() * restarted.newest().0;
        assert!(
            (in_frame.translation.y - 3.9).abs() < 1e-9 && in_frame.translation.x.abs() < 1e-9,
            "{in_frame}"
        );
        assert_eq!(restarted.first(), Isometry2::identity());
    }

    #[test]
    fn one_wrong_pose_is_no_motion() {
        let odometry = driven(1.0, |step, x| [if step == 60 { 50.0 } else { x }, 0.0, 0.0]);
        assert!((odometry.newest().0.translation.x - 9.7).abs() < 1e-9);
        assert!(odometry.restarts_note(0.0).unwrap().contains(" 2 times (the first time by 44.10 m"));
    }

    #[test]
    fn another_unit_is_no_start_anew() {
        let odometry = driven(1e-3, |_, x| [x, 0.0, 0.0]);
        assert!(odometry.newest().0.translation.x > 9000.0);
        assert_eq!(driven(1.0, |_, x| [x, 0.0, 0.0]).restarts_note(0.0), None);
        // Without times, nothing is too fast.
        let mut untimed = Odometry::default();
        for step in 0..5 {
            untimed.add(0.0, interfaces::pose(f64::from(step), 0.0, 0.0));
        }
        assert_eq!(untimed.newest().0.translation.x, 4.0);
    }
}
