//! Whether the odometry of a log moves as its scans do.

use crate::error::SurveyError;
use crate::median::median;
use interfaces::heading_rad;
use localizer::{PoseState, TrajectoryPose};
use nalgebra::Isometry2;

/// Motions are compared when one of both is this long, m, or turns by this much, rad.
const STEP_M: f64 = 0.5;
const STEP_RAD: f64 = 0.5;
/// Two motions differ if they are farther apart than this, m and rad, and than this share of the longer one.
const MIN_APART: f64 = 0.1;
const MIN_SHARE: f64 = 0.5;
/// At least this number of motions is compared; of the logs that we know, at most 0.22 of them differ.
const MIN_STEPS: usize = 20;
const MAX_DIFFERING: f64 = 0.35;

/// Checks the poses of the odometry against those of the trajectory that was found from the scans with its help. An odometry
/// that never moves, or never turns, says nothing of that.
///
/// # Errors
///
/// When many motions differ: scans were put together where they do not belong, or all lengths are wrong.
pub(crate) fn check(found: &[TrajectoryPose], odometry: &[Isometry2<f64>]) -> Result<(), SurveyError> {
    let (mut last, mut differing, mut ratios) = (None, Vec::new(), Vec::new());
    let [mut moved_m, mut turned_rad] = [0.0; 2];
    for (at, pose) in found.iter().zip(odometry) {
        if at.state != PoseState::Tracking {
            last = None;
            continue;
        }
        let (found_before, before) = *last.get_or_insert((at.pose, *pose));
        let motions = [found_before.inv_mul(&at.pose), before.inv_mul(pose)];
        let [found_m, odometry_m] = motions.map(|motion| motion.translation.vector.norm());
        let [found_rad, odometry_rad] = motions.map(|motion| heading_rad(&motion).abs());
        let (longer_m, longer_rad) = (found_m.max(odometry_m), found_rad.max(odometry_rad));
        if longer_m < STEP_M && longer_rad < STEP_RAD {
            continue;
        }
        last = Some((at.pose, *pose));
        let apart_m = (motions[0].translation.vector - motions[1].translation.vector).norm();
        let apart_rad = heading_rad(&motions[0].inv_mul(&motions[1])).abs();
        let differs = |apart: f64, longer: f64| apart > MIN_APART.max(MIN_SHARE * longer);
        differing.push((differs(apart_m, longer_m), differs(apart_rad, longer_rad)));
        (moved_m, turned_rad) = (moved_m + odometry_m, turned_rad + odometry_rad);
        if odometry_m > MIN_APART {
            ratios.push(found_m / odometry_m);
        }
    }
    let steps = differing.len();
    let (moves, turns) = (moved_m > STEP_M, turned_rad > STEP_RAD);
    let differing = differing.iter().filter(|(place, heading)| moves && *place || turns && *heading).count();
    if steps < MIN_STEPS || (differing as f64) < MAX_DIFFERING * steps as f64 {
        return Ok(());
    }
    Err(SurveyError::OtherOdometry { differing, steps, ratio: median(ratios.into_iter()) })
}
