//! From messages to readings: scans with the pose of the robot at their time, by the transforms of the robot.

use crate::message::{Header, LaserScan, Message, Odometry, Time, Topic, Transforms};
use interfaces::{LaserReading, heading_rad};
use logs::LaserCheck;
use logs::assemble::{self, Assembler, Chain, Waiting};
use nalgebra::{Isometry2, Isometry3};
use std::time::{Duration, Instant};

/// A scan waits this long for a later pose.
const PATIENCE: Duration = Duration::from_millis(500);
/// Scans that wait; more are not kept.
const MAX_WAITING: usize = 64;
/// A scan or a pose that is older than the last one by more than this comes from a clock that has started anew, ns.
const RESTART_NS: i64 = 1_000_000_000;
/// A pose that is older than a scan by more than this is not the pose of the scan, s.
const LATEST_S: f64 = 0.1;
/// Odometry on a topic is used if no transform has come for this time, ns.
const WAIT_FOR_TF_NS: i64 = 2_000_000_000;
/// A laser that sends nothing for this time makes way for another one.
const SILENT: Duration = Duration::from_secs(2);

/// The names of the frame of a robot.
const DEFAULT_BASE: &str = "base_footprint";
const OTHER_BASE: &str = "base_link";

/// The names of the frames of a robot, and who connects them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FrameNames {
    pub(crate) map: String,
    pub(crate) odom: String,
    pub(crate) base: String,
    /// The laser in use; empty: the first one.
    pub(crate) laser: String,
    /// Whether this node publishes the transform from the map to the odometry.
    pub(crate) are_connected: bool,
}

/// A reading of the robot, with what it takes to publish transforms.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LiveReading {
    /// The reading. Its time is that of the robot's clock since the first pose, s; its pose is that by odometry in the
    /// frame of the first pose.
    pub(crate) reading: LaserReading,
    /// The pose in the frame of the odometry.
    pub(crate) in_odom: Isometry2<f64>,
    /// The same in the frame that the odometry had before it was reset: it does not jump.
    pub(crate) in_first_odom: Isometry2<f64>,
    /// The time of the reading.
    pub(crate) stamp: Time,
    /// Whether the clock has started anew since the reading before.
    pub(crate) is_restart: bool,
}

/// How many scans came, and what happened to them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScanCount {
    /// All scans.
    pub received: u64,
    /// Scans that are not valid.
    pub invalid: u64,
    /// Scans whose place on the robot, or whose pose, was not known.
    pub unplaced: u64,
    /// Scans that are not later than the one before.
    pub late: u64,
    /// Scans of another laser than the one in use.
    pub other: u64,
}

/// What is known of a scan that waits.
#[derive(Debug)]
struct Arrival {
    end_ns: i64,
    since: Instant,
    is_restart: bool,
}

/// The clock of one kind of messages. A stamp that runs ahead of the time that has passed here is left out,
/// unless the next one confirms it: as in a log, a clock that is wrong for one message is no other time, and
/// a clock that was set is.
#[derive(Default)]
struct Clock {
    /// The last stamp, ns, and when it came.
    last: Option<(i64, Instant)>,
    /// The stamp that was left out last, if it was the last one.
    ahead_ns: Option<i64>,
}

impl Clock {
    /// Takes a stamp, ns. If it is to be left out: by how much it is ahead, s.
    fn ahead_s(&mut self, ns: i64, now: Instant) -> Option<f64> {
        let passed_ns =
            |since: Instant| i64::try_from(now.duration_since(since).as_nanos()).unwrap_or(i64::MAX);
        let expected = self.last.map(|(last_ns, since)| last_ns.saturating_add(passed_ns(since)));
        let ahead_ns = expected.map_or(0, |expected_ns| ns.saturating_sub(expected_ns));
        let is_confirmed = self.ahead_ns.is_some_and(|ahead| ns.saturating_sub(ahead).abs() < RESTART_NS);
        if ahead_ns > RESTART_NS && !is_confirmed {
            self.ahead_ns = Some(ns);
            return Some(ahead_ns as f64 * 1e-9);
        }
        *self = Self { last: Some((ns, now)), ahead_ns: None };
        None
    }
}

/// Where the poses come from. Transforms are preferred to messages of odometry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum PoseSource {
    /// Messages have come, and transforms may still come.
    #[default]
    Unknown,
    Transforms,
    Topic,
}

/// The robot as a source of readings.
#[derive(Default)]
pub(crate) struct Source {
    /// The names as given, and those in use.
    given: FrameNames,
    names: FrameNames,
    /// Times are since the first pose.
    assembler: Assembler<Arrival>,
    poses: PoseSource,
    /// The clocks of the scans and of the poses.
    scan_clock: Clock,
    pose_clock: Clock,
    /// The time of the first pose of all, ns: times count from it on.
    origin_ns: Option<i64>,
    /// The times of the first and the last pose by the clock of now, ns.
    pose_span_ns: Option<(i64, i64)>,
    /// The end of the last scan that was taken, ns.
    last_ns: Option<i64>,
    is_restart: bool,
    /// The frame of the laser in use, and when its last scan came.
    laser: Option<(String, Instant)>,
    /// The frame of a laser without a place on the robot.
    lost_laser: Option<String>,
    laser_check: LaserCheck,
    pub(crate) count: ScanCount,
    notes: Vec<String>,
}

impl Source {
    /// A robot without a message.
    pub(crate) fn new(names: FrameNames) -> Self {
        Self { given: names.clone(), names, ..Self::default() }
    }

    /// Takes over parameters that have changed. The transforms stay: those that never change are sent once.
    pub(crate) fn configure(&mut self, names: FrameNames) {
        if names != self.given {
            (self.given, self.names) = (names.clone(), names);
            self.forget_poses();
            (self.poses, self.origin_ns) = (PoseSource::Unknown, None);
            self.assembler.waiting.clear();
        }
    }

    /// The frame of the robot in use.
    pub(crate) fn base(&self) -> &str {
        &self.names.base
    }

    /// What cannot be used since the last call, in sentences.
    pub(crate) fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Takes a message; others than those of the robot are ignored.
    pub(crate) fn take(&mut self, topic: Topic, message: Message, now: Instant) {
        match message {
            Message::Scan(scan) => self.take_scan(scan, now),
            Message::Odometry(odometry) => self.take_odometry(&odometry, now),
            Message::Transforms(transforms) => {
                self.take_transforms(&transforms, topic == Topic::StaticTransforms, now);
            }
            _ => {}
        }
    }

    /// The next reading that is complete. A scan without a pose at its time is left out.
    pub(crate) fn next(&mut self, now: Instant) -> Option<LiveReading> {
        loop {
            let first = self.assembler.waiting.front()?;
            let is_overdue = now.duration_since(first.tag.since) >= PATIENCE;
            if self.assembler.must_wait(first.time_s) && !is_overdue {
                return None;
            }
            let (mut reading, Arrival { end_ns, is_restart, .. }) = self.assembler.next_reading()?;
            let (odometry, time_s) = (&self.assembler.odometry, reading.time_s);
            let covers = |(oldest_s, newest_s)| oldest_s <= time_s && time_s <= newest_s + LATEST_S;
            if !odometry.span_s().is_some_and(covers) {
                self.count.unplaced += 1;
                self.is_restart |= is_restart;
                self.notes.push("a scan is left out: there is no pose of the robot at its time".to_owned());
                continue;
            }
            self.laser_check.add(&reading);
            self.notes.extend(self.laser_check.judge());
            self.laser_check.apply(&mut reading);
            let (in_odom, in_first_odom) =
                (odometry.origin() * reading.pose, odometry.first() * reading.pose);
            let stamp = Time::from_ns(end_ns);
            return Some(LiveReading { reading, in_odom, in_first_odom, stamp, is_restart });
        }
    }

    /// Why there is no reading, in one sentence; `None` if it is not known.
    pub(crate) fn obstacle(&self) -> Option<String> {
        let FrameNames { odom, base, .. } = &self.names;
        let known = match self.assembler.frames.names().as_slice() {
            [] => "there are no transforms on /tf and /tf_static".to_owned(),
            names => format!("the frames in tf are {}", names.join(", ")),
        };
        if !self.has_pose() {
            return Some(format!(
                "no pose: neither is there a transform from `{odom}` to `{base}`, nor odometry for `{base}`; {known}"
            ));
        }
        let laser = self.lost_laser.as_ref()?;
        Some(format!("no place of the laser: `{laser}` is not connected with `{base}`; {known}"))
    }

    fn take_scan(&mut self, message: LaserScan, now: Instant) {
        self.count.received += 1;
        let begin_ns = message.header.stamp.ns();
        let Some(chain) = self.chain_to(&message.header.frame_id) else {
            self.count.unplaced += 1;
            return;
        };
        if self.is_other_laser(&message.header.frame_id, now) {
            self.count.other += 1;
            return;
        }
        let (mount, scan) = match self.assembler.placed(&chain, message) {
            Ok(scan) => scan,
            Err(why) => {
                self.count.invalid += 1;
                self.notes.push(format!("a scan is not valid: {why}"));
                return;
            }
        };
        if !self.has_pose() {
            self.count.unplaced += 1;
            return;
        }
        let end_ns = begin_ns.saturating_add((scan.sweep_s * 1e9).round() as i64);
        if let Some(ahead_s) = self.scan_clock.ahead_s(end_ns, now) {
            self.count.invalid += 1;
            self.notes.push(format!("a scan is left out: its stamp is {ahead_s:.1} s ahead of the clock"));
            return;
        }
        if let Some(last_ns) = self.last_ns.filter(|last_ns| end_ns <= *last_ns) {
            if last_ns.saturating_sub(end_ns) < RESTART_NS {
                self.count.late += 1;
                return;
            }
            self.notes.push(format!(
                "the clock of the scans has gone back by {:.1} s: another session begins",
                last_ns.saturating_sub(end_ns) as f64 * 1e-9
            ));
            self.restart(end_ns);
        }
        self.last_ns = Some(end_ns);
        let is_restart = std::mem::take(&mut self.is_restart);
        let (time_s, waiting) = (self.time_s(end_ns), &mut self.assembler.waiting);
        if waiting.len() == MAX_WAITING {
            waiting.pop_front();
            self.count.unplaced += 1;
        }
        waiting.push_back(Waiting { time_s, mount, scan, tag: Arrival { end_ns, since: now, is_restart } });
    }

    /// Whether a scan is of another laser than the one in use. A map of changes needs to know from where each cell was seen, so that the
    /// scans of two lasers are not put together.
    fn is_other_laser(&mut self, frame: &str, now: Instant) -> bool {
        let wanted = &self.names.laser;
        let is_in_use =
            |(laser, last): &(String, Instant)| laser != frame && now.duration_since(*last) < SILENT;
        let used = match (wanted.is_empty(), self.laser.as_ref().filter(|laser| is_in_use(laser))) {
            (false, _) if frame != wanted => wanted.clone(),
            (true, Some((laser, _))) => laser.clone(),
            _ => {
                self.laser = Some((frame.to_owned(), now));
                return false;
            }
        };
        self.notes.push(format!(
            "scans come from more than one laser: those of `{used}` are used, and those of `{frame}` are left out; the parameter \
             `laser_frame` chooses another one"
        ));
        true
    }

    /// Forgets what another clock has stamped: poses that are later than now by more than a second.
    fn restart(&mut self, now_ns: i64) {
        self.count.unplaced += self.assembler.waiting.len() as u64;
        self.assembler.waiting.clear();
        if self.pose_span_ns.is_some_and(|(_, last_ns)| last_ns.saturating_sub(now_ns) > RESTART_NS) {
            self.forget_poses();
            if self.poses == PoseSource::Transforms {
                self.poses = PoseSource::Unknown;
            }
        }
        self.is_restart = true;
    }

    fn forget_poses(&mut self) {
        (self.assembler.odometry, self.pose_span_ns) = (assemble::Odometry::default(), None);
    }

    /// Whether a pose is known, and its source.
    fn has_pose(&self) -> bool {
        self.poses != PoseSource::Unknown && self.pose_span_ns.is_some()
    }

    /// A time since the first pose, s.
    fn time_s(&self, ns: i64) -> f64 {
        ns.saturating_sub(self.origin_ns.unwrap_or(ns)) as f64 * 1e-9
    }

    /// Adds a pose that is not older than the last one. If the odometry was reset, that is no motion.
    fn add_pose(&mut self, ns: i64, pose: &Isometry3<f64>, chain: &Chain, now: Instant) {
        if let Some(ahead_s) = self.pose_clock.ahead_s(ns, now) {
            self.notes.push(format!("a pose is left out: its stamp is {ahead_s:.1} s ahead of the clock"));
            return;
        }
        if let Some((_, last_ns)) = self.pose_span_ns.filter(|(_, last_ns)| ns <= *last_ns) {
            if last_ns.saturating_sub(ns) < RESTART_NS {
                return;
            }
            self.forget_poses();
        }
        self.origin_ns.get_or_insert(ns);
        let (first_ns, last_ns) = self.pose_span_ns.unwrap_or((ns, ns));
        self.pose_span_ns = Some((first_ns, ns));
        let reset = self.assembler.add_pose(self.time_s(ns), pose, chain);
        if let Some(step) = reset.filter(|_| self.poses != PoseSource::Unknown) {
            let (step_m, step_rad) = (step.translation.vector.norm(), heading_rad(&step).abs());
            let elapsed_s = ns.saturating_sub(last_ns) as f64 * 1e-9;
            self.notes.push(format!(
                "the odometry jumps by {step_m:.2} m and {step_rad:.2} rad in {elapsed_s:.2} s: it was reset, and the jump is \
                 no motion"
            ));
        }
    }

    /// The transforms from the robot to a laser.
    fn chain_to(&mut self, laser: &str) -> Option<Chain> {
        let chain = self.assembler.frames.chain(&self.names.base, laser, &[&self.names.odom]);
        self.lost_laser = chain.is_none().then(|| laser.to_owned());
        chain
    }

    fn take_odometry(&mut self, message: &Odometry, now: Instant) {
        let Some(pose) = message.pose.pose.isometry() else {
            self.notes.push("a pose of the odometry is not valid".to_owned());
            return;
        };
        self.choose_base(&message.child_frame_id);
        let frames = &self.assembler.frames;
        let chain = frames.chain(&message.child_frame_id, &self.names.base, &[&self.names.odom]);
        let Some(chain) = chain.filter(|_| self.poses != PoseSource::Transforms) else { return };
        self.add_pose(message.header.stamp.ns(), &pose, &chain, now);
        if self.pose_span_ns.is_some_and(|(first_ns, last_ns)| last_ns - first_ns >= WAIT_FOR_TF_NS) {
            self.poses = PoseSource::Topic;
        }
    }

    fn take_transforms(&mut self, message: &Transforms, is_static: bool, now: Instant) {
        let mut edges = Vec::new();
        for found in &message.transforms {
            let Header { stamp, frame_id } = &found.header;
            if bare(frame_id) == self.names.map && bare(&found.child_frame_id) == self.names.odom {
                if self.names.are_connected {
                    let (map, odom) = (&self.names.map, &self.names.odom);
                    self.notes.push(format!(
                        "another node publishes the transform from `{map}` to `{odom}` as well; to leave it to the other one, \
                         set `transform_publish_period` to 0"
                    ));
                }
                continue;
            }
            let Some(pose) = found.transform.isometry() else {
                self.notes.push(format!("the transform to `{}` is not valid", found.child_frame_id));
                continue;
            };
            match self.assembler.frames.set(frame_id, &found.child_frame_id, pose) {
                Ok(edge) => edges.push((edge, stamp.ns())),
                Err(why) => self.notes.push(why),
            }
            self.choose_base(&found.child_frame_id);
        }
        if is_static {
            return;
        }
        let frames = &self.assembler.frames;
        let Some(chain) = frames.chain(&self.names.odom, &self.names.base, &[&self.names.map]) else {
            return;
        };
        let is_in_chain = |(edge, _): &&(usize, i64)| chain.iter().any(|(other, _)| other == edge);
        if let Some((_, stamp_ns)) = edges.iter().filter(is_in_chain).max_by_key(|(_, stamp_ns)| stamp_ns) {
            let pose = frames.along(&chain);
            if self.poses == PoseSource::Unknown {
                self.forget_poses();
                self.poses = PoseSource::Transforms;
            }
            if self.poses == PoseSource::Transforms {
                self.add_pose(*stamp_ns, &pose, &Chain::new(), now);
            }
        }
    }

    /// The default name of the frame of the robot is that of `slam_toolbox`; many robots have only a `base_link`.
    fn choose_base(&mut self, frame: &str) {
        let has_base = || self.assembler.frames.names().contains(&self.names.base.as_str());
        if self.names.base == DEFAULT_BASE && bare(frame) == OTHER_BASE && !has_base() {
            self.notes.push(format!("there is no frame `{DEFAULT_BASE}`: the robot is at `{OTHER_BASE}`"));
            self.names.base = OTHER_BASE.to_owned();
        }
    }
}

/// A name without the slash that older robots write before it.
fn bare(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

#[cfg(test)]
mod tests;
