//! The results of a run in a physics world: `summary.json`, and a few lines for the terminal.

use crate::metrics::{Age, ChangingScores, Delays, MapScores, RateScores, ThingReport};
use mapper::Mapper;
use robot::GoalCount;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

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
    /// The results.
    #[serde(flatten)]
    pub results: RunResults,
}

/// The results of a run in a physics world.
#[derive(Clone, Debug, Serialize)]
pub struct RunResults {
    /// Coverage and map quality at the end.
    #[serde(flatten)]
    pub map: MapScores,
    /// The accuracy on swept cells over the run; `null` if there were no such cells.
    #[serde(flatten)]
    pub changing: ChangingScores,
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
    /// The number of contacts of the curious robot that began while it stood still.
    pub contacts_while_standing: usize,
    /// The goals by outcome.
    pub goals: GoalCount,
    /// For each strategy, the share of the goals that it selected.
    pub strategy_share: BTreeMap<String, f64>,
    /// The detection of the things that appeared or disappeared: at most two entries per thing, since a thing
    /// appears and disappears at most once.
    pub things: Vec<ThingReport>,
    /// Coverage and map quality over time: every 100th reading, and for long runs 513 to 1024 points, spread evenly.
    pub curve: Vec<CurvePoint>,
    /// The hash of everything that was learned, see [`crate::map_hash`].
    pub map_hash: String,
    /// The area in which the map changes most often.
    pub liveliest: Option<Liveliest>,
}

/// The area in which the map changes most often.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Liveliest {
    /// The lower left corner of the smallest box around the cells with more than one event, m.
    pub low_m: [f64; 2],
    /// The upper right corner of this box, m.
    pub high_m: [f64; 2],
    /// The number of cells with more than one event.
    pub cells: usize,
    /// The median cycle time of these cells, s.
    pub median_interval_s: f64,
}

impl Liveliest {
    /// The area of the cells that changed more than once; `None` without such cells.
    pub fn of(mapper: &Mapper) -> Option<Self> {
        let returning = |&index: &usize| mapper.statistics(index).events() > 1 && mapper.rate(index) > 0.0;
        let cells: Vec<usize> = mapper.changed().filter(returning).collect();
        let centers = cells.iter().map(|&index| mapper.frame().center(mapper.frame().cell(index)));
        let (mut low_m, mut high_m) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for center in centers {
            for axis in 0..2 {
                low_m[axis] = low_m[axis].min(center[axis]);
                high_m[axis] = high_m[axis].max(center[axis]);
            }
        }
        let mut intervals_s: Vec<f64> = cells.iter().map(|&index| mapper.interval(index)).collect();
        intervals_s.sort_unstable_by(f64::total_cmp);
        let median_interval_s = *intervals_s.get(intervals_s.len() / 2)?;
        Some(Self { low_m, high_m, cells: cells.len(), median_interval_s })
    }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

fn seconds(time_s: Option<f64>) -> String {
    time_s.map_or("never".into(), |time_s| format!("at {time_s:.1} s"))
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let minutes = self.simulated_s / 60.0;
        writeln!(
            f,
            "{} in {}: {minutes:.1} simulated minutes in {:.1} s ({:.0} x real time)",
            self.drive, self.world, self.wall_s, self.real_time_factor
        )?;
        self.results.fmt(f)
    }
}

impl fmt::Display for RunResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { map, age, rates, goals, .. } = self;
        let or_none = |value: Option<f64>, text: fn(f64) -> String| value.map_or("-".into(), text);
        let number = |value: f64| format!("{value:.3}");
        let (seen, correct) = (percent(map.coverage), percent(map.map_quality));
        let (events, cells) = (rates.false_change_events, rates.static_cells);
        let changes = match &self.liveliest {
            None => "none seen".into(),
            Some(Liveliest { low_m, high_m, cells, median_interval_s }) => format!(
                "{cells} cells between ({:.1}, {:.1}) and ({:.1}, {:.1}) m, median cycle {median_interval_s:.0} s",
                low_m[0], low_m[1], high_m[0], high_m[1]
            ),
        };
        let mut lines = vec![
            (
                "seen",
                format!(
                    "{seen} of the cells that can be seen; the oldest observation is {:.0} s old",
                    age.max_s
                ),
            ),
            ("map", format!("{correct} correct now; {events} false changes on {cells} static cells")),
            ("changes", changes),
        ];
        if rates.rate_error_all.is_some() {
            let errors = [rates.rate_error, rates.rate_error_all].map(|error| or_none(error, percent));
            let [log_error, auc] = [rates.log_error, rates.rate_auc].map(|value| or_none(value, number));
            lines.push((
                "rates",
                format!(
                    "mean error {} of well-seen cells, {} of all changing cells; log error {log_error}, AUC {auc}",
                    errors[0], errors[1]
                ),
            ));
        }
        for thing in &self.things {
            let verb = if thing.appeared { "appeared" } else { "disappeared" };
            let [in_view, noticed, correct] = [thing.in_view_s, thing.noticed_s, thing.right_s].map(seconds);
            lines.push((
                "thing",
                format!(
                    "{} {verb} at {:.0} s: in view {in_view}, first cell correct {noticed}, 90 % correct {correct}",
                    thing.name, thing.happened_s
                ),
            ));
        }
        let GoalCount { reached, approached, given_up } = goals;
        let all = reached + approached + given_up;
        if all > 0 {
            lines.push((
                "goals",
                format!("{all}: {reached} reached, {approached} approached, {given_up} given up"),
            ));
        }
        if !self.strategy_share.is_empty() {
            let share = |(name, share): (&String, &f64)| format!("{name} {}", percent(*share));
            let shares: Vec<String> = self.strategy_share.iter().map(share).collect();
            lines.push(("chosen", shares.join(", ")));
        }
        for (name, text) in lines {
            writeln!(f, "  {name:<9} {text}")?;
        }
        let (moving, standing) = (self.collisions, self.contacts_while_standing);
        write!(f, "  contacts  {moving} while the robot moved, {standing} while it stood still")
    }
}
