//! Scans that are far from the one before: the pose comes from the end points of many keyframes, by correlation.

use super::correlation::{Correlated, Correlation};
use super::keyframe::Keyframe;
use super::matching::information_of;
use crate::constants::{
    ALL_HEADINGS, CORRELATED, CORRELATED_KEYFRAMES, CORRELATED_M, CORRELATION_STD_M, MIN_RESPONSE,
    RECENT_KEYFRAMES, SUBMAP_STD, SURE_FACTOR, SURE_RESPONSE,
};
use crate::local_trajectory_builder::IncomingScan;
use crate::matcher::{Match, derivative};
use crate::placement::Placement;
use crate::scan_points::ScanPoint;
use interfaces::LaserReading;
use nalgebra::{Isometry2, Matrix3};

/// The pose of a scan that fits best around the predicted one; where none fits, of all headings. `None` before the first
/// keyframe.
pub(super) fn found_among(keyframes: &[Keyframe], scan: &IncomingScan) -> Option<Correlated> {
    keyframes.first()?;
    let (LaserReading { scan: beams, mount, .. }, predicted) = (&scan.reading, &scan.predicted.pose);
    let is_near = |keyframe: &&Keyframe| {
        (keyframe.local.translation.vector - predicted.translation.vector).norm() <= CORRELATED_M
    };
    let best = |count: usize, window| {
        let last = keyframes.iter().rev().take(count).take_while(is_near);
        Correlation::of(last.map(|keyframe| (&keyframe.local, keyframe)), predicted)
            .best(beams, mount, window)
    };
    let near = best(CORRELATED_KEYFRAMES, CORRELATED);
    if near.response >= MIN_RESPONSE {
        return Some(near);
    }
    let other = best(RECENT_KEYFRAMES, ALL_HEADINGS);
    let is_sure = other.response >= SURE_RESPONSE && other.response > SURE_FACTOR * near.response;
    Some(if is_sure { other } else { near })
}

/// The match at a correlated pose. Straight surfaces say how well it is known: a direction that none of them fixes stays free.
pub(super) fn matched_at(pose: &Isometry2<f64>, points: &[ScanPoint]) -> Option<Match> {
    let mut found = Match {
        placement: Placement::rigid(pose),
        scan_information: points.iter().map(|point| information(point, pose)).sum(),
        information: Matrix3::zeros(),
        beam_covariance: Matrix3::zeros(),
        residual_ratio: 1.0,
    };
    found.scan_information = information_of(&found, SUBMAP_STD)?;
    found.information = found.scan_information;
    Some(found)
}

fn information(point: &ScanPoint, pose: &Isometry2<f64>) -> Matrix3<f64> {
    let j = derivative(&(pose.rotation * point.at.coords), &(pose.rotation * point.normal));
    j * j.transpose() * (point.weight / (CORRELATION_STD_M * CORRELATION_STD_M))
}
