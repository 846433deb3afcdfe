//! The motion of the robot by odometry, from tf or from a topic.

use super::RESTART_NS;
use interfaces::{Twist, VelocitySample};
use logs::Odometry;
use logs::ros::flat;
use nalgebra::{Isometry2, Isometry3};

/// A pose that is older than a scan by more than this is not the pose of the scan, s.
const LATEST_S: f64 = 0.1;
/// Odometry on a topic is used if no transform has come for this time, ns.
const WAIT_FOR_TF_NS: i64 = 2_000_000_000;

/// The motion at a time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Motion {
    /// The pose in the frame of the first pose.
    pub(super) pose: Isometry2<f64>,
    /// The pose in the frame of the odometry.
    pub(super) in_odom: Isometry2<f64>,
    pub(super) twist: Twist,
    /// The velocities during the scan that ends at this time.
    pub(super) velocities: Vec<VelocitySample>,
}

/// The poses from one place.
#[derive(Debug, Default)]
struct Track {
    poses: Odometry,
    first_ns: Option<i64>,
    last_ns: Option<i64>,
}

impl Track {
    fn add(&mut self, ns: i64, time_s: impl Fn(i64) -> f64, pose: &Isometry3<f64>) {
        if let Some(last_ns) = self.last_ns.filter(|last_ns| ns <= *last_ns) {
            if last_ns.saturating_sub(ns) < RESTART_NS {
                return;
            }
            *self = Self::default();
        }
        self.first_ns.get_or_insert(ns);
        self.last_ns = Some(ns);
        self.poses.add(time_s(ns), flat(pose));
    }

    fn span_ns(&self) -> i64 {
        self.last_ns.zip(self.first_ns).map_or(0, |(last, first)| last.saturating_sub(first))
    }
}

/// The motion of the robot. Transforms are preferred to messages of odometry.
#[derive(Debug, Default)]
pub(super) struct Motions {
    transforms: Track,
    odometry: Track,
    /// Whether the odometry is used, since there are no transforms.
    uses_odometry: bool,
    /// The time of the first pose: times count from it on, ns.
    origin_ns: Option<i64>,
}

impl Motions {
    pub(super) fn add_transform(&mut self, ns: i64, pose: &Isometry3<f64>) {
        let origin_ns = *self.origin_ns.get_or_insert(ns);
        self.transforms.add(ns, |ns| seconds_since(origin_ns, ns), pose);
    }

    pub(super) fn add_odometry(&mut self, ns: i64, pose: &Isometry3<f64>) {
        let origin_ns = *self.origin_ns.get_or_insert(ns);
        self.odometry.add(ns, |ns| seconds_since(origin_ns, ns), pose);
        self.uses_odometry |= self.transforms.last_ns.is_none() && self.odometry.span_ns() >= WAIT_FOR_TF_NS;
    }

    /// Whether no pose is known.
    pub(super) fn is_empty(&self) -> bool {
        self.track().last_ns.is_none()
    }

    /// A time on the clock of the robot, since the first pose, s.
    pub(super) fn time_s(&self, ns: i64) -> f64 {
        seconds_since(self.origin_ns.unwrap_or(ns), ns)
    }

    /// Whether a later pose can be nearer to this time.
    pub(super) fn must_wait(&self, ns: i64) -> bool {
        self.track().poses.must_wait(self.time_s(ns), self.time_s(ns))
    }

    /// Whether the pose at a time is known.
    pub(super) fn covers(&self, ns: i64) -> bool {
        let time_s = self.time_s(ns);
        self.track()
            .poses
            .span_s()
            .is_some_and(|(oldest_s, newest_s)| oldest_s <= time_s && time_s <= newest_s + LATEST_S)
    }

    /// The motion at a time, at the end of a scan that took `sweep_s`.
    pub(super) fn at(&self, ns: i64, sweep_s: f64) -> Motion {
        let (poses, time_s) = (&self.track().poses, self.time_s(ns));
        let (pose, twist) = poses.at(time_s);
        let velocities = if sweep_s > 0.0 { poses.during(time_s - sweep_s, time_s) } else { Vec::new() };
        Motion { pose, in_odom: poses.origin() * pose, twist, velocities }
    }

    /// Forgets poses that another clock has stamped: those that are later than a time by more than a second.
    pub(super) fn forget_after(&mut self, ns: i64) {
        for track in [&mut self.transforms, &mut self.odometry] {
            if track.last_ns.is_some_and(|last_ns| last_ns.saturating_sub(ns) > RESTART_NS) {
                *track = Track::default();
            }
        }
    }

    fn track(&self) -> &Track {
        if self.uses_odometry { &self.odometry } else { &self.transforms }
    }
}

fn seconds_since(origin_ns: i64, ns: i64) -> f64 {
    ns.saturating_sub(origin_ns) as f64 * 1e-9
}
