//! Both passes over the logs of one place.

use crate::error::SurveyError;
use crate::known_place::KnownPlace;
use crate::replay::{NoPilot, Replay, judged};
use crate::route::{FirstPass, Route, uncertain};
use crate::search::Search;
use crate::settings::{PoseMode, SurveySettings};
use interfaces::{LaserReading, World};
use localizer::Start;
use logs::{Log, LogError};
use mapper::{Mapper, ReadingError};
use nalgebra::Isometry2;
use robot::{Belief, Localization, explore};
use std::ops::ControlFlow;

/// The error of a pass over logs.
#[derive(Debug, thiserror::Error)]
pub enum PassError {
    /// A log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The mapper refuses a reading.
    #[error(transparent)]
    Reading(#[from] ReadingError),
    /// No map can be made.
    #[error(transparent)]
    Survey(#[from] SurveyError),
    /// A later log finds no place in the map of the first one.
    #[error("log {}: {why}", log + 1)]
    Alignment {
        /// The number of the log, from 0 on.
        log: usize,
        /// The reason.
        why: SurveyError,
    },
    /// The callback has interrupted the pass.
    #[error("the first pass was interrupted")]
    Interrupted,
}

/// What the first pass does with a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// It finds the trajectory.
    Trajectory,
    /// It closes the loops of the trajectory. Nothing is read.
    Loops,
    /// It makes the map of the first log.
    Map,
    /// It searches for a later log in the map of the first one.
    Search,
}

/// How far the first pass has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RouteProgress {
    /// The number of the log, from 0 on.
    pub log: usize,
    /// What is done with the log.
    pub stage: Stage,
    /// The number of readings that this stage has used; 0 when it begins.
    pub readings: usize,
}

/// The first pass over the logs of one place: the route of every log, in the frame of the first one. Trajectories that are
/// found are aligned, and logs of lasers that stand; with other poses every log keeps its own frame.
///
/// `watch` is called when a stage begins and after each of its readings, and interrupts the pass with a `Break`.
///
/// # Errors
///
/// When a setting is out of range, when a log cannot be read or aligned, and when the pass is interrupted.
pub fn routes(
    logs: &[&Log],
    settings: &SurveySettings,
    mut watch: impl FnMut(RouteProgress) -> ControlFlow<()>,
) -> Result<Vec<Route>, PassError> {
    let all_stand = logs.iter().all(|log| log.summary().stands);
    let is_aligned = logs.len() > 1 && (settings.pose == PoseMode::Localized || all_stand);
    let mut place: Option<KnownPlace> = None;
    let mut routes = Vec::new();
    for (number, log) in logs.iter().enumerate() {
        let mut pass = RoutePass { log, number, settings, watch: &mut watch };
        let route = match &place {
            Some(place) => pass.in_place(place, all_stand)?,
            None => pass.route()?,
        };
        if is_aligned && place.is_none() {
            place = Some(pass.place(&route)?);
        }
        routes.push(route);
    }
    Ok(routes)
}

/// The first pass over one log. The `watch` is that of [`routes`], which gets `number` as the number of the log.
#[derive(Debug)]
pub struct RoutePass<'a, W> {
    /// The log.
    pub log: &'a Log,
    /// The number of the log, from 0 on.
    pub number: usize,
    /// The settings of the survey.
    pub settings: &'a SurveySettings,
    /// What is called when a stage begins and after each of its readings.
    pub watch: W,
}

impl<W: FnMut(RouteProgress) -> ControlFlow<()>> RoutePass<'_, W> {
    /// The route of the log, in the frame of its first pose.
    ///
    /// # Errors
    ///
    /// When a setting is out of range, when the log cannot be read, when its scans turn against its poses, when most of them
    /// have no certain pose, when the place is too large for a map, and when the pass is interrupted.
    pub fn route(&mut self) -> Result<Route, PassError> {
        let mut pass = FirstPass::new(self.settings)?;
        self.each_reading(Stage::Trajectory, |_, reading| {
            pass.add(reading);
            pass.check()
        })?;
        if self.settings.pose != PoseMode::Localized {
            return Ok(pass.finish());
        }
        self.report(Stage::Loops, 0)?;
        let route = pass.finish();
        self.report(Stage::Loops, route.poses.len())?;
        let (left_out, scans) = (uncertain(&route.poses), route.poses.len());
        if left_out * 2 > scans {
            return Err(SurveyError::MostLeftOut { left_out, scans }.into());
        }
        Ok(route)
    }

    /// The route of a later log, in the frame of the first one. `all_stand`: the lasers of this log and of those before stand,
    /// and most lasers that stand are where they were.
    ///
    /// # Errors
    ///
    /// As for [`RoutePass::route`], and when the log finds no place in the map of the first one.
    pub fn in_place(&mut self, place: &KnownPlace, all_stand: bool) -> Result<Route, PassError> {
        let route = self.route()?;
        let start = if all_stand { Start::At(Isometry2::identity()) } else { Start::Unknown };
        let mut search = Search::new(place, start, route.poses.len());
        self.each_reading(Stage::Search, |index, reading| {
            if let Some(found) = route.poses.get(index) {
                search.add(reading, found);
            }
            Ok(())
        })?;
        let log = self.number;
        Ok(route.moved(&search.finish().map_err(|why| PassError::Alignment { log, why })?))
    }

    /// The place in which later logs find theirs, from the first log along its route.
    ///
    /// # Errors
    ///
    /// As for [`RoutePass::route`], and when the place is too large for a map.
    pub fn place(&mut self, route: &Route) -> Result<KnownPlace, PassError> {
        let mut place = KnownPlace::new(self.settings, route)?;
        let no_returns = judged(self.log, &route.poses, self.settings)?;
        self.each_reading(Stage::Map, |index, mut reading| {
            if let Some(found) = route.poses.get(index) {
                no_returns.apply(&mut reading, &found.pose);
                place.add(reading, found);
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
    ) -> Result<(), PassError> {
        self.report(stage, 0)?;
        for (index, reading) in self.log.readings()?.enumerate() {
            add(index, reading?)?;
            self.report(stage, index + 1)?;
        }
        Ok(())
    }

    fn report(&mut self, stage: Stage, readings: usize) -> Result<(), PassError> {
        match (self.watch)(RouteProgress { log: self.number, stage, readings }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(PassError::Interrupted),
        }
    }
}

/// The second pass over one log: the loop of a robot, from which the mapper learns, until the log or `observe` ends it.
/// The time since the log before counts as not observed.
///
/// `observe` is called once per reading, after the mapper has integrated it.
///
/// # Errors
///
/// When the log cannot be read to its end, or when the mapper refuses a reading.
pub fn learn<I, L>(
    mut replay: Replay<I>,
    poses: &mut L,
    mapper: &mut Mapper,
    observe: impl FnMut(&Replay<I>, &LaserReading, &Belief) -> ControlFlow<()>,
) -> Result<(), PassError>
where
    I: Iterator<Item = Result<LaserReading, LogError>>,
    L: Localization<LaserReading> + ?Sized,
{
    if mapper.readings() > 0 {
        mapper.pause(replay.time_s());
    }
    learn_on(&mut replay, poses, mapper, observe)
}

/// The same for a part of a log: the loop goes on with the present reading, and the replay stands at the reading after the
/// last one that was learned.
pub(crate) fn learn_on<I, L>(
    replay: &mut Replay<I>,
    poses: &mut L,
    mapper: &mut Mapper,
    mut observe: impl FnMut(&Replay<I>, &LaserReading, &Belief) -> ControlFlow<()>,
) -> Result<(), PassError>
where
    I: Iterator<Item = Result<LaserReading, LogError>>,
    L: Localization<LaserReading> + ?Sized,
{
    explore(replay, poses, mapper, &mut NoPilot, |replay, reading, belief, _| {
        let observed = observe(replay, reading, belief);
        Ok::<_, ReadingError>(if replay.is_over() { ControlFlow::Break(()) } else { observed })
    })?;
    replay.act(&());
    replay.take_problem().map_or(Ok(()), |problem| Err(problem.into()))
}
