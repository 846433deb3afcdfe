//! Readings that see nothing, as outdoors, while the odometry knows the way.

use super::evidence::{Evidence, PlacedScan, SAME_PASS};
use localizer::{PoseState, TrajectoryPose};

/// Without a hit, the odometry bridges the poses for at most this time, s: longer, and nothing is known of the way in between.
const LONGEST_S: f64 = 30.0;
/// The scans after it fit if more than this share of the hits of the first one is near hits of the scans before it, or on average of a
/// number of scans, when the robot has returned: after 6 to 25 s, at least 0.7, and at most 0.23 where the odometry had slipped.
const FITTING: f64 = 0.5;
const RETURNED: usize = 10;
/// It is looked for where the robot returns if more than this share of the readings is without a hit: this bounds the work.
const SEARCHED: f64 = 0.02;

/// The number of readings without a hit whose poses the odometry bridges for a short time, so that scans after them fit to those before.
/// `blind` are the readings without a hit, and `readings` those of the scans that are compared, in order.
pub(super) fn bridged(
    blind: &[usize],
    readings: &[usize],
    placed: &[PlacedScan],
    poses: &[TrajectoryPose],
) -> usize {
    let is_uncertain = |reading: &usize| poses[*reading].state == PoseState::Uncertain;
    let uncertain: Vec<usize> = blind.iter().copied().filter(is_uncertain).collect();
    let is_bridged = |run: &&[usize]| {
        let (first, last) = (run[0], run[run.len() - 1]);
        let (before, after) = placed.split_at(readings.partition_point(|reading| *reading < first));
        let near = &before[before.len().saturating_sub(SAME_PASS)..];
        let fits = |scan: &PlacedScan| Evidence::links(near, std::slice::from_ref(scan))[0] > FITTING;
        let returns = || {
            let links = Evidence::links(before, after);
            links.windows(RETURNED).any(|links| links.iter().sum::<f64>() > FITTING * RETURNED as f64)
        };
        poses[last].time_s - poses[first].time_s <= LONGEST_S
            && (after.first().is_some_and(fits)
                || run.len() as f64 > SEARCHED * poses.len() as f64 && returns())
    };
    uncertain.chunk_by(|a, b| a + 1 == *b).filter(is_bridged).map(<[usize]>::len).sum()
}
