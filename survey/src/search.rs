//! Where the frame of a later log lies in the map of the first one.
//!
//! The trajectory of the log is known, so that one rigid motion places all of its scans. Single scans, spread over the log,
//! are searched for in the whole map, and each proposes motions. Many of these are wrong, as in rooms that look alike, but
//! only the right one is proposed again and again. The most frequent ones are held against scans from everywhere in the
//! log, and the one with which most of them fit is taken.

use crate::error::SurveyError;
use crate::known_place::KnownPlace;
use crate::median::median;
use interfaces::{LaserReading, heading_rad, wrap_rad};
use localizer::{GivenPoses, LineFit, Start, TrajectoryPose};
use mapper::ScanFilter;
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
/// Motions that move a pose of the route to poses nearer than this are the same, m and rad.
const SAME_M: f64 = 0.5;
const SAME_RAD: f64 = 0.1;
/// The uncertainty of a pose by a proposed motion, and by one that scans have corrected, m and rad.
const PROPOSED_STD: (f64, f64) = (0.2, 0.03);
const CORRECTED_STD: (f64, f64) = (0.05, 0.01);

/// The search for the place of a log in the map of the first one.
#[derive(Debug)]
pub struct Search<'a> {
    place: &'a KnownPlace,
    filter: ScanFilter,
    start: Start,
    /// The number of readings that the log has.
    expected: usize,
    readings: usize,
    given: GivenPoses,
    /// The scans that are compared, without their sweep, with their poses on the route of the log.
    compared: Vec<LaserReading>,
}

/// An alignment: the pose of the frame of the route in the map.
struct Alignment {
    motion: Isometry2<f64>,
    /// The number of scans that propose it, or that fit with it.
    scans: usize,
    /// The sum of what the map confirms of these scans, a whole scan being 1.
    confirmed: f64,
}

impl<'a> Search<'a> {
    /// Begins the search for a later log with this number of readings, from the pose of its first reading in the map if that
    /// is known.
    pub fn new(place: &'a KnownPlace, start: Start, readings: usize) -> Self {
        let (given, compared) = (GivenPoses::default(), Vec::new());
        let filter = place.filter.clone();
        Self { place, filter, start, expected: readings, readings: 0, given, compared }
    }

    /// Adds the next reading of the log, with its pose on the route of this log.
    pub fn add(&mut self, reading: LaserReading, found: &TrajectoryPose) {
        let reading = LaserReading { pose: found.pose, ..self.filter.filter(reading) };
        // The motion within a scan follows from the pose before it.
        let mut reading = self.given.deskewed(reading);
        // Else the sweep would be undone again where the scan is matched.
        reading.scan.sweep_s = 0.0;
        if self.readings.is_multiple_of(self.expected.div_ceil(COMPARED).max(1)) {
            self.compared.push(reading);
        }
        self.readings += 1;
    }

    /// The pose of the frame of the route in the map.
    ///
    /// # Errors
    ///
    /// When too few scans fit, or when another pose fits nearly as well.
    pub fn finish(self) -> Result<Isometry2<f64>, SurveyError> {
        let compared = self.compared.len();
        if let Start::At(start) = &self.start {
            // Where the scans fit at once there is nothing to search, even if they do not fix the pose, as in a corridor.
            let fitted = self.corrected(start, CORRECTED_STD);
            if 2 * fitted.scans > compared {
                return Ok(fitted.motion);
            }
        }
        let mut fits: Vec<Alignment> =
            self.proposed().iter().take(MAX_MOTIONS).map(|proposed| self.fitted(&proposed.motion)).collect();
        fits.sort_by(|a, b| b.confirmed.total_cmp(&a.confirmed));
        let certain = fits.first().map_or(0, |best| best.scans);
        let is_enough = |best: &&Alignment| certain > 0 && best.scans as f64 >= MIN_FITTING * compared as f64;
        let Some(best) = fits.first().filter(is_enough) else {
            return Err(SurveyError::OtherPlace { certain, compared });
        };
        let is_other = |other: &&Alignment| {
            self.compared.iter().any(|reading| !is_same(&best.motion, &other.motion, &reading.pose))
        };
        match fits[1..].iter().find(is_other) {
            Some(other) if other.confirmed >= AMBIGUOUS * best.confirmed => {
                Err(SurveyError::AmbiguousPlace { fitting: best.scans, other: other.scans, compared })
            }
            _ => Ok(best.motion),
        }
    }

    /// The different motions that single scans propose, the most frequent first.
    fn proposed(&self) -> Vec<Alignment> {
        let mut lines = self.place.lines.matcher();
        let mut proposed: Vec<Alignment> = Vec::new();
        for reading in self.compared.iter().step_by(self.compared.len().div_ceil(SEARCHED).max(1)) {
            for LineFit { pose, confirmed } in lines.anywhere(reading) {
                let motion = pose * reading.pose.inverse();
                match proposed.iter_mut().find(|known| is_same(&known.motion, &motion, &reading.pose)) {
                    Some(known) => {
                        (known.scans, known.confirmed) = (known.scans + 1, known.confirmed + confirmed)
                    }
                    None => proposed.push(Alignment { motion, scans: 1, confirmed }),
                }
            }
            proposed.sort_by_key(|motion| std::cmp::Reverse(motion.scans));
            let [first, second] = [0, 1].map(|index| proposed.get(index).map_or(0, |motion| motion.scans));
            if first >= ENOUGH && 2 * second < first {
                break;
            }
        }
        proposed
    }

    /// A motion that is corrected by the scans, first from a wide neighborhood.
    fn fitted(&self, motion: &Isometry2<f64>) -> Alignment {
        let first = self.corrected(motion, PROPOSED_STD);
        self.corrected(&first.motion, CORRECTED_STD)
    }

    /// Matches the scans that are compared, from their poses by a motion: the median of the motions that they say.
    fn corrected(&self, motion: &Isometry2<f64>, std: (f64, f64)) -> Alignment {
        let mut lines = self.place.lines.matcher();
        let matched = |reading: &LaserReading| {
            let LineFit { pose, confirmed } = lines.matched(reading, &(motion * reading.pose), std)?;
            Some(([pose, reading.pose], confirmed))
        };
        let (pairs, confirmed): (Vec<[Isometry2<f64>; 2]>, Vec<f64>) =
            self.compared.iter().filter_map(matched).unzip();
        if pairs.is_empty() {
            return Alignment { motion: *motion, scans: 0, confirmed: 0.0 };
        }
        let reference = heading_rad(motion);
        let turns = pairs.iter().map(|[map, own]| wrap_rad(heading_rad(map) - heading_rad(own) - reference));
        let rotation = interfaces::rotation(reference + median(turns));
        let offset =
            |[map, own]: &[Isometry2<f64>; 2]| map.translation.vector - rotation * own.translation.vector;
        let (x, y): (Vec<f64>, Vec<f64>) = pairs.iter().map(offset).map(|at| (at.x, at.y)).unzip();
        let translation = Vector2::new(median(x.into_iter()), median(y.into_iter()));
        let motion = Isometry2::from_parts(translation.into(), rotation);
        Alignment { motion, scans: pairs.len(), confirmed: confirmed.iter().sum() }
    }
}

/// Whether two motions move a pose of the route to about the same pose in the map.
fn is_same(a: &Isometry2<f64>, b: &Isometry2<f64>, pose: &Isometry2<f64>) -> bool {
    let between = (a * pose).inv_mul(&(b * pose));
    between.translation.vector.norm() < SAME_M && heading_rad(&between).abs() < SAME_RAD
}
