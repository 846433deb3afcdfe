//! The first pass over a log.

use crate::error::SurveyError;
use crate::replay::judged;
use crate::route::{FirstPass, Route, uncertain};
use crate::settings::SurveySettings;
use interfaces::{GridFrame, LaserReading, PoseMode, heading_rad, median};
use localizer::{KnownPlace, PoseState, RouteSearch, Start, TrajectoryPose};
use logs::Log;
use nalgebra::{Isometry2, Vector2};
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
    Err(SurveyError::OtherOdometry {
        differing,
        steps,
        ratio: median(ratios.into_iter()).unwrap_or_default(),
    })
}
