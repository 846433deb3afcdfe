//! Bags of ROS 2 (rosbag2): MCAP files and SQLite databases, several of them one after the other.
//!
//! A bag is read three times: for its topics and frames, for the times of its scans, and reading by reading. Each time it
//! is a stream: memory does not grow with the bag.

mod chunk;
mod fields;
mod files;
mod inventory;
mod mcap;
mod message;
mod messages;
mod motion;
mod no_scans;
mod plan;
mod readings;
mod slam;
mod sqlite;
#[cfg(test)]
mod tests;

pub(crate) use files::{BagFile, in_folder};

use crate::bounds;
use crate::choice::TopicChoice;
use crate::content;
use crate::error::LogError;
use crate::log::{Log, Source};
use crate::raw_readings::{self, RawReadings as _};
use crate::standing::Standing;
use crate::summary::{LogSummary, since_epoch};
use crate::times;
use inventory::Inventory;
use message::{Selection, Topic};
use messages::Messages;
use motion::MotionSource;
use nalgebra::Isometry2;
use plan::Plan;
use readings::{Clock, Counts, RawReadings};
use std::sync::Arc;

/// A bag.
#[derive(Debug)]
pub(crate) struct Bag {
    name: String,
    files: Vec<BagFile>,
    plan: Arc<Plan>,
    clock: Clock,
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
        let mut plan = Arc::new(plan.map_err(unusable)?);
        let (stamp_ns, log_ns) = inventory.begin_ns.unwrap_or_default();
        let mut clock = Clock::Stamps(stamp_ns);
        let mut inspection = inspected(&files, &plan, clock, unusable)?;
        let mut times = times::repaired(&inspection.1);
        if !times.has_times {
            let by_recording = inspected(&files, &plan, Clock::Recording(log_ns), unusable)?;
            let recorded = times::repaired(&by_recording.1);
            if recorded.has_times {
                notes.push(
                    "the stamps of the scans are unusable: the times of the recording count".to_owned(),
                );
                (clock, inspection, times) = (Clock::Recording(log_ns), by_recording, recorded);
            }
        }
        let (raw, raw_s, standing) = inspection;
        let raw_begin_s = raw_s.first().copied().unwrap_or_default();
        let is_corrected = plan.correction.is_some();
        let stands = raw.stands() && standing.looks_so() && !is_corrected;
        let odom_origin = if is_corrected { Isometry2::identity() } else { raw.origin() };
        let impossible = raw.impossible();
        notes.extend(raw.odometry_notes(raw_begin_s));
        notes.extend(
            raw.corrections(raw_begin_s).map(|what| format!("the poses are those of another SLAM: {what}")),
        );
        if raw.stands() && !stands && !matches!(plan.motion, MotionSource::Standing) {
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
        notes.extend(times.note.clone());
        if let (Clock::Stamps(_), Some(duration_s)) = (clock, times.times_s.last()) {
            let recorded_s = inventory.end_ns.saturating_sub(log_ns) as f64 * 1e-9;
            notes.extend(times::other_pace(*duration_s, recorded_s));
        }
        notes.extend(counts.notes());
        if let Some(duration_s) = times.times_s.last().filter(|_| !missing.is_empty()) {
            missing.push(format!("what could be read ends {duration_s:.1} s after the first scan"));
        }
        notes.splice(0..0, missing);
        let since = |ns: i64, begin_s: f64| since_epoch(ns as f64 * 1e-9 + begin_s);
        let (begin_s, by_recording_s) = match clock {
            Clock::Stamps(_) => (since(stamp_ns, times.begin_s), since(log_ns, raw_begin_s)),
            Clock::Recording(_) => (since(log_ns, times.begin_s), None),
        };
        notes.extend(begin_s.and(times.date_note()));
        let begin_s = begin_s.or(by_recording_s).filter(|_| times.has_times);
        let mut scan_topics: Vec<String> = plan.lasers.iter().map(|laser| laser.topic.clone()).collect();
        scan_topics.dedup();
        let summary = LogSummary {
            scans: times.times_s.len(),
            duration_s: times.times_s.last().copied().unwrap_or_default(),
            has_times: times.has_times,
            begin_s,
            pose_source: plan.pose_source.clone(),
            odometry_poses: counts.poses,
            stands,
            odom_origin,
            scan_topics,
            notes,
            impossible: impossible.or_else(|| counts.doubts.impossible(counts.invalid_scans, stands)),
        };
        if stands {
            Arc::make_mut(&mut plan).motion = MotionSource::Standing;
        }
        let name = file.to_owned();
        Ok(Log::new(Self { name, files, plan, clock }, times.times_s, summary))
    }
}

impl Source for Bag {
    fn raw_readings(&self) -> Result<Box<dyn raw_readings::RawReadings + Send>, LogError> {
        Ok(Box::new(raw_readings(&self.files, &self.plan, self.clock)))
    }

    fn content_hash(&self) -> Result<u128, LogError> {
        let io = |why| LogError::Io { file: self.name.clone(), why };
        content::hash(self.files.iter().map(BagFile::content)).map_err(io)
    }
}

fn raw_readings(files: &[BagFile], plan: &Arc<Plan>, clock: Clock) -> RawReadings {
    let needed = plan.clone();
    let is_wanted = Arc::new(move |topic: &Topic| needed.needs(topic));
    let messages = Messages::new(files.to_vec(), Selection { is_wanted, checks_sums: false });
    RawReadings::new(messages, plan, clock)
}

/// Reads all scans once: what the readings know at their end, the times of the scans, s, and how the scans look.
fn inspected(
    files: &[BagFile],
    plan: &Arc<Plan>,
    clock: Clock,
    unusable: impl Fn(String) -> LogError,
) -> Result<(RawReadings, Vec<f64>, Standing), LogError> {
    let mut raw = raw_readings(files, plan, clock);
    let (mut raw_s, mut standing) = (Vec::new(), Standing::default());
    while let Some(reading) = raw.next_reading()? {
        bounds::one_more(raw_s.len()).map_err(&unusable)?;
        raw_s.push(reading.time_s);
        standing.add(&reading.mount, &reading.scan);
    }
    Ok((raw, raw_s, standing))
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
