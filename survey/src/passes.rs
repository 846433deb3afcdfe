//! Both passes over the logs of one place.

use crate::alignment::Aligner;
use crate::error::SurveyError;
use crate::replay::{NoPilot, Replay};
use crate::route::{FirstPass, Route};
use crate::settings::{PoseMode, SurveySettings};
use interfaces::LaserReading;
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
    let is_localized = settings.pose == PoseMode::Localized;
    let all_stand = logs.iter().all(|log| log.summary().stands);
    let is_aligned = logs.len() > 1 && (is_localized || all_stand);
    // Most lasers that stand are where they were.
    let start = if all_stand { Start::At(Isometry2::identity()) } else { Start::Unknown };
    let mut routes = Vec::new();
    let mut aligner: Option<Aligner> = None;
    for (number, log) in logs.iter().enumerate() {
        let mut watch = |stage, readings| match watch(RouteProgress { log: number, stage, readings }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(PassError::Interrupted),
        };
        let mut pass = FirstPass::new(settings)?;
        each_reading(
            log,
            |readings| watch(Stage::Trajectory, readings),
            |_, reading| {
                pass.add(reading);
                Ok(())
            },
        )?;
        if is_localized {
            watch(Stage::Loops, 0)?;
        }
        let mut route = pass.finish();
        if is_localized {
            watch(Stage::Loops, route.poses.len())?;
        }
        if let Some(aligner) = &aligner {
            let mut search = aligner.search(start)?;
            each_reading(
                log,
                |readings| watch(Stage::Search, readings),
                |index, reading| {
                    if let Some(found) = route.poses.get(index) {
                        search.add(reading, found);
                    }
                    Ok(())
                },
            )?;
            route = route.moved(&search.finish().map_err(|why| PassError::Alignment { log: number, why })?);
        } else if is_aligned {
            let mut first = Aligner::new(settings, &route)?;
            each_reading(
                log,
                |readings| watch(Stage::Map, readings),
                |index, reading| route.poses.get(index).map_or(Ok(()), |found| first.add(reading, found)),
            )?;
            aligner = Some(first);
        }
        routes.push(route);
    }
    Ok(routes)
}

/// Calls `add` with every reading of a log and its index, and `watch` with the number of readings so far.
fn each_reading(
    log: &Log,
    mut watch: impl FnMut(usize) -> Result<(), PassError>,
    mut add: impl FnMut(usize, LaserReading) -> Result<(), ReadingError>,
) -> Result<(), PassError> {
    watch(0)?;
    for (index, reading) in log.readings()?.enumerate() {
        add(index, reading?)?;
        watch(index + 1)?;
    }
    Ok(())
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
    mut observe: impl FnMut(&Replay<I>, &LaserReading, &Belief) -> ControlFlow<()>,
) -> Result<(), PassError>
where
    I: Iterator<Item = Result<LaserReading, LogError>>,
    L: Localization<LaserReading> + ?Sized,
{
    if mapper.readings() > 0 {
        mapper.pause(replay.time_s());
    }
    explore(&mut replay, poses, mapper, &mut NoPilot, |replay, reading, belief, _| {
        let observed = observe(replay, reading, belief);
        Ok::<_, ReadingError>(if replay.is_over() { ControlFlow::Break(()) } else { observed })
    })?;
    replay.into_problem().map_or(Ok(()), |problem| Err(problem.into()))
}
