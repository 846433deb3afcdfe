//! From messages to readings: scans with the pose of the robot at their time, by the transforms of the robot.

mod motion;

use crate::message::{Header, LaserScan, Message, Odometry, Time, Topic, Transforms};
use interfaces::{LaserReading, Scan};
use logs::ros::{Frames, mounted, scan_of};
use motion::Motions;
use nalgebra::{Isometry2, Isometry3};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// A scan waits this long for a later pose.
const PATIENCE: Duration = Duration::from_millis(500);
/// Scans that wait; more are not kept.
const MAX_WAITING: usize = 64;
/// A scan or a pose that is older than the last one by more than this comes from a clock that has started anew, ns.
const RESTART_NS: i64 = 1_000_000_000;

/// A laser that sends nothing for this time makes way for another one.
const SILENT: Duration = Duration::from_secs(2);

/// The names of the frame of a robot.
const DEFAULT_BASE: &str = "base_footprint";
const OTHER_BASE: &str = "base_link";

/// The names of the frames of a robot.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FrameNames {
    pub(crate) map: String,
    pub(crate) odom: String,
    pub(crate) base: String,
    /// The laser in use; empty: the first one.
    pub(crate) laser: String,
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
pub(crate) struct ScanCount {
    pub(crate) received: u64,
    /// Scans that are none.
    pub(crate) invalid: u64,
    /// Scans whose place on the robot, or whose pose, was not known.
    pub(crate) unplaced: u64,
    /// Scans that are not later than the one before.
    pub(crate) late: u64,
    /// Scans of another laser than the one in use.
    pub(crate) other: u64,
}

struct Waiting {
    end_ns: i64,
    since: Instant,
    mount: Isometry2<f64>,
    scan: Scan,
    is_restart: bool,
}

/// The robot as a source of readings.
#[derive(Default)]
pub(crate) struct Source {
    /// The names as given, and those in use.
    given: FrameNames,
    names: FrameNames,
    is_localized: bool,
    frames: Frames,
    motions: Motions,
    waiting: VecDeque<Waiting>,
    /// The end of the last scan that was taken, ns.
    last_ns: Option<i64>,
    is_restart: bool,
    /// The frame of the laser in use, and when its last scan came.
    laser: Option<(String, Instant)>,
    /// The frame of a laser without a place on the robot.
    lost_laser: Option<String>,
    pub(crate) count: ScanCount,
    notes: Vec<String>,
}

impl Source {
    /// A robot without a message. `is_localized`: this node publishes the transform from the map to the odometry.
    pub(crate) fn new(names: FrameNames, is_localized: bool) -> Self {
        Self { given: names.clone(), names, is_localized, ..Self::default() }
    }

    /// Takes over parameters that have changed. The transforms stay: those that never change are sent once.
    pub(crate) fn configure(&mut self, names: FrameNames, is_localized: bool) {
        self.is_localized = is_localized;
        if names != self.given {
            (self.given, self.names) = (names.clone(), names);
            self.motions = Motions::default();
            self.waiting.clear();
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
            Message::Odometry(odometry) => self.take_odometry(&odometry),
            Message::Transforms(transforms) => {
                self.take_transforms(&transforms, topic == Topic::StaticTransforms);
            }
            _ => {}
        }
    }

    /// The next reading that is complete. A scan without a pose at its time is left out.
    pub(crate) fn next(&mut self, now: Instant) -> Option<LiveReading> {
        loop {
            let first = self.waiting.front()?;
            let is_overdue = now.duration_since(first.since) >= PATIENCE;
            if self.motions.must_wait(first.end_ns) && !is_overdue {
                return None;
            }
            let Waiting { end_ns, mount, scan, is_restart, .. } = self.waiting.pop_front()?;
            if !self.motions.covers(end_ns) {
                self.count.unplaced += 1;
                self.is_restart |= is_restart;
                self.notes.push("a scan is left out: there is no pose of the robot at its time".to_owned());
                continue;
            }
            let (reading, in_odom, in_first_odom) = self.motions.reading(end_ns, mount, scan);
            let stamp = Time::from_ns(end_ns);
            return Some(LiveReading { reading, in_odom, in_first_odom, stamp, is_restart });
        }
    }

    /// Why there is no reading, in one sentence; `None` if it is not known.
    pub(crate) fn obstacle(&self) -> Option<String> {
        let FrameNames { odom, base, .. } = &self.names;
        let known = match self.frames.names().as_slice() {
            [] => "there are no transforms on /tf and /tf_static".to_owned(),
            names => format!("the frames in tf are {}", names.join(", ")),
        };
        if self.motions.is_empty() {
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
        let Some(mount) = self.mount(&message.header.frame_id) else {
            self.count.unplaced += 1;
            return;
        };
        if self.is_other_laser(&message.header.frame_id, now) {
            self.count.other += 1;
            return;
        }
        let scan = mounted(&mount).and_then(|(mount, is_upside_down)| {
            Ok((mount, scan_of(message, is_upside_down).map_err(|why| format!("is not valid: {why}"))?))
        });
        let (mount, scan) = match scan {
            Ok(scan) => scan,
            Err(why) => {
                self.count.invalid += 1;
                self.notes.push(format!("a scan {why}"));
                return;
            }
        };
        if self.motions.is_empty() {
            self.count.unplaced += 1;
            return;
        }
        let end_ns = begin_ns.saturating_add((scan.sweep_s * 1e9).round() as i64);
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
        if self.waiting.len() == MAX_WAITING {
            self.waiting.pop_front();
            self.count.unplaced += 1;
        }
        self.waiting.push_back(Waiting { end_ns, since: now, mount, scan, is_restart });
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

    /// Forgets what another clock has stamped.
    fn restart(&mut self, now_ns: i64) {
        self.count.unplaced += self.waiting.len() as u64;
        self.waiting.clear();
        self.motions.forget_after(now_ns);
        self.is_restart = true;
    }

    /// The place of a laser on the robot.
    fn mount(&mut self, laser: &str) -> Option<Isometry3<f64>> {
        let chain = self.frames.chain(&self.names.base, laser, &[&self.names.odom]);
        let is_lost = chain.is_none();
        if is_lost && self.lost_laser.as_deref() != Some(laser) {
            self.lost_laser = Some(laser.to_owned());
        } else if !is_lost {
            self.lost_laser = None;
        }
        chain.map(|chain| self.frames.along(&chain))
    }

    fn take_odometry(&mut self, message: &Odometry) {
        let Some(pose) = message.pose.pose.isometry() else {
            self.notes.push("a pose of the odometry is not valid".to_owned());
            return;
        };
        self.choose_base(&message.child_frame_id);
        let chain = self.frames.chain(&message.child_frame_id, &self.names.base, &[&self.names.odom]);
        let Some(chain) = chain else { return };
        let pose = pose * self.frames.along(&chain);
        self.notes.extend(self.motions.add_odometry(message.header.stamp.ns(), &pose));
    }

    fn take_transforms(&mut self, message: &Transforms, is_static: bool) {
        let mut edges = Vec::new();
        for found in &message.transforms {
            let Header { stamp, frame_id } = &found.header;
            if bare(frame_id) == self.names.map && bare(&found.child_frame_id) == self.names.odom {
                if self.is_localized {
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
            match self.frames.set(frame_id, &found.child_frame_id, pose) {
                Ok(edge) => edges.push((edge, stamp.ns())),
                Err(why) => self.notes.push(why),
            }
            self.choose_base(&found.child_frame_id);
        }
        if is_static {
            return;
        }
        let Some(chain) = self.frames.chain(&self.names.odom, &self.names.base, &[&self.names.map]) else {
            return;
        };
        let is_in_chain = |(edge, _): &&(usize, i64)| chain.iter().any(|(other, _)| other == edge);
        if let Some((_, stamp_ns)) = edges.iter().filter(is_in_chain).max_by_key(|(_, stamp_ns)| stamp_ns) {
            self.notes.extend(self.motions.add_transform(*stamp_ns, &self.frames.along(&chain)));
        }
    }

    /// The default name of the frame of the robot is that of `slam_toolbox`; many robots have only a `base_link`.
    fn choose_base(&mut self, frame: &str) {
        let has_base = || self.frames.names().contains(&self.names.base.as_str());
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
