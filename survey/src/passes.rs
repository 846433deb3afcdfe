//! The first pass over a log.

use crate::route::{FirstPass, Route, uncertain};
use crate::settings::{SurveyError, SurveySettings};
use interfaces::{GridFrame, LaserReading, PoseMode, heading_rad, median};
use localizer::{GivenPoses, KnownPlace, PoseEstimate, PoseState, RouteSearch, Start, TrajectoryPose};
use logs::{Log, LogError, Readings};
use mapper::{Mapper, NoReturn, NoReturns, ScanFilterSettings};
use nalgebra::{Isometry2, Matrix3, Vector2};
use robot::{Belief, Localization, Session};
use std::iter::Peekable;
use std::ops::ControlFlow;

/// What the first pass does with a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// It finds the trajectory. If the distances of the odometry have a scale, this stage and the next come twice.
    Trajectory,
    /// It closes the loops of the trajectory. Nothing is read.
    Loops,
    /// It makes the map of the first log.
    Map,
    /// It searches for a later log in the map of the first one.
    Search,
}

/// How far later logs may leave the extent of the first one and still be aligned there, m.
const AROUND_M: f64 = 10.0;

/// Motions are compared when one of both is this long, m, or turns by this much, rad.
const STEP_M: f64 = 0.5;
const STEP_RAD: f64 = 0.5;
/// Two motions differ if they are farther apart than this, m and rad, and than this share of the longer one.
const MIN_APART: f64 = 0.1;
const MIN_SHARE: f64 = 0.5;
/// At least this number of motions is compared; of the logs that we know, at most 0.22 of them differ.
const MIN_STEPS: usize = 20;
const MAX_DIFFERING: f64 = 0.35;

/// The first pass over one log.
pub(crate) struct RoutePass<'a, W> {
    pub(crate) log: &'a Log,
    pub(crate) settings: &'a SurveySettings,
    /// What is called when a stage begins and after each of its readings, with their number; a `Break` interrupts the pass.
    pub(crate) watch: W,
}

impl<W: FnMut((Stage, usize)) -> ControlFlow<()>> RoutePass<'_, W> {
    /// The route of the log, in the frame of its first pose.
    ///
    /// # Errors
    ///
    /// When a setting is out of range, when the log cannot be read, when its scans turn against its poses, when most of them
    /// have no certain pose, when they move otherwise than its odometry, when the place is too large for a map, and when the pass
    /// is interrupted.
    pub(crate) fn route(&mut self) -> Result<Route, SurveyError> {
        let mut odometry = Vec::new();
        let settings = self.settings;
        let route = Route::of_passes(settings, |pass| self.trajectory(pass, &mut odometry))?;
        if settings.pose != PoseMode::Localized {
            return Ok(route);
        }
        let (left_out, scans) = (uncertain(&route.trajectory.poses), route.trajectory.poses.len());
        if left_out * 2 > scans {
            return Err(SurveyError::MostLeftOut { left_out, scans });
        }
        check_odometry(&route.trajectory.poses, &odometry)?;
        Ok(route)
    }

    /// The route of one pass over the log. `odometry` gets the poses of the readings.
    fn trajectory(
        &mut self,
        mut pass: FirstPass,
        odometry: &mut Vec<Isometry2<f64>>,
    ) -> Result<Route, SurveyError> {
        odometry.clear();
        self.each_reading(Stage::Trajectory, |_, reading| {
            odometry.push(reading.pose);
            pass.add(reading);
            pass.check()
        })?;
        if self.settings.pose != PoseMode::Localized {
            return Ok(pass.finish());
        }
        self.report(Stage::Loops, 0)?;
        let route = pass.finish();
        self.report(Stage::Loops, route.trajectory.poses.len())?;
        Ok(route)
    }

    /// The route of a later log, in the frame of the first one. `all_stand`: the lasers of this log and of those before stand,
    /// and most lasers that stand are where they were.
    ///
    /// # Errors
    ///
    /// As for [`RoutePass::route`], and when the log finds no place in the map of the first one.
    pub(crate) fn in_place(&mut self, place: &KnownPlace, all_stand: bool) -> Result<Route, SurveyError> {
        let route = self.route()?;
        let start = if all_stand { Start::At(Isometry2::identity()) } else { Start::Unknown };
        let mut search = RouteSearch::new(place, start, route.trajectory.poses.len());
        let mut filter = self.settings.scan_filter();
        self.each_reading(Stage::Search, |index, reading| {
            if let Some(found) = route.trajectory.poses.get(index) {
                search.add(LaserReading { pose: found.pose, ..filter.filter(reading) });
            }
            Ok(())
        })?;
        Ok(route.moved(&search.finish()?))
    }

    /// The place in which later logs find theirs, from the first log along its route.
    ///
    /// # Errors
    ///
    /// As for [`RoutePass::route`], and when the place is too large for a map.
    pub(crate) fn place(&mut self, route: &Route) -> Result<KnownPlace, SurveyError> {
        let mut place = KnownPlace::new(&around(route, self.settings)?);
        let mut filter = self.settings.scan_filter();
        let no_returns = judged(self.log, &route.trajectory.poses, &self.settings.filter)?;
        self.each_reading(Stage::Map, |index, mut reading| {
            if let Some(found) = route.trajectory.poses.get(index) {
                let odometry = std::mem::replace(&mut reading.pose, found.pose);
                no_returns.apply(&mut reading);
                no_returns.protect(&mut reading);
                reading.pose = odometry;
                // A pose that is not certain says nothing.
                if found.state == PoseState::Tracking {
                    place.add(LaserReading { pose: found.pose, ..filter.filter(reading) });
                }
            }
            Ok(())
        })?;
        Ok(place)
    }

    /// Calls `add` with every reading of the log and its index.
    fn each_reading(
        &mut self,
        stage: Stage,
        mut add: impl FnMut(usize, LaserReading) -> Result<(), SurveyError>,
    ) -> Result<(), SurveyError> {
        self.report(stage, 0)?;
        for (index, reading) in self.log.readings()?.enumerate() {
            add(index, reading?)?;
            self.report(stage, index + 1)?;
        }
        Ok(())
    }

    fn report(&mut self, stage: Stage, readings: usize) -> Result<(), SurveyError> {
        match (self.watch)((stage, readings)) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(SurveyError::Interrupted),
        }
    }
}

/// The rectangle of the surfaces in which later logs find their place: more than the extent of the first route.
fn around(first: &Route, settings: &SurveySettings) -> Result<GridFrame, SurveyError> {
    let extent = first.frame(settings)?;
    let around = (AROUND_M / extent.resolution_m()).ceil();
    let origin = extent.origin() - Vector2::repeat(around * extent.resolution_m());
    let [width, height] = [extent.width(), extent.height()].map(|cells| cells + 2 * around as usize);
    // Around a place of the largest size, there is no space left.
    Ok(GridFrame::new(origin, extent.resolution_m(), width, height).unwrap_or(extent))
}

/// Checks the poses of the odometry against those of the trajectory that was found from the scans with its help. An odometry
/// that never moves, or never turns, says nothing of that.
///
/// # Errors
///
/// When many motions differ: scans were put together where they do not belong, or all lengths are wrong.
fn check_odometry(found: &[TrajectoryPose], odometry: &[Isometry2<f64>]) -> Result<(), SurveyError> {
    let (mut last, mut differing) = (None, Vec::new());
    let [mut ratios, mut turn_ratios] = [const { Vec::new() }; 2];
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
        if odometry_rad > MIN_APART {
            turn_ratios.push(found_rad / odometry_rad);
        }
    }
    let steps = differing.len();
    let (moves, turns) = (moved_m > STEP_M, turned_rad > STEP_RAD);
    let differing = differing.iter().filter(|(place, heading)| moves && *place || turns && *heading).count();
    if steps < MIN_STEPS || (differing as f64) < MAX_DIFFERING * steps as f64 {
        return Ok(());
    }
    Err(SurveyError::OtherOdometry {
        differing,
        steps,
        ratio: median(ratios.into_iter()).unwrap_or(1.0),
        turn_ratio: median(turn_ratios.into_iter()).unwrap_or(1.0),
    })
}

// The second pass: a robot reads a log, at the poses that the first pass has found.

/// The readings of a log, with the times of the survey.
pub struct Replay {
    /// The number of the log in the survey.
    pub(crate) number: usize,
    readings: Peekable<Readings>,
    session: Session,
    last: Option<LaserReading>,
}

impl Replay {
    /// The log from its first reading on, `offset_s` later than its own times.
    ///
    /// # Errors
    ///
    /// When the log cannot be read.
    pub(crate) fn new(number: usize, log: &Log, offset_s: f64) -> Result<Self, LogError> {
        let session = Session { offset_s, ..Session::default() };
        Ok(Self { number, readings: log.readings()?.peekable(), session, last: None })
    }

    /// The last reading, as the log has it.
    pub fn last(&self) -> Option<&LaserReading> {
        self.last.as_ref()
    }

    /// The time of the next reading, s; `None` at the end.
    pub(crate) fn next_s(&mut self) -> Option<f64> {
        let next = self.readings.peek()?.as_ref();
        Some(next.map_or(f64::NAN, |reading| reading.time_s + self.session.offset_s))
    }

    /// Whether there is no other reading.
    pub fn is_over(&mut self) -> bool {
        self.readings.peek().is_none()
    }

    /// The next reading.
    pub(crate) fn next(&mut self) -> Result<Option<LaserReading>, LogError> {
        let Some(mut reading) = self.readings.next().transpose()? else { return Ok(None) };
        self.session.shift(&mut reading);
        self.last = Some(reading.clone());
        Ok(Some(reading))
    }
}

/// Gives every reading the pose that the first pass has found for it.
#[derive(Debug)]
pub struct FoundPoses {
    poses: std::vec::IntoIter<TrajectoryPose>,
    given: GivenPoses,
}

impl FoundPoses {
    /// The poses of the readings, in their order.
    pub fn new(poses: Vec<TrajectoryPose>) -> Self {
        Self { poses: poses.into_iter(), given: GivenPoses::default() }
    }

    /// Gives a reading its pose, without a map.
    pub(crate) fn posed(&mut self, mut reading: LaserReading) -> (LaserReading, PoseState) {
        let state = self.poses.next().map_or_else(Default::default, |found| {
            reading.pose = found.pose;
            found.state
        });
        (self.given.deskewed(reading), state)
    }
}

impl Localization<LaserReading> for FoundPoses {
    /// A reading beyond the last pose keeps its own pose and is not certain. The covariance is not estimated: 0.
    fn localize(&mut self, reading: LaserReading, _: &mut Mapper) -> (LaserReading, Belief) {
        let (reading, state) = self.posed(reading);
        let (pose, covariance, support) = (reading.pose, Matrix3::zeros(), 1.0);
        let estimate = Some(PoseEstimate { pose, covariance, support, state });
        (reading, Belief { estimate, ..Belief::exact(pose) })
    }
}

/// Judges the beams without a return of a log along its trajectory, in one more pass over the log.
pub(crate) fn judged(
    log: &Log,
    poses: &[TrajectoryPose],
    settings: &ScanFilterSettings,
) -> Result<NoReturns, LogError> {
    let mut no_returns = NoReturns::new(settings.no_return);
    if settings.no_return == NoReturn::Learn {
        let mut poses = FoundPoses::new(poses.to_vec());
        for reading in log.readings()? {
            let (reading, state) = poses.posed(reading?);
            if state == PoseState::Tracking {
                no_returns.learn(&reading);
            }
        }
    }
    Ok(no_returns)
}
