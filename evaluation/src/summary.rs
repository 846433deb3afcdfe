//! The results of a run in a physics world, as `summary.json` has them.

mod words;

use crate::metrics::{
    Age, ChangingScores, Delays, ForecastScores, IntervalScores, MapScores, PassageScores, PoseScores,
    RateScores, ReachableScores, StateScores, ThingReport,
};
use crate::scheduled_things::ScheduledScores;
use robot::{DayTotals, GoalCount};
use serde::Serialize;
use std::collections::BTreeMap;

/// The version of the layout of `summary.json`; count up when a key is renamed, removed or changes its meaning.
pub const SCHEMA: u32 = 3;

/// Coverage and map quality at one time.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CurvePoint {
    /// The simulated time, s.
    pub time_s: f64,
    /// The scores at this time.
    #[serde(flatten)]
    pub scores: MapScores,
}

/// The content of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// The version of this layout: [`SCHEMA`].
    pub schema: u32,
    /// The build of the program: equal builds compute equal bits.
    pub build: &'static str,
    /// The version of the program.
    pub version: &'static str,
    /// The command line, without the name of the program.
    pub arguments: Vec<String>,
    /// Every setting of the mapper, the agent and the controller.
    pub settings: serde_json::Value,
    /// The name of the world.
    pub world: String,
    /// The seed of all random streams.
    pub seed: u64,
    /// The pilot: `agent`, `tour` or `keyboard`.
    pub drive: &'static str,
    /// The strategy of the agent; `null` for other pilots.
    pub strategy: Option<&'static str>,
    /// The estimator of rates.
    pub estimator: &'static str,
    /// The occupancy model.
    pub occupancy: &'static str,
    /// The reason for the end of the run: `duration`, `tour`, `person` or `interrupted`.
    pub ended_by: &'static str,
    /// The simulated time, s.
    pub simulated_s: f64,
    /// The wall time, s.
    pub wall_s: f64,
    /// Simulated time divided by wall time.
    pub real_time_factor: f64,
    /// The names of the other files with results, in the same folder.
    pub files: Vec<String>,
    /// The results.
    #[serde(flatten)]
    pub results: RunResults,
}

/// The results of a run in a physics world.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RunResults {
    /// Coverage and map quality at the end.
    #[serde(flatten)]
    pub map: MapScores,
    /// The same at the end, over the cells that the robot could see from some pose that it can reach.
    #[serde(flatten)]
    pub reachable: ReachableScores,
    /// The accuracy on swept cells over the run; `null` if there were no such cells.
    #[serde(flatten)]
    pub changing: ChangingScores,
    /// The quality of the predicted map on swept cells out of view, over the run.
    pub predicted: StateScores,
    /// How well the frozen map predicted what followed.
    pub forecasts: ForecastScores,
    /// The credible intervals of the rates.
    pub intervals: IntervalScores,
    /// The estimated passages per tile compared with the true ones.
    pub passages: PassageScores,
    /// The estimated rates compared with the true rates.
    #[serde(flatten)]
    pub rates: RateScores,
    /// The time since cells were last seen, at the end.
    pub age: Age,
    /// The delays between block events that a beam has shown and the map.
    pub block_latency: Delays,
    /// The delays between free events that a beam has shown and the map.
    pub free_latency: Delays,
    /// The number of contacts of the curious robot that began while it moved.
    pub collisions: usize,
    /// All contacts of the curious robot, by cause.
    pub contacts: Contacts,
    /// The errors of the poses that the robot used.
    pub pose: PoseScores,
    /// The goals by outcome.
    pub goals: GoalCount,
    /// What a robot with a battery, or with orders by others, did with its time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub day: Option<DayTotals>,
    /// How well the predicted map knew the things with a schedule, at all times, rests included; only in worlds with a calendar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scheduled: Option<ScheduledScores>,
    /// For each strategy, the share of the goals that it selected.
    pub strategy_share: BTreeMap<String, f64>,
    /// The detection of the things that appeared or disappeared: at most two entries per thing, since a thing
    /// appears and disappears at most once.
    pub things: Vec<ThingReport>,
    /// Coverage and map quality over time: every 100th reading, and for long runs 513 to 1024 points, spread evenly.
    pub curve: Vec<CurvePoint>,
    /// The hash of everything that was learned, see [`crate::map_hash`].
    pub map_hash: String,
}

/// The number of contacts of the curious robot, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Contacts {
    /// Those in which the curious robot drove into the other body, by the motion of its own drive.
    pub own_motion: usize,
    /// Those in which the other body ran into the curious robot.
    pub run_into: usize,
}
