//! The results of a run in a physics world, as `summary.json` has them.

use crate::known_things::{KnownThingsScores, ThingBrier};
use crate::metrics::{
    Age, ChangingScores, Delays, ForecastScores, IntervalScores, MapScores, PassageScores, PoseScores,
    RateScores, StateScores,
};
use crate::scheduled_things::ScheduledScores;
use results::numbers::{duration, percent};
use robot::{DayTotals, GoalCount};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The version of the layout of `summary.json`; count up when a key is renamed, removed or changes its meaning.
pub const SCHEMA: u32 = 5;

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
    /// The pilot: `agent` or `tour`.
    pub drive: &'static str,
    /// The strategy of the agent; `null` for other pilots.
    pub strategy: Option<&'static str>,
    /// The estimator of rates.
    pub estimator: &'static str,
    /// The occupancy model.
    pub occupancy: &'static str,
    /// The reason for the end of the run: `duration`, `tour` or `interrupted`.
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
    /// How well the robot knows the things that come and go, each with one place; only in worlds with such things.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub known_things: Option<KnownThingsScores>,
    /// For each strategy, the share of the goals that it selected.
    pub strategy_share: BTreeMap<String, f64>,
    /// Coverage and map quality over time: every 100th reading, and for long runs 513 to 1024 points, spread evenly.
    pub curve: Vec<CurvePoint>,
    /// The hash of everything that was learned, see [`crate::observer::map_hash`].
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

// The results as a few lines for the terminal.

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { drive, world, simulated_s, wall_s, real_time_factor, .. } = self;
        let ended = match self.ended_by {
            "interrupted" => ", interrupted",
            _ => "",
        };
        let simulated = duration(*simulated_s);
        writeln!(
            f,
            "{drive} in {world}{ended}: {simulated} simulated in {wall_s:.1} s ({real_time_factor:.0} x real time)"
        )?;
        self.results.fmt(f)
    }
}

impl fmt::Display for RunResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [seen, correct] = [self.map.coverage, self.map.map_quality].map(percent);
        let RateScores { false_change_events, false_map_changes, static_cells, .. } = self.rates;
        writeln!(f, "  seen      {seen} of the free cells and their borders")?;
        writeln!(
            f,
            "  map       {correct} correct now; {false_change_events} false changes recorded, {false_map_changes} in the map, on \
             {static_cells} static cells"
        )?;
        for (name, text) in [
            ("rates", self.rates()),
            ("predicted", self.prediction()),
            ("things", self.known_things()),
            ("goals", self.goals()),
            ("pose", self.pose()),
        ] {
            text.map_or(Ok(()), |text| writeln!(f, "  {name:<9} {text}"))?;
        }
        let Contacts { own_motion, run_into } = self.contacts;
        write!(f, "  contacts  {own_motion} by its own motion, {run_into} in which something ran into it")
    }
}

impl RunResults {
    /// The errors of the estimated rates; `None` if nothing changed.
    fn rates(&self) -> Option<String> {
        let RateScores { rate_error, rate_error_cells, rate_error_all, log_error, rate_auc, .. } = self.rates;
        let all = percent(rate_error_all?);
        let well_seen = rate_error.map_or("none was in view for 3 cycles".into(), |error| {
            format!("{} over the {rate_error_cells} in view for 3 cycles or more", percent(error))
        });
        let log_error = log_error
            .map_or_else(String::new, |error| format!("; log error {error:.2} (0.69: a factor of 2)"));
        let auc =
            rate_auc.map_or_else(String::new, |auc| format!("; AUC {auc:.2} (1 is perfect, 0.5 chance)"));
        Some(format!("mean error {all} over all changing cells, {well_seen}{log_error}{auc}"))
    }

    /// The error of the predicted map beside that of simpler predictions; `None` if nothing changed out of view.
    fn prediction(&self) -> Option<String> {
        let StateScores { brier, brier_last_seen, brier_mean, brier_true_chains, .. } = self.predicted;
        let (predicted, last_seen, mean, chains) =
            (brier?, brier_last_seen?, brier_mean?, brier_true_chains?);
        Some(format!(
            "Brier score out of view {predicted:.3} (as last seen {last_seen:.3}, share of time blocked {mean:.3}, true rates {chains:.3})"
        ))
    }

    /// How well things that come and go are known; `None` without one that was seen.
    fn known_things(&self) -> Option<String> {
        let KnownThingsScores { things, objects, all, .. } = self.known_things?;
        let ThingBrier { brier, by_nominal, by_floor, last_seen_by_nominal } = all.now?;
        Some(format!(
            "{things} come and go, {objects} known as objects; Brier score {brier:.3}: {by_nominal:.2} times that of their true laws (as \
             last seen {last_seen_by_nominal:.2}), {by_floor:.2} times that of a map that is told which cells are which thing"
        ))
    }

    /// The goals by outcome; `None` without a goal.
    fn goals(&self) -> Option<String> {
        let GoalCount { reached, approached, given_up } = self.goals;
        let all = reached + approached + given_up;
        (all > 0).then(|| {
            format!("{all} finished: {reached} reached, {approached} approached, {given_up} given up")
        })
    }

    /// The errors of the poses; `None` if they are exact.
    fn pose(&self) -> Option<String> {
        let PoseScores { mode, median_m, p95_m, max_m, uncertain_s, lost_s, lock_ins, .. } = &self.pose;
        let [median, p95, max] = [(*median_m)?, (*p95_m)?, *max_m].map(|error_m| 1e3 * error_m);
        (mode != "exact").then(|| {
            format!(
                "{mode}: error {median:.1} mm in the median, {p95:.1} mm for 95 %, {max:.1} mm at most; uncertain for \
                 {uncertain_s:.1} s, lost for {lost_s:.1} s, certain but wrong {lock_ins} times"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::MapScores;

    fn results(rates: RateScores, predicted: StateScores) -> RunResults {
        RunResults {
            map: MapScores { coverage: 0.99999, map_quality: 0.9999 },
            rates,
            predicted,
            contacts: Contacts { own_motion: 1, run_into: 2 },
            pose: PoseScores { mode: "exact".into(), ..PoseScores::default() },
            ..RunResults::default()
        }
    }

    #[test]
    fn figures_say_what_they_are() {
        let rates = RateScores {
            rate_error: Some(0.29),
            rate_error_cells: 43,
            rate_error_all: Some(2.51),
            log_error: Some(0.912),
            rate_auc: Some(0.83),
            static_cells: 50_000,
            ..RateScores::default()
        };
        let predicted = StateScores {
            calibration_error: None,
            brier: Some(0.0159),
            brier_last_seen: Some(0.02702),
            brier_mean: Some(0.01612),
            brier_true_chains: Some(0.014),
        };
        insta::assert_snapshot!(results(rates, predicted), @"
          seen      >99.9 % of the free cells and their borders
          map       >99.9 % correct now; 0 false changes recorded, 0 in the map, on 50000 static cells
          rates     mean error 251.0 % over all changing cells, 29.0 % over the 43 in view for 3 cycles or more; log error 0.91 (0.69: a factor of 2); AUC 0.83 (1 is perfect, 0.5 chance)
          predicted Brier score out of view 0.016 (as last seen 0.027, share of time blocked 0.016, true rates 0.014)
          contacts  1 by its own motion, 2 in which something ran into it
        ");
    }

    #[test]
    fn a_map_without_changes_is_short() {
        insta::assert_snapshot!(results(RateScores::default(), StateScores::default()), @"
          seen      >99.9 % of the free cells and their borders
          map       >99.9 % correct now; 0 false changes recorded, 0 in the map, on 0 static cells
          contacts  1 by its own motion, 2 in which something ran into it
        ");
    }
}
