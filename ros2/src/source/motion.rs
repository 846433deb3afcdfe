//! The motion of the robot by odometry, from tf or from a topic.

use super::RESTART_NS;
use interfaces::{LaserReading, Scan, heading_rad};
use logs::Odometry;
use logs::ros::flat;
use nalgebra::{Isometry2, Isometry3};

/// A pose that is older than a scan by more than this is not the pose of the scan, s.
const LATEST_S: f64 = 0.1;
/// Odometry on a topic is used if no transform has come for this time, ns.
const WAIT_FOR_TF_NS: i64 = 2_000_000_000;

/// The poses from tf, or those from a topic.
#[derive(Debug, Default)]
struct PoseStream {
    poses: Odometry,
    first_ns: Option<i64>,
    last_ns: Option<i64>,
}

impl PoseStream {
    /// Adds a pose. Says so if the odometry was reset: that is no motion.
    fn add(&mut self, ns: i64, time_s: impl Fn(i64) -> f64, pose: &Isometry3<f64>) -> Option<String> {
        if let Some(last_ns) = self.last_ns.filter(|last_ns| ns <= *last_ns) {
            if last_ns.saturating_sub(ns) < RESTART_NS {
                return None;
            }
            *self = Self::default();
        }
        let elapsed_s = seconds_since(self.last_ns.unwrap_or(ns), ns);
        self.first_ns.get_or_insert(ns);
        self.last_ns = Some(ns);
        self.poses.add(time_s(ns), flat(pose)).map(|step| reset(&step, elapsed_s))
    }

    fn span_ns(&self) -> i64 {
        self.last_ns.zip(self.first_ns).map_or(0, |(last, first)| last.saturating_sub(first))
    }
}

/// The motion of the robot. Transforms are preferred to messages of odometry.
#[derive(Debug, Default)]
pub(super) struct Motions {
    transforms: PoseStream,
    odometry: PoseStream,
    /// Whether the odometry is used, since there are no transforms.
    uses_odometry: bool,
    /// The time of the first pose: times count from it on, ns.
    origin_ns: Option<i64>,
}

impl Motions {
    /// Adds a pose from tf. Says so if the odometry was reset.
    pub(super) fn add_transform(&mut self, ns: i64, pose: &Isometry3<f64>) -> Option<String> {
        let origin_ns = *self.origin_ns.get_or_insert(ns);
        let reset = self.transforms.add(ns, |ns| seconds_since(origin_ns, ns), pose);
        reset.filter(|_| !self.uses_odometry)
    }

    /// Adds a pose from a topic. Says so if the odometry was reset.
    pub(super) fn add_odometry(&mut self, ns: i64, pose: &Isometry3<f64>) -> Option<String> {
        let origin_ns = *self.origin_ns.get_or_insert(ns);
        let reset = self.odometry.add(ns, |ns| seconds_since(origin_ns, ns), pose);
        self.uses_odometry |= self.transforms.last_ns.is_none() && self.odometry.span_ns() >= WAIT_FOR_TF_NS;
        reset.filter(|_| self.uses_odometry)
    }

    /// Whether no pose is known.
    pub(super) fn is_empty(&self) -> bool {
        self.used().last_ns.is_none()
    }

    /// A time on the clock of the robot, since the first pose, s.
    fn time_s(&self, ns: i64) -> f64 {
        seconds_since(self.origin_ns.unwrap_or(ns), ns)
    }

    /// Whether a later pose can be nearer to this time.
    pub(super) fn must_wait(&self, ns: i64) -> bool {
        self.used().poses.must_wait(self.time_s(ns), self.time_s(ns))
    }

    /// Whether the pose at a time is known.
    pub(super) fn covers(&self, ns: i64) -> bool {
        let time_s = self.time_s(ns);
        self.used()
            .poses
            .span_s()
            .is_some_and(|(oldest_s, newest_s)| oldest_s <= time_s && time_s <= newest_s + LATEST_S)
    }

    /// The reading of a scan that ends at a time, its pose in the frame of the odometry, and the same without resets: in the frame
    /// of the first odometry.
    pub(super) fn reading(
        &self,
        ns: i64,
        mount: Isometry2<f64>,
        scan: Scan,
    ) -> (LaserReading, Isometry2<f64>, Isometry2<f64>) {
        let poses = &self.used().poses;
        let reading = poses.reading(self.time_s(ns), mount, scan);
        let (in_odom, in_first_odom) = (poses.origin() * reading.pose, poses.first() * reading.pose);
        (reading, in_odom, in_first_odom)
    }

    /// Forgets poses that another clock has stamped: those that are later than a time by more than a second.
    pub(super) fn forget_after(&mut self, ns: i64) {
        for stream in [&mut self.transforms, &mut self.odometry] {
            if stream.last_ns.is_some_and(|last_ns| last_ns.saturating_sub(ns) > RESTART_NS) {
                *stream = PoseStream::default();
            }
        }
    }

    fn used(&self) -> &PoseStream {
        if self.uses_odometry { &self.odometry } else { &self.transforms }
    }
}

/// What is said of a step of the odometry that is no motion.
fn reset(step: &Isometry2<f64>, elapsed_s: f64) -> String {
    let (step_m, step_rad) = (step.translation.vector.norm(), heading_rad(step).abs());
    format!(
        "the odometry jumps by {step_m:.2} m and {step_rad:.2} rad in {elapsed_s:.2} s: it was reset, and the jump is no motion"
    )
}

fn seconds_since(origin_ns: i64, ns: i64) -> f64 {
    ns.saturating_sub(origin_ns) as f64 * 1e-9
}
