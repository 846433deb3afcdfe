//! Submaps: line maps of some consecutive keyframes.

use super::keyframe::Keyframe;
use crate::constants::{JUDGED_M, SUBMAP_REACH_M, SURFEL_M, USABLE_SCANS};
use crate::placement::Placement;
use crate::scan_points::ScanPoint;
use crate::surfel_map::SurfelMap;
use interfaces::GridFrame;
use nalgebra::{Isometry2, Point2, Vector2};

/// A submap to which keyframes are added, in the frame of the matches with local submaps.
#[derive(Clone, Debug)]
pub(super) struct GrowingSubmap {
    pub(super) map: SurfelMap,
    /// The numbers of the keyframes.
    pub(super) keyframes: Vec<usize>,
}

/// A submap with all of its keyframes.
#[derive(Clone, Debug)]
pub(super) struct FinishedSubmap {
    /// The keyframe in whose frame the points are: the middle one.
    pub(super) anchor: usize,
    /// The first and the last keyframe.
    pub(super) first: usize,
    pub(super) last: usize,
    /// The surfaces.
    pub(super) points: Vec<ScanPoint>,
}

impl GrowingSubmap {
    /// An empty submap around a pose.
    pub(super) fn new(around: &Isometry2<f64>) -> Option<Self> {
        let low = Point2::from(around.translation.vector - Vector2::repeat(SUBMAP_REACH_M));
        let frame = GridFrame::covering(low, 2.0 * SUBMAP_REACH_M, 2.0 * SUBMAP_REACH_M, SURFEL_M)?;
        Some(Self { map: SurfelMap::new(&frame), keyframes: Vec::new() })
    }

    pub(super) fn add(&mut self, number: usize, keyframe: &Keyframe, noise_m: f64) {
        self.keyframes.push(number);
        self.map.learn(&keyframe.points, &keyframe.local, noise_m, USABLE_SCANS, false);
    }

    /// The submap with all of its keyframes.
    pub(super) fn finish(self, keyframes: &[Keyframe]) -> FinishedSubmap {
        let anchor = self.keyframes[self.keyframes.len() / 2];
        FinishedSubmap {
            anchor,
            first: self.keyframes[0],
            last: anchor.max(*self.keyframes.last().unwrap_or(&anchor)),
            points: self.map.points(&keyframes[anchor].local),
        }
    }
}

/// How well points at a pose agree with a submap.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Agreement {
    /// The weight of the points on surfaces of the submap.
    pub(super) confirmed: f64,
    /// The weight of the points beside surfaces with the same direction.
    pub(super) beside: f64,
    /// The weight of all points.
    pub(super) all: f64,
    pub(super) confirmed_points: usize,
}

impl Agreement {
    /// The agreement of a scan whose end points fit by this share.
    pub(super) fn of_response(response: f64) -> Self {
        Self { confirmed: response, beside: 1.0 - response, all: 1.0, confirmed_points: 0 }
    }

    /// The share of what is confirmed, of all that the submap can judge.
    pub(super) fn share(&self) -> f64 {
        let judged = self.confirmed + self.beside;
        if judged > 0.0 { self.confirmed / judged } else { 0.0 }
    }

    /// The share of the points that the submap can judge.
    pub(super) fn overlap(&self) -> f64 {
        if self.all > 0.0 { (self.confirmed + self.beside) / self.all } else { 0.0 }
    }
}

/// Compares a scan with a submap: a point within `gate_m` of a surface is confirmed.
pub(super) fn agreement(
    map: &SurfelMap,
    points: &[ScanPoint],
    placement: &Placement,
    gate_m: f64,
) -> Agreement {
    let mut agreement = Agreement::default();
    for point in points {
        let (at, normal) = (placement.place(point), placement.pose.rotation * point.normal);
        agreement.all += point.weight;
        if map.nearest(&at, &normal, gate_m).is_some() {
            agreement.confirmed += point.weight;
            agreement.confirmed_points += 1;
        } else if map.nearest(&at, &normal, JUDGED_M).is_some() {
            agreement.beside += point.weight;
        }
    }
    agreement
}
