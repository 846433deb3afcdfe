//! What a beam without a return means. Glass, mirrors and black surfaces swallow beams: a scanner whose beams without a
//! return often pass through surfaces that its other beams hit does not say that the space is free.

use interfaces::{LaserReading, Scan, Values, value};
use nalgebra::{Point2, UnitComplex, Vector2};
use std::collections::BTreeMap;

/// The side of a cell in which hits are counted, m.
const CELL_M: f64 = 0.2;
/// A beam meets a surface if it comes this near to the mean of the hits in a cell, m.
const NEAR_M: f64 = 0.1;
/// The number of scans that must hit a cell before beams are judged by it.
const CONFIDENT: u32 = 5;
/// The largest number of hits whose mean is the place of a surface.
const MEMORY: u32 = 32;
/// Surfaces beyond this share of the maximum range judge nothing: beams along a wall leave the range beside it.
const JUDGED_SHARE: f64 = 0.9;
/// Surfaces farther away judge nothing, m: the work per beam is bounded.
const FARTHEST_M: f64 = 30.0;
/// The largest number of cells with hits; about 100 bytes each.
const MAX_SURFACES: usize = 1 << 20;
/// One of this many beams is judged.
const STRIDE: usize = 4;
/// A scan that turns by more than this while it is measured is not judged, rad.
const MAX_TURN_RAD: f64 = 0.02;
/// The fixed prior: beams without a return at surfaces that were hit, and beams with one.
const PRIOR: [f64; 2] = [10.0, 40.0];
/// The largest probability that a surface gives no return, for a scanner that is trusted.
const MAX_SWALLOWED: f64 = 0.06;
/// The largest of these probabilities for a scanner whose beams may clear a surface that others hit.
const MAX_CLEAN: f64 = 0.003;
/// A scanner is not trusted before it was seen for this time, s: a robot must drive past glass to notice it.
const LEARNS_S: f64 = 30.0;
/// A surface that is hit again after at most this time was there in between, s.
const GAP_S: f64 = 60.0;
/// A laser that has moved by at most this since the last hit has the same view, m.
const SAME_VIEW_M: f64 = 0.3;
/// The largest number of beams without a return in the same view, per hit: more, and something comes and goes.
const MAX_SILENT: f64 = 0.5;
/// More scanners than these are not told apart.
const MAX_SCANNERS: usize = 4;
/// A longer time between two scans counts as this, s.
const MAX_STEP_S: f64 = 1.0;

/// What beams without a return mean for the map.
#[derive(Clone, Copy, Default)]
pub enum NoReturn {
    /// Free to the maximum range, if the scanner has proven trustworthy.
    #[default]
    Learn,
    /// Always free to the maximum range.
    Free,
    /// Nothing.
    Ignore,
}

interfaces::chosen_by_name!(NoReturn, "meaning of a beam without a return", NoReturn::all());

impl NoReturn {
    /// All meanings.
    pub fn all() -> Vec<Self> {
        vec![Self::Learn, Self::Free, Self::Ignore]
    }

    /// The name on the command line and in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Learn => "learn",
            Self::Free => "free",
            Self::Ignore => "ignore",
        }
    }
}

/// The hits in a cell.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct Surface {
    mean: Point2<f64>,
    /// The number of scans that hit the cell, and the time of the last of them, s.
    scans: u32,
    last_s: f64,
    /// Where the laser was in that scan.
    seen_from: Point2<f64>,
    /// The beams that hit, and those without a return that passed where the laser had the same view.
    hits: u32,
    silent: u32,
    /// For each scanner the beams without a return that have passed since the last hit.
    passed: [u32; MAX_SCANNERS],
}

impl Surface {
    /// Whether a beam meets the surface.
    fn is_on(&self, origin: &Point2<f64>, along: &Vector2<f64>) -> bool {
        (self.mean - origin).perp(along).abs() <= NEAR_M
    }

    /// Whether a surface stands here, and nobody who comes and goes: hit often, and seldom silent in the same view.
    fn stands(&self) -> bool {
        self.scans >= CONFIDENT && self.stays()
    }

    /// Whether the surface is seldom silent in the same view.
    fn stays(&self) -> bool {
        f64::from(self.silent) <= MAX_SILENT * f64::from(self.hits)
    }
}

/// The evidence about the beams of one scanner.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct NoReturnEvidence {
    /// Beams without a return that passed through a surface that was hit before and after.
    pub passing: u64,
    /// Beams with a return that ended at such a surface.
    pub ending: u64,
    /// All beams without a return that were looked at.
    pub silent: u64,
    /// The time for which it was seen, s.
    pub learned_s: f64,
}

/// The scanners of a robot, and how far their beams without a return are trusted.
#[derive(Clone, Debug, Default)]
pub struct NoReturns {
    meaning: NoReturn,
    surfaces: BTreeMap<[i32; 2], Surface>,
    /// The scanners by their mount and beams.
    scanners: Vec<([u64; 5], NoReturnEvidence)>,
    /// The time of the last scan, s.
    last_s: f64,
}

impl NoReturnEvidence {
    /// The probability that a surface gives no return: the mean of the Beta posterior.
    pub fn swallowed(&self) -> f64 {
        let [passing, ending] = [PRIOR[0] + self.passing as f64, PRIOR[1] + self.ending as f64];
        passing / (passing + ending)
    }

    /// Whether beams without a return of this scanner mean free space.
    pub fn is_trusted(&self) -> bool {
        self.distrust().is_none()
    }

    /// Why beams without a return of this scanner do not mean free space; `None` if they do.
    pub fn distrust(&self) -> Option<NoReturnDistrust> {
        if self.learned_s < LEARNS_S {
            return Some(NoReturnDistrust::SeenShortly);
        }
        let judged = (self.passing + self.ending) as f64;
        let is_by_prior = judged == 0.0 || (self.passing as f64) < MAX_SWALLOWED * judged;
        let distrust = if is_by_prior { NoReturnDistrust::SeldomJudged } else { NoReturnDistrust::Swallows };
        (self.swallowed() >= MAX_SWALLOWED).then_some(distrust)
    }
}

/// Why beams without a return of a scanner are not trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoReturnDistrust {
    /// The scanner was seen for less than half a minute.
    SeenShortly,
    /// Too few of its beams met surfaces that had been hit before.
    SeldomJudged,
    /// Surfaces often give no return.
    Swallows,
}

impl NoReturns {
    /// Nothing is known about any scanner.
    pub fn new(meaning: NoReturn) -> Self {
        Self { meaning, ..Self::default() }
    }

    /// The evidence about each scanner.
    pub fn evidence(&self) -> impl Iterator<Item = NoReturnEvidence> {
        self.scanners.iter().map(|(_, evidence)| *evidence)
    }

    /// What was learned: what a state file holds.
    pub(crate) fn values(&mut self) -> Values<'_> {
        vec![value(&mut self.surfaces), value(&mut self.scanners), value(&mut self.last_s)]
    }

    /// Learns from a reading whose pose is certain.
    pub fn learn(&mut self, reading: &LaserReading) {
        let scan = &reading.scan;
        let turn_rad = scan.sweep_s * reading.twist.angular_radps.abs();
        if self.meaning != NoReturn::Learn || scan.check().is_err() || turn_rad > MAX_TURN_RAD {
            return;
        }
        let scanner = self.scanner(reading);
        if !self.surfaces.is_empty() {
            self.scanners[scanner].1.learned_s += (reading.time_s - self.last_s).clamp(0.0, MAX_STEP_S);
        }
        self.last_s = reading.time_s;
        let (origin, rotation, judged_m) = beams(reading);
        for (beam, &range_m) in scan.ranges_m.iter().enumerate().step_by(STRIDE) {
            let along = along(rotation, scan, beam);
            let range_m = f64::from(range_m);
            let evidence = &mut self.scanners[scanner].1;
            if range_m == f64::INFINITY {
                evidence.silent += 1;
                for at in passed(origin, along, judged_m) {
                    let met = self.surfaces.get_mut(&at).filter(|surface| surface.is_on(&origin, &along));
                    let Some(surface) = met else { continue };
                    let is_same_view = (origin - surface.seen_from).norm() <= SAME_VIEW_M;
                    surface.silent += u32::from(is_same_view);
                    if surface.stands() {
                        surface.passed[scanner] += 1;
                        break;
                    }
                }
            } else if (scan.range_min_m..=judged_m).contains(&range_m) {
                self.hit(scanner, &origin, &(origin + along * range_m), reading.time_s);
            }
        }
    }

    /// Whether beams without a return of the scanner of a reading mean free space.
    pub fn is_trusted(&self, reading: &LaserReading) -> bool {
        match self.meaning {
            NoReturn::Free => true,
            NoReturn::Ignore => false,
            NoReturn::Learn => self.evidence_of(reading).is_some_and(NoReturnEvidence::is_trusted),
        }
    }

    fn evidence_of(&self, reading: &LaserReading) -> Option<&NoReturnEvidence> {
        let known = self.scanners.iter().find(|(scanner, _)| *scanner == key(reading));
        known.map(|(_, evidence)| evidence).filter(|_| self.meaning == NoReturn::Learn)
    }

    /// Turns beams without a return that are not trusted into invalid ones, which say nothing.
    pub fn apply(&self, reading: &mut LaserReading) {
        if !self.is_trusted(reading) {
            let silent = reading.scan.ranges_m.iter_mut().filter(|range_m| **range_m == f32::INFINITY);
            silent.for_each(|range_m| *range_m = f32::NAN);
        }
    }

    /// Turns the beams without a return of a trusted scanner that sometimes swallows beams into invalid ones where they pass
    /// a surface. The pose of the reading is certain.
    pub fn protect(&self, reading: &mut LaserReading) {
        if self.evidence_of(reading).is_none_or(|known| known.swallowed() < MAX_CLEAN) {
            return;
        }
        let (origin, rotation, judged_m) = beams(reading);
        for beam in 0..reading.scan.ranges_m.len() {
            if reading.scan.ranges_m[beam] != f32::INFINITY {
                continue;
            }
            let along = along(rotation, &reading.scan, beam);
            let mut surfaces = passed(origin, along, judged_m).filter_map(|at| self.surfaces.get(&at));
            if surfaces.any(|surface| surface.is_on(&origin, &along) && surface.stays()) {
                reading.scan.ranges_m[beam] = f32::NAN;
            }
        }
    }

    fn hit(&mut self, scanner: usize, origin: &Point2<f64>, end: &Point2<f64>, time_s: f64) {
        let new = Surface {
            mean: *end,
            scans: 0,
            last_s: f64::NEG_INFINITY,
            seen_from: *origin,
            hits: 0,
            silent: 0,
            passed: [0; MAX_SCANNERS],
        };
        let at = cell(end);
        if self.surfaces.len() >= MAX_SURFACES && !self.surfaces.contains_key(&at) {
            return;
        }
        let surface = self.surfaces.entry(at).or_insert(new);
        let is_near = (end - surface.mean).norm() <= NEAR_M;
        if is_near && surface.stands() {
            self.scanners[scanner].1.ending += 1;
        }
        if is_near {
            for ((_, evidence), passed) in self.scanners.iter_mut().zip(&mut surface.passed) {
                let passing = u64::from(std::mem::take(passed));
                evidence.passing += if time_s - surface.last_s <= GAP_S { passing } else { 0 };
            }
        }
        surface.seen_from = *origin;
        surface.hits += 1;
        if surface.last_s != time_s {
            (surface.last_s, surface.scans) = (time_s, surface.scans + 1);
            surface.mean += (end - surface.mean) / f64::from(surface.scans.min(MEMORY));
        }
    }

    fn scanner(&mut self, reading: &LaserReading) -> usize {
        let key = key(reading);
        let known = self.scanners.iter().position(|(scanner, _)| *scanner == key);
        known.unwrap_or_else(|| {
            if self.scanners.len() < MAX_SCANNERS {
                self.scanners.push((key, NoReturnEvidence::default()));
            }
            self.scanners.len() - 1
        })
    }
}

/// The start of all beams, their turn, and how far they are judged, m.
fn beams(reading: &LaserReading) -> (Point2<f64>, UnitComplex<f64>, f64) {
    let laser = reading.pose * reading.mount;
    let judged_m = (JUDGED_SHARE * reading.scan.range_max_m).min(FARTHEST_M);
    (Point2::from(laser.translation.vector), laser.rotation, judged_m)
}

fn along(rotation: UnitComplex<f64>, scan: &Scan, beam: usize) -> Vector2<f64> {
    rotation * (interfaces::rotation(scan.angle_rad(beam)) * Vector2::x())
}

/// The place and the first beam of a scanner.
fn key(reading: &LaserReading) -> [u64; 5] {
    let (at, turn) = (&reading.mount.translation, &reading.mount.rotation);
    [at.x, at.y, turn.re, turn.im, reading.scan.angle_min_rad].map(f64::to_bits)
}

/// The cells that a beam passes up to a range.
fn passed(origin: Point2<f64>, along: Vector2<f64>, range_m: f64) -> impl Iterator<Item = [i32; 2]> {
    let mut last = cell(&origin);
    (1..=(range_m / (CELL_M / 2.0)) as u32).filter_map(move |step| {
        let at = cell(&(origin + along * (f64::from(step) * CELL_M / 2.0)));
        (std::mem::replace(&mut last, at) != at).then_some(at)
    })
}

fn cell(at: &Point2<f64>) -> [i32; 2] {
    [at.x, at.y].map(|m| (m / CELL_M).floor() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scanner_is_not_trusted_for_the_reason_that_is_given() {
        let distrust = |learned_s, passing, ending| {
            let evidence = NoReturnEvidence { passing, ending, silent: 1000, learned_s };
            assert_eq!(evidence.is_trusted(), evidence.distrust().is_none());
            evidence.distrust()
        };
        assert_eq!(distrust(29.0, 0, 100_000), Some(NoReturnDistrust::SeenShortly));
        assert_eq!(distrust(60.0, 0, 0), Some(NoReturnDistrust::SeldomJudged));
        assert_eq!(distrust(60.0, 1, 60), Some(NoReturnDistrust::SeldomJudged));
        assert_eq!(distrust(60.0, 50, 400), Some(NoReturnDistrust::Swallows));
        assert_eq!(distrust(60.0, 5, 400), None);
    }
}
