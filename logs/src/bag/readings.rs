//! The second pass over a bag, and all later ones: reading by reading.

use super::message::{Kind, Message, Usable};
use super::messages::Merged;
use super::motion::{Corrections, MotionSource};
use super::plan::{Laser, Plan};
use crate::assemble::{Assembler, Odometry, Waiting};
use crate::checks::{Doubts, Speeds, typical};
use crate::log;
use crate::summary::{LogError, bare};
use interfaces::LaserReading;
use nalgebra::{Isometry3, Vector2};
use ros::{Header, LaserScan, Transforms, cdr};
use std::sync::Arc;

/// Scans that wait for a later pose, or for an earlier scan of another laser; more are not kept.
const MAX_WAITING: usize = 256;
/// A scan of another laser arrives at most this much later, s.
const DISORDER_S: f64 = 0.5;
/// Scans of two lasers that have the same time, as in simulations, come one after the other, s.
const TURN_S: f64 = 2e-3;
/// Between scans that are farther apart than this, the clock was set, s.
const JUMP_S: f64 = 60.0;
/// The times of an odometry are usable if they advance in at least one of this number of its steps: stamps in whole seconds do not.
const STEPS_PER_TIME: usize = 10;

/// Which times count.
#[derive(Clone, Copy, Debug)]
pub(super) enum Clock {
    /// The stamps of the messages, since this time, ns.
    Stamps(i64),
    /// The times at which the messages were recorded, since this time, ns.
    Recording(i64),
}

impl Clock {
    fn time_s(self, header: &Header, message: &Message) -> f64 {
        let (time_ns, origin_ns) = match self {
            Self::Stamps(origin_ns) => (header.stamp.ns(), origin_ns),
            Self::Recording(origin_ns) => (message.log_ns, origin_ns),
        };
        time_ns.saturating_sub(origin_ns) as f64 * 1e-9
    }

    /// The time of the last beam of a scan, s, from the time of its message: a stamp is that of the first beam, and a scan is recorded
    /// after the last one.
    fn end_s(self, time_s: f64, sweep_s: f64) -> f64 {
        match self {
            Self::Stamps(_) => time_s + sweep_s,
            Self::Recording(_) => time_s,
        }
    }
}

/// What a pass found.
#[derive(Clone, Debug, Default)]
pub(super) struct Counts {
    /// Invalid scans, and why the first is invalid.
    pub(super) invalid_scans: usize,
    pub(super) first_invalid: Option<String>,
    pub(super) poses: usize,
    pub(super) invalid_poses: usize,
    /// Scans at times at which another SLAM gives no pose.
    pub(super) without_pose: usize,
    pub(super) doubts: Doubts,
}

/// The readings of a bag, with times as the bag has them, since its first scan.
pub(super) struct RawReadings {
    messages: Merged,
    plan: Arc<Plan>,
    clock: Clock,
    /// With the laser of each scan. Times are since the begin of the bag.
    pub(super) assembler: Assembler<usize>,
    speeds: Speeds,
    /// The last pose as written, and its time, s.
    last_pose: Option<(f64, Isometry3<f64>)>,
    /// The steps in which the pose changes, and those of them in which the time advances.
    steps: usize,
    timed_steps: usize,
    /// `None`: the poses are those of the odometry.
    corrections: Option<Corrections>,
    /// The number of scans before the clock was set: they do not wait any longer.
    overdue: usize,
    newest_s: f64,
    /// The time of the last reading, s, and its laser.
    last: Option<(f64, usize)>,
    is_over: bool,
    pub(super) counts: Counts,
}

impl RawReadings {
    pub(super) fn new(messages: Merged, plan: &Arc<Plan>, clock: Clock) -> Self {
        let corrections = plan.correction.as_ref().map(|chain| Corrections::new(chain, &plan.frames));
        let odometry = if corrections.is_some() { Odometry::as_written() } else { Odometry::default() };
        Self {
            messages,
            plan: plan.clone(),
            clock,
            assembler: Assembler { frames: plan.frames.clone(), odometry, ..Assembler::default() },
            speeds: Speeds::default(),
            last_pose: None,
            steps: 0,
            timed_steps: 0,
            corrections,
            overdue: 0,
            newest_s: f64::NEG_INFINITY,
            last: None,
            is_over: false,
            counts: Counts::default(),
        }
    }

    /// Whether the first scan that waits has a pose, and no earlier scan can come.
    fn is_ripe(&self) -> bool {
        let waiting = &self.assembler.waiting;
        let Some(first) = waiting.front() else { return false };
        if self.is_over || self.overdue > 0 || waiting.len() > MAX_WAITING {
            return true;
        }
        let has_come = |laser| waiting.iter().any(|scan| scan.tag == laser);
        let is_first = self.newest_s > first.time_s + DISORDER_S || (0..self.plan.lasers.len()).all(has_come);
        // A SLAM corrects itself by a scan after it.
        let is_corrected = self.corrections.is_none() || self.newest_s > first.time_s + DISORDER_S;
        is_first && is_corrected && !self.assembler.must_wait(self.newest_s)
    }

    /// The reading of the first scan; `None` if its pose should be that of another SLAM, and is not known.
    fn reading(&mut self) -> Option<LaserReading> {
        let (mut reading, laser) = self.assembler.next_reading()?;
        let (time_s, odometry) = (reading.time_s, &mut self.assembler.odometry);
        self.overdue = self.overdue.saturating_sub(1);
        let correction = self.corrections.as_ref().and_then(|corrections| corrections.at(time_s));
        if self.corrections.is_some() && (correction.is_none() || !odometry.knows(time_s)) {
            self.counts.without_pose += 1;
            return None;
        }
        odometry.holes.add_scan(time_s);
        if let Some(correction) = correction {
            reading.pose = correction * reading.pose;
        }
        // The last one may have been moved by as many turns as there are lasers.
        let same_s = -TURN_S * self.plan.lasers.len() as f64..TURN_S;
        let is_same = |(last_s, last): (f64, usize)| last != laser && same_s.contains(&(time_s - last_s));
        let time_s = match self.last.filter(|last| is_same(*last)) {
            Some((last_s, _)) => last_s + TURN_S,
            None => time_s,
        };
        self.last = Some((time_s, laser));
        Some(LaserReading { time_s, ..reading })
    }

    /// The corrections of another SLAM in words, with times after `begin_s`; `None` if the poses are those of the odometry.
    pub(super) fn corrections(&self, begin_s: f64) -> Option<String> {
        Some(self.corrections.as_ref()?.described(&self.assembler.odometry.jumps, begin_s))
    }

    /// As [`Odometry::impossible`] and [`Speeds::impossible`].
    pub(super) fn impossible(&self) -> Option<String> {
        self.assembler.odometry.pace.impossible().or_else(|| self.speeds.impossible())
    }

    /// Whether the poses of the odometry have times.
    pub(super) fn has_pose_times(&self) -> bool {
        self.timed_steps * STEPS_PER_TIME >= self.steps
    }

    fn take_scan(&mut self, message: &Message) -> Usable<()> {
        let found: LaserScan = cdr::decoded(&message.data)?;
        let (frame, topic) = (bare(&found.header.frame_id), &message.topic.name);
        let is_this = |laser: &Laser| laser.frame == frame && laser.topic == *topic;
        let Some(laser) = self.plan.lasers.iter().position(is_this) else { return Ok(()) };
        let message_s = self.clock.time_s(&found.header, message);
        let typical = typical(found.ranges.iter().copied());
        let (mount, scan) = match self.assembler.placed(&self.plan.lasers[laser].chain, found) {
            Ok(scan) => scan,
            Err(what) => {
                self.counts.invalid_scans += 1;
                self.counts.first_invalid.get_or_insert_with(|| message.error(what).to_string());
                return Ok(());
            }
        };
        self.counts.doubts.add(typical, &scan.ranges_m);
        let time_s = self.clock.end_s(message_s, scan.sweep_s);
        let waiting = &mut self.assembler.waiting;
        if waiting.back().is_some_and(|last| (last.time_s - time_s).abs() > JUMP_S) {
            self.overdue = waiting.len();
            self.newest_s = time_s;
        }
        let at = waiting.iter().skip(self.overdue).take_while(|scan| scan.time_s <= time_s).count();
        waiting.insert(self.overdue + at, Waiting { time_s, mount, scan, tag: laser });
        self.newest_s = self.newest_s.max(time_s);
        Ok(())
    }

    fn take_odometry(&mut self, message: &Message) -> Usable<()> {
        let found: ros::Odometry = cdr::decoded(&message.data)?;
        self.take_pose(&found.header, message, &found.pose.pose);
        let ros::Vector { x, y, .. } = found.twist.linear;
        let ros::Vector { x: at_x, y: at_y, .. } = found.pose.pose.position;
        let time_s = self.clock.time_s(&found.header, message);
        self.speeds.add(time_s, Vector2::new(at_x, at_y), Vector2::new(x, y).norm());
        Ok(())
    }

    fn take_transforms(&mut self, message: &Message) -> Usable<()> {
        let Transforms { transforms } = cdr::decoded(&message.data)?;
        for found in transforms {
            let Some(pose) = found.transform.isometry() else {
                self.counts.invalid_poses += 1;
                continue;
            };
            let edge = self.assembler.frames.set(&found.header.frame_id, &found.child_frame_id, pose)?;
            if let Some(corrections) = &mut self.corrections {
                let times_s = [self.clock.time_s(&found.header, message), self.newest_s];
                let robot = self.assembler.odometry.newest().0;
                corrections.note(edge, &self.assembler.frames, times_s, &robot);
            }
            if matches!(self.plan.motion, MotionSource::Transform(index) if index == edge) {
                self.take_pose(&found.header, message, &found.transform);
            }
        }
        Ok(())
    }

    fn take_pose(&mut self, header: &Header, message: &Message, pose: &ros::Pose) {
        let Some(pose) = pose.isometry() else {
            self.counts.invalid_poses += 1;
            return;
        };
        let time_s = self.clock.time_s(header, message);
        if let Some((last_s, last)) = self.last_pose.replace((time_s, pose)) {
            if last != pose {
                self.steps += 1;
                self.timed_steps += usize::from(time_s > last_s);
            }
            // Some estimators give the pose of a time again.
            if last_s == time_s {
                return;
            }
        }
        self.newest_s = self.newest_s.max(time_s);
        self.counts.poses += 1;
        self.assembler.add_pose(time_s, &pose, &self.plan.to_base);
    }
}

impl log::RawReadings for RawReadings {
    fn next_reading(&mut self) -> Result<Option<LaserReading>, LogError> {
        loop {
            if self.is_ripe() {
                let reading = self.reading();
                if reading.is_some() {
                    return Ok(reading);
                }
                continue;
            }
            if self.is_over {
                return Ok(None);
            }
            let Some(message) = self.messages.next_message()? else {
                self.is_over = true;
                continue;
            };
            let taken = match Kind::of(&message.topic) {
                Some(Kind::Scans) => self.take_scan(&message),
                Some(Kind::Odometry) => self.take_odometry(&message),
                Some(Kind::Transforms) => self.take_transforms(&message),
                None => Ok(()),
            };
            taken.map_err(|what| message.error(what))?;
        }
    }
}
