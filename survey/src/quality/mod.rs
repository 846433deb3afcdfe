//! Whether a map is right, as far as it can be known without the truth: a scan that is out of place hits where other scans saw
//! free space, and a trajectory that is broken has a scan that fits to none before it.

mod bridged;
mod evidence;
#[cfg(test)]
mod tests;

use bridged::bridged;
use evidence::{Evidence, Judged, PlacedScan};
use interfaces::{LaserReading, Spread, heading_rad, median};
use localizer::{PoseState, TrajectoryPose};
use nalgebra::{Isometry2, Point2};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A scan counts after this way or turn since the last one that counted, so that resting does not count more than driving.
const COUNTED: Spread = Spread::of_motion(0.3);
/// Hits beyond this range are not compared, m: an error of the heading moves them too far.
const COMPARED_RANGE_M: f64 = 20.0;
/// The number of hits of a scan that are compared.
const COMPARED_HITS: usize = 120;
/// A scan contradicts others if more of its hits are on surfaces where they saw free space.
const CONTRADICTING: f64 = 0.1;
/// A scan is a weak link if fewer of its hits are near those of the scans before it.
const WEAK_LINK: f64 = 0.25;
/// So is a scan that turned from the one before by this much otherwise than by the odometry, rad, if more of its hits than this were seen
/// on one pass only, so that nothing confirms the turn...
const TURNED_RAD: f64 = 0.35;
const UNCONFIRMED: f64 = 0.5;
/// ... and if the odometry holds elsewhere: at most this share of the scans turned otherwise.
const MISSED_TURNS: f64 = 0.02;
/// The number of neighboring scans over which the worst stretch is averaged.
const STRETCH: usize = 10;
/// Fewer scans than this say nothing.
const MIN_SCANS: usize = 30;

/// Limits of a verdict.
struct Limits {
    /// Share of scans that contradict others.
    contradicting: f64,
    /// Share of the hits of the worst stretch that contradict others.
    worst_stretch: f64,
    /// Share of scans without a certain pose.
    left_out: f64,
    weak_links: usize,
    /// Factor between the way of the scans and that of the odometry, in either direction.
    scale: f64,
}

// From corrected and uncorrected trajectories of public logs, and from simulated logs (docs/trajectories.md).
const GOOD: Limits =
    Limits { contradicting: 0.02, worst_stretch: 0.15, left_out: 0.05, weak_links: 0, scale: 1.12 };
const USABLE: Limits =
    Limits { contradicting: 0.05, worst_stretch: 0.25, left_out: 0.2, weak_links: 1, scale: 1.2 };

/// What a map is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Nothing speaks against it.
    Good,
    /// It is probably wrong in places.
    UsableWithCare,
    /// It is wrong.
    NotUsable,
}

impl Verdict {
    /// The verdict in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::UsableWithCare => "usable with care",
            Self::NotUsable => "not usable",
        }
    }
}

/// Why a part of a trajectory is in doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DoubtKind {
    /// Its scans hit where others saw free space.
    Contradicting,
    /// Its first scan fits to none before it, or the odometry contradicts the turn to it and no other pass confirms it.
    WeakLink,
}

/// A part of a trajectory that is in doubt.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Doubt {
    /// Why.
    pub kind: DoubtKind,
    /// The time of its first scan, s.
    pub from_s: f64,
    /// The time of its last scan, s.
    pub to_s: f64,
    /// The position of its first scan, m.
    pub x_m: f64,
    /// The position of its first scan, m.
    pub y_m: f64,
}

/// The figures by which a map is judged.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Quality {
    /// The number of scans that were compared: one per 0.3 m or 0.3 rad.
    pub scans: usize,
    /// The share of scans of which more than a tenth of the hits is on surfaces where other scans saw free space.
    pub contradicting: f64,
    /// The share of such hits in the worst stretch of ten scans.
    pub worst_stretch: f64,
    /// The number of scans that fit to none of the fifteen before, or after a turn that only they show: the trajectory can be broken
    /// there.
    pub weak_links: usize,
    /// The share of readings without a certain pose; without those that see nothing for a short time, if the scans after them agree
    /// with those before.
    pub left_out: f64,
    /// The share of hits on surfaces that were seen on one pass only: nothing confirms them.
    pub seen_once: f64,
    /// The way by the scans per way by the odometry, the median over steps; `None` without an odometry that moves. All lengths are
    /// wrong by this factor, or the odometry is.
    pub scale: Option<f64>,
    /// Where the trajectory is in doubt, in the order of time.
    pub doubts: Vec<Doubt>,
}

impl Quality {
    /// What the map is good for.
    pub fn verdict(&self) -> Verdict {
        let within = |limits: &Limits| self.over(limits).is_empty();
        match (within(&GOOD), within(&USABLE)) {
            (true, _) => Verdict::Good,
            (_, true) => Verdict::UsableWithCare,
            _ => Verdict::NotUsable,
        }
    }

    /// Why the map is not good, in sentences; empty if it is.
    pub fn reasons(&self) -> Vec<String> {
        self.over(&GOOD)
    }

    fn over(&self, limits: &Limits) -> Vec<String> {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let (contradicting, stretch) = (percent(self.contradicting), percent(self.worst_stretch));
        let places = match self.weak_links {
            1 => "one place".to_owned(),
            links => format!("{links} places"),
        };
        let scale = self.scale.unwrap_or(1.0);
        let reasons = [
            (
                self.contradicting > limits.contradicting,
                format!(
                    "{contradicting} of the scans hit where other scans saw free space: walls are there twice"
                ),
            ),
            (
                self.worst_stretch > limits.worst_stretch,
                format!(
                    "in the worst stretch of the route, {stretch} of the hits are where other scans saw free space"
                ),
            ),
            (
                self.weak_links > limits.weak_links,
                format!(
                    "the route can be broken in {places}, where a scan fits to none of those before it or shows a turn that \
                     nothing confirms"
                ),
            ),
            (
                self.left_out > limits.left_out,
                format!("{} of the scans have no certain pose", percent(self.left_out)),
            ),
            (
                scale.max(scale.recip()) > limits.scale,
                format!(
                    "by its scans, the robot moves {scale:.2} times as far as by its odometry: one of both has wrong lengths"
                ),
            ),
        ];
        reasons.into_iter().filter(|(is_over, _)| *is_over).map(|(_, reason)| reason).collect()
    }
}

/// Collects the scans of a log while its trajectory is found.
#[derive(Clone, Debug, Default)]
pub(crate) struct QualityCheck {
    counted: Vec<CountedScan>,
    readings: usize,
    /// The readings without a hit.
    blind: Vec<usize>,
    last: Option<Isometry2<f64>>,
}

/// A scan that counts, in the frame of the robot.
#[derive(Clone, Debug)]
struct CountedScan {
    reading: usize,
    /// The pose by the odometry.
    odometry: Isometry2<f64>,
    laser: Point2<f64>,
    hits: Vec<Point2<f64>>,
}

impl QualityCheck {
    /// Adds the next reading; `pose` is what is known of its pose so far.
    pub(crate) fn add(&mut self, reading: &LaserReading, pose: &Isometry2<f64>) {
        self.blind.extend(reading.hits().next().is_none().then_some(self.readings));
        self.readings += 1;
        if self.last.is_some_and(|last| COUNTED.contains(&last.inv_mul(pose))) {
            return;
        }
        self.last = Some(*pose);
        let hits: Vec<Point2<f64>> =
            reading.hits().filter(|hit| hit.coords.norm() < COMPARED_RANGE_M).collect();
        let every = hits.len().div_ceil(COMPARED_HITS).max(1);
        let hits = hits.into_iter().step_by(every).collect();
        let laser = reading.mount * Point2::origin();
        let (reading, odometry) = (self.readings - 1, reading.pose);
        self.counted.push(CountedScan { reading, odometry, laser, hits });
    }

    /// The figures, along the trajectory that was found, and the readings whose poses are in doubt.
    pub(crate) fn finish(self, poses: &[TrajectoryPose]) -> (Quality, Vec<Range<usize>>) {
        let left_out = poses.iter().filter(|at| at.state != PoseState::Tracking).count();
        let left_out = left_out as f64 / poses.len().max(1) as f64;
        let certain = |scan: &CountedScan| poses[scan.reading].state == PoseState::Tracking;
        let counted: Vec<CountedScan> = self.counted.into_iter().filter(certain).collect();
        if counted.len() < MIN_SCANS {
            return (Quality { scans: counted.len(), left_out, ..Quality::default() }, Vec::new());
        }
        let placed = |scan: &CountedScan| PlacedScan::new(&poses[scan.reading].pose, &scan.laser, &scan.hits);
        let placed: Vec<PlacedScan> = counted.iter().map(placed).collect();
        let judged = Evidence::judge(&placed);
        let numbers: Vec<usize> = counted.iter().map(|scan| scan.reading).collect();
        let at = |scan: usize| poses[counted[scan].reading];
        let share = |of: fn(&Judged) -> bool| {
            judged.iter().filter(|scan| of(scan)).count() as f64 / judged.len() as f64
        };
        let mean = |part: &[Judged]| part.iter().map(|scan| scan.in_free).sum::<f64>() / part.len() as f64;
        let weak = weak_links(&judged, &turned(&counted, poses));
        let (doubts, scans_in_doubt): (Vec<Doubt>, Vec<Range<usize>>) =
            doubts(&judged, &weak, at).into_iter().unzip();
        let quality = Quality {
            scans: judged.len(),
            contradicting: share(|scan| scan.in_free > CONTRADICTING),
            worst_stretch: judged.windows(STRETCH).map(mean).fold(0.0, f64::max),
            weak_links: weak.iter().filter(|is_weak| **is_weak).count(),
            left_out: left_out - bridged(&self.blind, &numbers, &placed, poses),
            seen_once: judged.iter().map(|scan| scan.seen_once).sum::<f64>() / judged.len() as f64,
            scale: scale(&counted, poses),
            doubts,
        };
        // Readings between two scans that are compared are as doubtful as either of them.
        let readings = |scans: Range<usize>| {
            let begin = scans.start.checked_sub(1).map_or(0, |before| counted[before].reading + 1);
            begin..counted.get(scans.end).map_or(poses.len(), |after| after.reading)
        };
        (quality, scans_in_doubt.into_iter().map(readings).collect())
    }
}

/// The median of the way that was found per way by the odometry.
fn scale(counted: &[CountedScan], poses: &[TrajectoryPose]) -> Option<f64> {
    let step = |pair: &[CountedScan]| {
        let found = poses[pair[0].reading].pose.inv_mul(&poses[pair[1].reading].pose);
        let odometry = pair[0].odometry.inv_mul(&pair[1].odometry);
        let odometry_m = odometry.translation.vector.norm();
        (odometry_m > 0.5 * COUNTED.m).then(|| found.translation.vector.norm() / odometry_m)
    };
    let ratios: Vec<f64> = counted.windows(2).filter_map(step).collect();
    median(ratios.iter().copied()).filter(|_| ratios.len() >= MIN_SCANS / 2).filter(|scale| *scale > 0.0)
}

/// How much each scan turned from the one before otherwise than by the odometry, rad, at least: where poses of the odometry are rare, its
/// turn at a scan can be late, or early, and the next step or the step before makes up for it.
fn turned(counted: &[CountedScan], poses: &[TrajectoryPose]) -> Vec<f64> {
    let step = |pair: &[CountedScan]| {
        let found = poses[pair[0].reading].pose.inv_mul(&poses[pair[1].reading].pose);
        heading_rad(&pair[0].odometry.inv_mul(&pair[1].odometry).inv_mul(&found))
    };
    let steps: Vec<f64> = [0.0; 2].into_iter().chain(counted.windows(2).map(step)).chain([0.0]).collect();
    let least = |of: &[f64]| of[1].abs().min((of[0] + of[1]).abs()).min((of[1] + of[2]).abs());
    steps.windows(3).map(least).collect()
}

/// Whether the trajectory can be broken before each scan.
fn weak_links(judged: &[Judged], turned: &[f64]) -> Vec<bool> {
    let missed = turned.iter().filter(|turn| **turn > TURNED_RAD).count();
    let holds = missed as f64 <= MISSED_TURNS * turned.len() as f64;
    let is_weak = |(scan, turn): (&Judged, &f64)| {
        scan.link < WEAK_LINK || holds && *turn > TURNED_RAD && scan.seen_once > UNCONFIRMED
    };
    judged.iter().zip(turned).map(is_weak).collect()
}

/// The stretches of scans in doubt, with the numbers of these scans.
fn doubts(
    judged: &[Judged],
    weak: &[bool],
    at: impl Fn(usize) -> TrajectoryPose,
) -> Vec<(Doubt, Range<usize>)> {
    let mut doubts: Vec<(Doubt, Range<usize>)> = Vec::new();
    let mut last = None;
    for (number, (scan, is_weak)) in judged.iter().zip(weak).enumerate() {
        let kind = match (*is_weak, scan.in_free > CONTRADICTING) {
            (true, _) => DoubtKind::WeakLink,
            (_, true) => DoubtKind::Contradicting,
            _ => continue,
        };
        let TrajectoryPose { time_s, pose, .. } = at(number);
        let goes_on = last.is_some_and(|last| number - last <= STRETCH) && kind == DoubtKind::Contradicting;
        last = Some(number);
        match doubts.last_mut().filter(|_| goes_on) {
            Some((doubt, scans)) => (doubt.to_s, scans.end) = (time_s, number + 1),
            None => {
                let at = pose.translation.vector;
                let doubt = Doubt { kind, from_s: time_s, to_s: time_s, x_m: at.x, y_m: at.y };
                doubts.push((doubt, number..number + 1));
            }
        }
    }
    doubts
}
