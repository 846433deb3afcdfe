//! The surfaces along a known route, and where the frame of another route lies among them.
//!
//! The trajectory of the other log is known, so that one rigid motion places all of its scans. Single scans, spread over the
//! log, are searched for in the whole map, and each proposes motions. Many of these are wrong, as in rooms that look alike,
//! but only the right one is proposed again and again. The most frequent ones are held against scans from everywhere in the
//! log, and the one with which most of them fit is taken.

use super::submap::filled;
use super::submap::fit;
use crate::constants::{
    EXAMINED, KEYFRAME, LOG_NOISE_M, MAX_WORK, MIN_AGREEMENT, MIN_OVERLAP, PLACE_STD, USABLE_SCANS,
};
use crate::deskew::GivenPoses;
use crate::estimate::Start;
use crate::scan_points::{PointRules, ScanPoint, ScanPoints};
use crate::score_grid::ScoreGrid;
use crate::search::{Window, search};
use crate::surfel_map::SurfelMap;
use interfaces::{GridFrame, LaserReading, Spread, ValueError, heading_rad, median, wrap_rad};
use nalgebra::{Isometry2, Vector2};

/// The number of scans that are searched for in the whole map, at most.
const SEARCHED: usize = 60;
/// A motion that this many scans propose is enough, if no other one is proposed half as often.
const ENOUGH: usize = 8;
/// The number of scans that are compared.
const COMPARED: usize = 240;
/// At least this share of them must fit.
const MIN_FITTING: f64 = 0.3;
/// The place is ambiguous if the map confirms as much with another motion, up to this share. In a room that is empty but for a
/// door, the motion that turns it around has 0.9.
const AMBIGUOUS: f64 = 0.97;
/// The number of different motions that are held against the scans.
const MAX_MOTIONS: usize = 6;
/// Motions that move a pose of the route to poses nearer than this are the same.
const SAME: Spread = Spread { m: 0.5, rad: 0.1 };
/// The uncertainty of a pose by a proposed motion, and by one that scans have corrected.
const PROPOSED_STD: Spread = Spread { m: 0.2, rad: 0.03 };
const CORRECTED_STD: Spread = Spread { m: 0.05, rad: 0.01 };

/// Why a log has no place among known surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlaceError {
    /// The place of the log is another one.
    #[error(
        "the place is not recognized in the map of the first log: {certain} of {compared} scans fit there"
    )]
    Other {
        /// The number of scans that fit at the pose with the most.
        certain: usize,
        /// The number of scans that were compared.
        compared: usize,
    },
    /// The log fits at several poses.
    #[error(
        "the place in the map of the first log is ambiguous: of {compared} scans, {fitting} fit at one pose, and {other} at \
         another"
    )]
    Ambiguous {
        /// The number of scans that fit at the best pose.
        fitting: usize,
        /// The number of scans that fit at another pose.
        other: usize,
        /// The number of scans that were compared.
        compared: usize,
    },
}

/// The surfaces of a place as short straight lines, from the readings of a log along its trajectory. Unlike a grid, it is
/// exact to some millimeters.
#[derive(Clone, Debug)]
pub struct KnownPlace {
    map: SurfelMap,
    given: GivenPoses,
    points: ScanPoints,
    /// The pose of the last reading that was learned.
    last: Option<Isometry2<f64>>,
}

impl KnownPlace {
    /// A place without surfaces, in the rectangle of `frame`.
    pub fn new(frame: &GridFrame) -> Self {
        Self::of_map(SurfelMap::new(frame))
    }

    /// Adds the next reading of the log, whose pose is that on the trajectory, if the robot has moved by a keyframe since the
    /// last one that was added.
    pub fn add(&mut self, reading: LaserReading) {
        if reading.scan.check().is_err() {
            return;
        }
        let reading = self.given.deskewed(reading);
        let pose = reading.pose;
        if self.last.is_some_and(|last| KEYFRAME.contains(&last.inv_mul(&pose))) {
            return;
        }
        self.last = Some(pose);
        let points = self.points.of(&reading, |_| 1.0, &rules());
        self.map.learn(&filled(&points), &pose, rules().noise_m, USABLE_SCANS, false);
    }

    /// The surfaces, as bytes: what readings of other logs are matched with.
    pub fn snapshot(mut self) -> Vec<u8> {
        self.map.saved()
    }

    /// The place from its snapshot, or from the [surfaces of a localizer](crate::Localizer::surfaces). No more readings can be added.
    ///
    /// # Errors
    ///
    /// When the bytes are no surfaces.
    pub fn restored(surfaces: &[u8]) -> Result<Self, ValueError> {
        SurfelMap::restored(surfaces).map(Self::of_map)
    }

    fn of_map(map: SurfelMap) -> Self {
        Self { map, given: GivenPoses::default(), points: ScanPoints::default(), last: None }
    }
}

fn rules() -> PointRules {
    PointRules { noise_m: LOG_NOISE_M, grazing: false }
}

/// The search for the place of a log among known surfaces.
#[derive(Debug)]
pub struct RouteSearch<'a> {
    map: &'a SurfelMap,
    start: Start,
    /// The number of readings that the log has.
    expected: usize,
    readings: usize,
    given: GivenPoses,
    points: ScanPoints,
    /// The scans that are compared, with their poses on the route of the log.
    compared: Vec<(Isometry2<f64>, Vec<ScanPoint>)>,
}

/// The pose of the frame of the route among the surfaces.
struct Alignment {
    motion: Isometry2<f64>,
    /// The number of scans that fit with it.
    scans: usize,
    /// The sum of what the map confirms of these scans, a whole scan being 1.
    confirmed: f64,
}

impl<'a> RouteSearch<'a> {
    /// Begins the search for a log with this number of readings, from the pose of its first reading if that is known.
    pub fn new(place: &'a KnownPlace, start: Start, readings: usize) -> Self {
        let (given, points, compared) = (GivenPoses::default(), ScanPoints::default(), Vec::new());
        Self { map: &place.map, start, expected: readings, readings: 0, given, points, compared }
    }

    /// Adds the next reading of the log, whose pose is that on its route.
    pub fn add(&mut self, reading: LaserReading) {
        // The motion within a scan follows from the pose before it.
        let reading = self.given.deskewed(reading);
        if self.readings.is_multiple_of(self.expected.div_ceil(COMPARED).max(1)) {
            let points = match reading.scan.check() {
                Ok(()) => self.points.of(&reading, |_| 1.0, &rules()),
                Err(_) => Vec::new(),
            };
            self.compared.push((reading.pose, points));
        }
        self.readings += 1;
    }

    /// The pose of the frame of the route among the surfaces.
    ///
    /// # Errors
    ///
    /// When too few scans fit, or when another pose fits nearly as well.
    pub fn finish(self) -> Result<Isometry2<f64>, PlaceError> {
        let compared = self.compared.len();
        if let Start::At(start) = &self.start {
            // Where the scans fit at once there is nothing to search, even if they do not fix the pose, as in a corridor.
            let fitted = self.corrected(start, CORRECTED_STD);
            if 2 * fitted.scans > compared {
                return Ok(fitted.motion);
            }
        }
        // First from a wide neighborhood.
        let fitted = |(motion, _): &(Isometry2<f64>, usize)| {
            self.corrected(&self.corrected(motion, PROPOSED_STD).motion, CORRECTED_STD)
        };
        let mut fits: Vec<Alignment> = self.proposed().iter().take(MAX_MOTIONS).map(fitted).collect();
        fits.sort_by(|a, b| b.confirmed.total_cmp(&a.confirmed));
        let certain = fits.first().map_or(0, |best| best.scans);
        if certain == 0 || (certain as f64) < MIN_FITTING * compared as f64 {
            return Err(PlaceError::Other { certain, compared });
        }
        let best = &fits[0];
        let is_other = |other: &&Alignment| {
            self.compared.iter().any(|(pose, _)| !is_same(&best.motion, &other.motion, pose))
        };
        match fits[1..].iter().find(is_other) {
            Some(other) if other.confirmed >= AMBIGUOUS * best.confirmed => {
                Err(PlaceError::Ambiguous { fitting: certain, other: other.scans, compared })
            }
            _ => Ok(best.motion),
        }
    }

    /// The different motions that single scans propose, with their number, the most frequent first.
    fn proposed(&self) -> Vec<(Isometry2<f64>, usize)> {
        let grid = ScoreGrid::anywhere(self.map);
        let window = Window::of(&grid.frame);
        let mut proposed: Vec<(Isometry2<f64>, usize)> = Vec::new();
        for (own, points) in self.compared.iter().step_by(self.compared.len().div_ceil(SEARCHED).max(1)) {
            for candidate in search(&mut { MAX_WORK }, &grid, points, &window, (MIN_OVERLAP, EXAMINED)) {
                let Some((pose, _)) = self.fit(points, &candidate, PLACE_STD) else { continue };
                let motion = pose * own.inverse();
                match proposed.iter_mut().find(|(known, _)| is_same(known, &motion, own)) {
                    Some((_, scans)) => *scans += 1,
                    None => proposed.push((motion, 1)),
                }
            }
            proposed.sort_by_key(|(_, scans)| std::cmp::Reverse(*scans));
            let [first, second] = [0, 1].map(|index| proposed.get(index).map_or(0, |(_, scans)| *scans));
            if first >= ENOUGH && 2 * second < first {
                break;
            }
        }
        proposed
    }

    /// Matches the scans that are compared, from their poses by a motion: the median of the motions that they say.
    fn corrected(&self, motion: &Isometry2<f64>, std: Spread) -> Alignment {
        let matched = |(own, points): &(Isometry2<f64>, Vec<ScanPoint>)| {
            let (pose, confirmed) = self.fit(points, &(motion * own), std)?;
            Some(([pose, *own], confirmed))
        };
        let (pairs, confirmed): (Vec<[Isometry2<f64>; 2]>, Vec<f64>) =
            self.compared.iter().filter_map(matched).unzip();
        if pairs.is_empty() {
            return Alignment { motion: *motion, scans: 0, confirmed: 0.0 };
        }
        let reference = heading_rad(motion);
        let turns = pairs.iter().map(|[map, own]| wrap_rad(heading_rad(map) - heading_rad(own) - reference));
        let rotation = interfaces::rotation(reference + median(turns).unwrap_or_default());
        let offset =
            |[map, own]: &[Isometry2<f64>; 2]| map.translation.vector - rotation * own.translation.vector;
        let offsets: Vec<Vector2<f64>> = pairs.iter().map(offset).collect();
        let [x, y] = [0, 1].map(|axis| median(offsets.iter().map(|at| at[axis])).unwrap_or_default());
        let motion = Isometry2::from_parts(Vector2::new(x, y).into(), rotation);
        Alignment { motion, scans: pairs.len(), confirmed: confirmed.iter().sum() }
    }

    /// The pose near another one at which a scan agrees with the surfaces, and the share of the scan that lies on them.
    fn fit(&self, points: &[ScanPoint], near: &Isometry2<f64>, std: Spread) -> Option<(Isometry2<f64>, f64)> {
        let (found, agreement) = fit(self.map, points, near, std, rules().noise_m)?;
        let agrees = agreement.overlap() >= MIN_OVERLAP && agreement.share() >= MIN_AGREEMENT;
        agrees.then_some((found.placement.pose, agreement.confirmed / agreement.all))
    }
}

/// Whether two motions move a pose of the route to about the same pose among the surfaces.
fn is_same(a: &Isometry2<f64>, b: &Isometry2<f64>, pose: &Isometry2<f64>) -> bool {
    SAME.contains(&(a * pose).inv_mul(&(b * pose)))
}
