//! Bags of ROS 2 (rosbag2): MCAP files and SQLite databases, several of them one after the other.
//!
//! A bag is read three times: for its topics and frames, for the times of its scans, and reading by reading. Each time it
//! is a stream, or a stream per topic: memory does not grow with the bag.

mod chunk;
mod files;
mod inventory;
mod mcap;
mod message;
mod messages;
mod motion;
mod plan;
mod readings;
mod sqlite;
#[cfg(test)]
mod tests;

pub(crate) use files::{BagFile, in_folder};

use crate::bounds;
use crate::bytes::content_hash;
use crate::checks::times::{self, Times};
use crate::checks::{Looks, Standing};
use crate::laser_check::LaserCheck;
use crate::log::{self, Log, RawReadings as _, Source};
use crate::summary::{LogError, LogSummary, TopicChoice, since_epoch};
use inventory::Inventory;
use message::Topic;
use messages::Merged;
use motion::MotionSource;
use plan::Plan;
use readings::{Clock, Counts, RawReadings};
use std::sync::Arc;

/// Their name in notes.
const SCANS: &str = "scans";

/// A bag.
#[derive(Debug)]
pub(crate) struct Bag {
    name: String,
    files: Vec<BagFile>,
    plan: Arc<Plan>,
    clock: Clock,
    /// The topics whose messages are merged by their times of recording; none: the order is that of the files.
    merged: Vec<Arc<Topic>>,
}

impl Bag {
    /// Opens a bag, and inspects it: its messages are read twice. `file` is its name in messages.
    pub(crate) fn open(
        file: &str,
        files: Vec<BagFile>,
        choice: &TopicChoice,
        mut notes: Vec<String>,
    ) -> Result<Log, LogError> {
        let unusable = |why| LogError::Unusable { file: file.to_owned(), why };
        // What is missing, because files are cut off.
        let mut missing: Vec<String> = files.iter().filter_map(|file| file.missing.clone()).collect();
        let in_cut_file = |why: String, missing: &[String]| match missing {
            [] => why,
            missing => format!("{why}; {}", missing.join("; ")),
        };
        let inventory = Inventory::of(&files).map_err(|error| match error {
            LogError::Unusable { file, why } => LogError::Unusable { file, why: in_cut_file(why, &missing) },
            other => other,
        })?;
        missing.extend(inventory.notes.iter().cloned());
        let plan = Plan::new(&inventory, choice, &mut notes).map_err(|why| in_cut_file(why, &missing));
        let plan = Arc::new(plan.map_err(unusable)?);
        let merged = messages::merged_topics(&inventory.order, &inventory.topics, |topic| plan.needs(topic));
        let merged = merged.map_err(unusable)?;
        if !merged.is_empty() {
            let note =
                "the messages are sorted by topic: they are read in the order of their times of recording";
            notes.push(note.to_owned());
        }
        let (stamp_ns, log_ns) = inventory.begin_ns.unwrap_or_default();
        let mut bag = Self { name: file.to_owned(), files, plan, clock: Clock::Stamps(stamp_ns), merged };
        let mut inspection = bag.inspected()?;
        if let Some(of) = inspection.without_times() {
            let by_stamps = std::mem::replace(&mut bag.clock, Clock::Recording(log_ns));
            let recorded = bag.inspected()?;
            if recorded.times.has_times && (of == SCANS || recorded.raw.has_pose_times()) {
                notes.push(format!("the stamps of the {of} are unusable: the times of the recording count"));
                inspection = recorded;
            } else {
                bag.clock = by_stamps;
            }
        }
        let has_pose_times = inspection.raw.has_pose_times();
        let Inspection { raw, raw_s, standing, looks, laser_check, times } = inspection;
        let odometry = &raw.assembler.odometry;
        let raw_begin_s = raw_s.first().copied().unwrap_or_default();
        let stands = odometry.stands() && standing.looks_so() && bag.plan.correction.is_none();
        let impossible = raw.impossible();
        notes.extend(odometry.holes.note().into_iter().chain(odometry.restarts_note(raw_begin_s)));
        notes.extend(
            raw.corrections(raw_begin_s).map(|what| format!("the poses are those of another SLAM: {what}")),
        );
        if !has_pose_times {
            let what = "neither the stamps of the odometry nor the times of its recording advance: its motions are not used";
            notes.push(what.to_owned());
        } else if odometry.stands() && !stands && !matches!(bag.plan.motion, MotionSource::Standing) {
            notes.push(standing.note().to_owned());
        }
        let counts = raw.counts;
        if times.times_s.is_empty() {
            let why = match (counts.without_pose, counts.first_invalid) {
                (0, first) => format!("no scan is valid; the first: {}", first.unwrap_or_default()),
                (scans, _) => {
                    format!("at none of the times of {scans} scans there is a pose of another SLAM")
                }
            };
            return Err(unusable(in_cut_file(why, &missing)));
        }
        notes.extend(looks.notes.iter().cloned().chain(times.note.clone()));
        if let (Clock::Stamps(_), Some(duration_s)) = (bag.clock, times.times_s.last()) {
            let recorded_s = inventory.end_ns.saturating_sub(log_ns) as f64 * 1e-9;
            notes.extend(times::other_pace(*duration_s, recorded_s));
        }
        notes.extend(counts.notes());
        if let Some(duration_s) = times.times_s.last().filter(|_| !missing.is_empty()) {
            missing.push(format!("what could be read ends {duration_s:.1} s after the first scan"));
        }
        notes.splice(0..0, missing);
        let since = |ns: i64, begin_s: f64| since_epoch(ns as f64 * 1e-9 + begin_s);
        let (begin_s, by_recording_s) = match bag.clock {
            Clock::Stamps(_) => (since(stamp_ns, times.begin_s), since(log_ns, raw_begin_s)),
            Clock::Recording(_) => (since(log_ns, times.begin_s), None),
        };
        notes.extend(begin_s.and(times.date_note()));
        let begin_s = begin_s.or(by_recording_s).filter(|_| times.has_times);
        let mut scan_topics: Vec<String> = bag.plan.lasers.iter().map(|laser| laser.topic.clone()).collect();
        scan_topics.dedup();
        let summary = LogSummary {
            scans: times.times_s.len(),
            duration_s: times.times_s.last().copied().unwrap_or_default(),
            has_times: times.has_times,
            begin_s,
            odometry_poses: counts.poses,
            stands,
            scan_topics,
            notes,
            impossible: impossible.or_else(|| counts.doubts.impossible(counts.invalid_scans, stands)),
        };
        if stands {
            Arc::make_mut(&mut bag.plan).motion = MotionSource::Standing;
        }
        Ok(Log::new(bag, (times.times_s, looks), laser_check, summary))
    }

    fn raw(&self) -> RawReadings {
        let needed = self.plan.clone();
        let messages = Merged::new(&self.files, move |topic: &Topic| needed.needs(topic), &self.merged);
        RawReadings::new(messages, &self.plan, self.clock)
    }

    /// Reads all scans once.
    fn inspected(&self) -> Result<Inspection, LogError> {
        let (mut raw, mut raw_s, mut standing) = (self.raw(), Vec::new(), Standing::default());
        let (mut looks, mut laser_check) = (Looks::default(), LaserCheck::default());
        while let Some(reading) = raw.next_reading()? {
            let unusable = |why| LogError::Unusable { file: self.name.clone(), why };
            bounds::one_more(raw_s.len()).map_err(unusable)?;
            raw_s.push(reading.time_s);
            standing.add(&reading.mount, &reading.scan);
            looks.add(reading.time_s, &reading.pose, &reading.scan.ranges_m);
            laser_check.add(&reading);
        }
        looks.finish();
        let raw_s = looks.of_looks(raw_s);
        let times = times::repaired(&raw_s);
        Ok(Inspection { raw, raw_s, standing, looks, laser_check, times })
    }
}

impl Source for Bag {
    fn raw_readings(&self) -> Result<Box<dyn log::RawReadings + Send>, LogError> {
        Ok(Box::new(self.raw()))
    }

    fn content_hash(&self) -> Result<u128, LogError> {
        let io = |why| LogError::Io { file: self.name.clone(), why };
        content_hash(self.files.iter().map(|file| file.bytes.open())).map_err(io)
    }
}

/// What a pass over all scans finds.
struct Inspection {
    /// The readings at their end.
    raw: RawReadings,
    /// The times of the scans, s, and how the scans look.
    raw_s: Vec<f64>,
    standing: Standing,
    looks: Looks,
    laser_check: LaserCheck,
    times: Times,
}

impl Inspection {
    /// What has no usable times.
    fn without_times(&self) -> Option<&'static str> {
        match (self.times.has_times, self.raw.has_pose_times()) {
            (false, _) => Some(SCANS),
            (true, false) => Some("odometry"),
            (true, true) => None,
        }
    }
}

impl Counts {
    /// What was left out.
    fn notes(&self) -> impl Iterator<Item = String> {
        let scans = self.first_invalid.as_ref().map(|first| {
            format!("{} scans are invalid and left out, the first: {first}", self.invalid_scans)
        });
        let poses = (self.invalid_poses > 0).then(|| {
            format!("{} poses of odometry or transforms are invalid and left out", self.invalid_poses)
        });
        let unknown = (self.without_pose > 0).then(|| {
            format!(
                "{} scans are left out, since another SLAM gives no pose at their times (or in the 2 s before)",
                self.without_pose
            )
        });
        scans.into_iter().chain(poses).chain(unknown)
    }
}
