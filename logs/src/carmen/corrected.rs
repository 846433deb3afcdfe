//! Corrected poses: those of the FLASER lines, where another SLAM has written them.

use super::CarmenLog;
use crate::checks::{MIN_MOTION_M, MIN_MOTION_RAD, NO_MOTION, UNKNOWN_MOTION};
use crate::error::LogError;
use crate::log::Source;
use crate::summary::LogSummary;
use interfaces::heading_rad;
use nalgebra::Isometry2;

/// Poses of FLASER lines that stay within this of the odometry, m and rad, are those of the odometry at slightly other times: a robot
/// drives 0.1 m in the 0.1 s between the two.
const SAME_M: f64 = 0.1;
const SAME_RAD: f64 = 0.05;

/// Checks that the log has corrected poses.
///
/// # Errors
///
/// When its scans have no poses, when all poses are the same though the laser moves, or when they are those of the odometry.
pub(super) fn check(log: &CarmenLog, summary: &LogSummary) -> Result<(), LogError> {
    let why = |what: String| {
        let why = format!(
            "no corrected poses: {what}; without --pose corrected, the poses are found from the scans"
        );
        LogError::Unusable { file: log.file.clone(), why }
    };
    let all = log.reference_poses()?.unwrap_or_default();
    let given: Vec<Isometry2<f64>> = all.iter().flatten().copied().collect();
    let (scans, without) = (all.len(), all.len() - given.len());
    if without > 0 {
        return Err(why(format!(
            "{without} of {scans} scans are ROBOTLASER1 lines, or have an invalid pose; those of FLASER lines would be used"
        )));
    }
    if !summary.stands && (1..scans).all(|at| is_near(&given[0], &given[at], [MIN_MOTION_M, MIN_MOTION_RAD]))
    {
        let at = given[0].translation.vector;
        return Err(why(format!("those of the FLASER lines are all the same ({}, {})", at.x, at.y)));
    }
    if summary.odometry_poses > 0 && !summary.stands && is_odometry(log, &given)? {
        let limit = format!("within {SAME_M} m and {SAME_RAD} rad");
        return Err(why(format!(
            "those of the FLASER lines are those of the odometry ({limit}), which --pose odometry uses"
        )));
    }
    Ok(())
}

/// Whether the poses of the laser move as the odometry does, over the whole log.
fn is_odometry(log: &CarmenLog, given: &[Isometry2<f64>]) -> Result<bool, LogError> {
    let mut readings = log.raw_readings()?;
    let mut first = None;
    for laser in given {
        let Some(reading) = readings.next_reading()? else { break };
        let odometry = reading.pose * reading.mount;
        let (from_odometry, from_laser) = *first.get_or_insert((odometry, *laser));
        let moved = [from_odometry.inv_mul(&odometry), from_laser.inv_mul(laser)];
        if !is_near(&moved[0], &moved[1], [SAME_M, SAME_RAD]) {
            return Ok(false);
        }
    }
    Ok(true)
}

fn is_near(a: &Isometry2<f64>, b: &Isometry2<f64>, [far_m, far_rad]: [f64; 2]) -> bool {
    let step = a.inv_mul(b);
    step.translation.vector.norm() < far_m && heading_rad(&step).abs() < far_rad
}

/// What the log contains, with these poses.
pub(super) fn note(summary: &mut LogSummary) {
    summary.notes.retain(|note| ![NO_MOTION, UNKNOWN_MOTION].contains(&note.as_str()));
    summary
        .notes
        .push("the poses are those of the FLASER lines, which another SLAM has corrected".to_owned());
}
