//! Scans that two logs have in common: a log that contains another one would count twice.

use interfaces::{LaserReading, median};
use localizer::TrajectoryPose;
use logs::{Log, LogError};
use std::collections::BTreeSet;
use xxhash_rust::xxh3::xxh3_64;

/// The number of hashes that are kept of a log, the smallest: of logs with the same scans they are the same (a bottom-k
/// sketch, Broder 1997).
const KEPT: usize = 64;
/// With fewer hashes in common, or a smaller share of those that are comparable, nothing is said.
const MIN_COMMON: usize = 6;
const MIN_SHARE: f64 = 0.2;

/// The hashes of scans of a log that are kept. A scan counts with the time since the one before, so that a place where nothing
/// moves does not look like another log.
///
/// # Errors
///
/// When the log can no longer be opened.
pub(crate) fn sketch(log: &Log) -> Result<Vec<u64>, LogError> {
    let (mut kept, mut before_s) = (BTreeSet::new(), None);
    // What is damaged is reported by the passes.
    for LaserReading { time_s, scan, .. } in log.readings()?.map_while(Result::ok) {
        if let Some(before_s) = before_s.replace(time_s) {
            let step_us = ((time_s - before_s) * 1e6).round() as i64;
            let ranges = scan.ranges_m.iter().flat_map(|range_m| range_m.to_le_bytes());
            kept.insert(xxh3_64(&ranges.chain(step_us.to_le_bytes()).collect::<Vec<u8>>()));
            if kept.len() > KEPT {
                kept.pop_last();
            }
        }
    }
    Ok(kept.into_iter().collect())
}

/// Whether a part of the scans of one log are scans of the other one.
pub(crate) fn repeats(one: &[u64], other: &[u64]) -> bool {
    let bound =
        |kept: &[u64]| if kept.len() < KEPT { u64::MAX } else { kept.last().copied().unwrap_or_default() };
    let bound = bound(one).min(bound(other));
    let comparable = |kept: &[u64]| kept.iter().filter(|hash| **hash <= bound).count();
    let common = one.iter().filter(|hash| **hash <= bound && other.binary_search(hash).is_ok()).count();
    common >= MIN_COMMON && common as f64 >= MIN_SHARE * comparable(one).min(comparable(other)) as f64
}

// When the laser of a log was silent: nothing was in view then.

/// The longest time between two scans of a log during which things are in view, s; see [`robot::max_step_s`].
pub(crate) fn max_step_s(poses: &[TrajectoryPose], hiding_s: f64) -> f64 {
    robot::max_step_s(hiding_s, median(steps_s(poses)).unwrap_or_default())
}

/// What users should know about the times without a scan, in a sentence.
pub(crate) fn silence_note(poses: &[TrajectoryPose], hiding_s: f64) -> Option<String> {
    let max_s = max_step_s(poses, hiding_s);
    let silent_s: Vec<f64> = steps_s(poses).filter(|step_s| *step_s > max_s).collect();
    let (total_s, count) = (silent_s.iter().sum::<f64>(), silent_s.len());
    (count > 0).then(|| {
        let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
        format!(
            "the laser was silent {times} for more than {max_s:.0} s, {total_s:.0} s in all: this time counts as not observed"
        )
    })
}

fn steps_s(poses: &[TrajectoryPose]) -> impl Iterator<Item = f64> {
    poses.windows(2).map(|pair| pair[1].time_s - pair[0].time_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(scans: impl Iterator<Item = u32>) -> Vec<u64> {
        let hashes: BTreeSet<u64> = scans.map(|scan| xxh3_64(&scan.to_le_bytes())).collect();
        hashes.into_iter().take(KEPT).collect()
    }

    #[test]
    fn a_log_is_known_by_its_parts_and_another_one_is_not() {
        for count in [20, 100, 1000, 20_000] {
            let whole = kept(0..count);
            for part in
                [kept(0..count / 2), kept(count / 2..count), kept(count / 3..2 * count / 3), kept(0..count)]
            {
                assert!(repeats(&whole, &part) && repeats(&part, &whole), "{count}");
            }
            assert!(!repeats(&whole, &kept(count..2 * count)) && !repeats(&whole, &[]));
        }
    }
}

#[cfg(test)]
mod silence_tests {
    use super::*;
    use localizer::PoseState;
    use nalgebra::Isometry2;

    fn poses(times_s: &[f64]) -> Vec<TrajectoryPose> {
        let (pose, state) = (Isometry2::identity(), PoseState::Tracking);
        times_s.iter().map(|time_s| TrajectoryPose { time_s: *time_s, pose, state }).collect()
    }

    #[test]
    fn silence_is_much_longer_than_the_usual_step() {
        let dense: Vec<f64> = (0..100).map(|scan| 0.1 * f64::from(scan)).chain([17.8, 46_800.0]).collect();
        assert_eq!(max_step_s(&poses(&dense), 8.0), 8.0);
        let expected =
            "the laser was silent once for more than 8 s, 46782 s in all: this time counts as not observed";
        assert_eq!(silence_note(&poses(&dense), 8.0).as_deref(), Some(expected));
        let rare: Vec<f64> =
            (0..100).map(|scan| 5.0 * f64::from(scan)).chain([540.0, 595.0, 650.0]).collect();
        assert_eq!(max_step_s(&poses(&rare), 8.0), 50.0);
        let expected =
            "the laser was silent 2 times for more than 50 s, 110 s in all: this time counts as not observed";
        assert_eq!(silence_note(&poses(&rare), 8.0).as_deref(), Some(expected));
        for few in [&[][..], &[3.0], &rare[..100]] {
            assert_eq!((max_step_s(&poses(few), 8.0) >= 8.0, silence_note(&poses(few), 8.0)), (true, None));
        }
    }
}
