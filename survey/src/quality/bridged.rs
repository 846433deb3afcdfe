//! Readings that see nothing, as outdoors, while the odometry knows the way.

use super::evidence::{Evidence, PlacedScan};
use localizer::{PoseState, TrajectoryPose as At};

/// Without a hit, the odometry bridges the poses for at most this time, s: longer, and nothing is known of the way in between.
const LONGEST_S: f64 = 30.0;
/// The poses are bridged if of this number of scans after it, more than this share of the hits is near hits of the scans before it: after 6
/// to 25 s, at least 0.7, and at most 0.23 where the odometry had slipped.
const RETURNED: usize = 10;
const FITTING: f64 = 0.5 * RETURNED as f64;
/// The most times without a hit for which this is looked for, each in the whole route: further ones count as uncertain.
const MOST: usize = 50;

/// The share of readings without a hit whose poses the odometry bridges for a short time, so that scans after them fit to those before.
/// `blind` are the readings without a hit, and `numbers` those of the scans that are compared, in order.
pub(super) fn bridged(blind: &[usize], numbers: &[usize], scans: &[PlacedScan], poses: &[At]) -> f64 {
    let is_bridged = |run: &&[usize]| {
        let (first, last) = (run[0], run[run.len() - 1]);
        let (before, after) = scans.split_at(numbers.partition_point(|number| *number < first));
        let links = Evidence::links(before, after);
        let mut sums = links.windows(RETURNED).map(|links| links.iter().sum::<f64>());
        poses[last].time_s - poses[first].time_s <= LONGEST_S && sums.any(|sum| sum > FITTING)
    };
    let is_uncertain = |number: &&usize| poses[**number].state == PoseState::Uncertain;
    let blind: Vec<usize> = blind.iter().filter(is_uncertain).copied().collect();
    let runs = blind.chunk_by(|a, b| a + 1 == *b).take(MOST).filter(is_bridged);
    runs.map(<[usize]>::len).sum::<usize>() as f64 / poses.len() as f64
}
