//! The results of a run in a physics world: `summary.json`, and a few lines for the terminal.

use crate::metrics::{
    Age, ChangingScores, Delays, MapScores, PoseScores, PredictedScores, RateScores, ReachableScores,
    ThingReport,
};
use crate::percent::percent;
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
    /// The names of the other files with results, in the same folder.
    pub files: Vec<String>,
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
    /// The same at the end, over the cells that the robot could see from some pose that it can reach.
    #[serde(flatten)]
    pub reachable: ReachableScores,
    /// The accuracy on swept cells over the run; `null` if there were no such cells.
    #[serde(flatten)]
    pub changing: ChangingScores,
    /// The quality of the predicted map on swept cells out of view, over the run.
    pub predicted: PredictedScores,
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
    /// The same contacts, by cause.
    pub contacts: Contacts,
    /// For each robot that can move, by name, the longest time for which it did not move farther than 0.1 m from a
    /// position, s.
    pub longest_standstill_s: BTreeMap<String, f64>,
    /// The errors of the poses that the robot used.
    pub pose: PoseScores,
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

/// The number of contacts of the curious robot, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Contacts {
    /// Those in which the curious robot drove into the other body, by the motion of its own drive.
    pub own_motion: usize,
    /// Those in which the other body ran into the curious robot.
    pub run_into: usize,
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

fn seconds(time_s: Option<f64>) -> String {
    time_s.map_or("never".into(), |time_s| format!("at {time_s:.1} s"))
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { drive, world, simulated_s, wall_s, real_time_factor, .. } = self;
        let ended = match self.ended_by {
            "interrupted" => ", interrupted",
            "person" => ", ended by the user",
            _ => "",
        };
        let simulated = match simulated_s {
            short if *short < 60.0 => format!("{short:.1} simulated seconds"),
            long => format!("{:.1} simulated minutes", long / 60.0),
        };
        writeln!(
            f,
            "{drive} in {world}{ended}: {simulated} in {wall_s:.1} s ({real_time_factor:.0} x real time)"
        )?;
        self.results.fmt(f)
    }
}

impl fmt::Display for RunResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { map, rates, goals, .. } = self;
        let correct = percent(map.map_quality);
        let (events, cells) = (rates.false_change_events, rates.static_cells);
        let mut lines = vec![
            ("seen", self.seen()),
            ("map", format!("{correct} correct now; {events} false changes on {cells} static cells")),
            ("changes", self.liveliest.as_ref().map_or("none seen".into(), Liveliest::to_string)),
        ];
        lines.extend(self.rates());
        lines.extend(self.prediction().map(|text| ("predicted", text)));
        lines.extend(self.things.iter().map(|thing| ("thing", line_of(thing))));
        let GoalCount { reached, approached, given_up } = goals;
        let all = reached + approached + given_up;
        if all > 0 {
            let text =
                format!("{all} finished: {reached} reached, {approached} approached, {given_up} given up");
            lines.push(("goals", text));
        }
        if !self.strategy_share.is_empty() {
            let share = |(name, share): (&String, &f64)| format!("{name} {}", percent(*share));
            let shares: Vec<String> = self.strategy_share.iter().map(share).collect();
            lines.push(("chosen", shares.join(", ")));
        }
        lines.extend(self.pose().map(|text| ("pose", text)));
        lines.extend(self.standstills().map(|text| ("stood", text)));
        for (name, text) in lines {
            writeln!(f, "  {name:<9} {text}")?;
        }
        let Contacts { own_motion, run_into } = self.contacts;
        write!(f, "  contacts  {own_motion} by its own motion, {run_into} in which something ran into it")
    }
}

impl RunResults {
    /// The seen part of the map, and its age.
    fn seen(&self) -> String {
        let Age { max_s, never_seen, .. } = self.age;
        let [reachable, all] = [self.reachable.coverage_reachable, self.map.coverage].map(percent);
        let seen = format!(
            "{reachable} of the cells in sight of reachable places, {all} of free cells and their borders"
        );
        match never_seen {
            0 => format!("{seen}; every cell was seen in the last {:.0} s", max_s.ceil()),
            1 => format!("{seen}; 1 cell was never seen"),
            cells => format!("{seen}; {cells} cells were never seen"),
        }
    }

    /// The errors of the poses; `None` if they are exact.
    fn pose(&self) -> Option<String> {
        let PoseScores { mode, median_m, p95_m, max_m, uncertain_s, lost_s, lock_ins, .. } = self.pose;
        let (median, p95) = (median_m? * 1e3, p95_m? * 1e3);
        let loops = match self.pose.loops_closed {
            0 => String::new(),
            count => {
                let (noun, moved_m) =
                    (if count == 1 { "loop" } else { "loops" }, self.pose.largest_correction_m);
                format!("; {count} {noun} closed, which moved poses of the past by up to {moved_m:.2} m")
            }
        };
        (mode != "exact").then(|| {
            format!(
                "{mode}: error {median:.1} mm in the median, {p95:.1} mm for 95 %, {:.0} mm at most; {:.1}° for 95 %; \
                 uncertain for {uncertain_s:.1} s, lost for {lost_s:.1} s, certain but wrong {lock_ins} times{loops}",
                max_m * 1e3,
                self.pose.heading_p95_deg.unwrap_or_default(),
            )
        })
    }

    /// The robots that stood still for a minute or longer; `None` if no robot did.
    fn standstills(&self) -> Option<String> {
        let stood = self.longest_standstill_s.iter().filter(|(_, longest_s)| **longest_s >= 60.0);
        let stood: Vec<String> = stood.map(|(name, longest_s)| format!("{name} {longest_s:.0} s")).collect();
        (!stood.is_empty()).then(|| format!("longest time without moving 0.1 m: {}", stood.join(", ")))
    }

    /// The quality of the predicted map beside that of simpler predictions; `None` if nothing changed out of view.
    fn prediction(&self) -> Option<String> {
        let PredictedScores { brier, brier_last_seen, brier_mean, brier_true_chains, .. } = self.predicted;
        let (last_seen, mean, chains) = (brier_last_seen?, brier_mean?, brier_true_chains?);
        Some(format!(
            "Brier score {:.4} on changing cells out of view; as last seen {last_seen:.4}, share of time blocked \
             {mean:.4}, true chains {chains:.4}",
            brier?
        ))
    }

    /// The errors of the estimated rates, in words; empty if nothing changed.
    fn rates(&self) -> Vec<(&'static str, String)> {
        let RateScores {
            rate_error,
            rate_error_cells,
            rate_error_all,
            log_error,
            log_error_of_range,
            rate_auc,
            ..
        } = &self.rates;
        let mut lines = Vec::new();
        if let Some(all) = rate_error_all {
            let well_seen = rate_error.map_or("none was in view for 3 cycles".into(), |error| {
                format!("{} over the {rate_error_cells} in view for 3 cycles or more", percent(error))
            });
            let all = percent(*all);
            lines.push(("rates", format!("mean error {all} over all changing cells, {well_seen}")));
        }
        if let Some(error) = log_error {
            let meaning = "0 is perfect, 0.69 a factor of 2, 2.30 a factor of 10 or no estimate";
            lines.push(("", format!("log error {error:.2}, mean over moving things: {meaning}")));
            if let Some(of_range) = log_error_of_range.filter(|of_range| of_range < error) {
                let meaning = "a pass that covers only a part of a cell may count or not";
                lines.push(("", format!("log error {of_range:.2} where {meaning}")));
            }
        }
        if let Some(auc) = rate_auc {
            let meaning =
                "how well the rates separate changing from static cells, 1 is perfect, 0.5 is chance";
            lines.push(("", format!("AUC {auc:.2}: {meaning}")));
        }
        lines
    }
}

impl fmt::Display for Liveliest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { low_m, high_m, cells, median_interval_s } = self;
        write!(
            f,
            "{cells} cells changed more than once, between ({:.1}, {:.1}) and ({:.1}, {:.1}) m; median cycle time \
             {median_interval_s:.0} s",
            low_m[0], low_m[1], high_m[0], high_m[1]
        )
    }
}

/// The detection of a thing as a line.
fn line_of(thing: &ThingReport) -> String {
    let verb = if thing.appeared { "appeared" } else { "disappeared" };
    if thing.in_view_s.is_none() {
        return format!("{} {verb} at {:.0} s: not in view since then", thing.name, thing.happened_s);
    }
    let [in_view, noticed, correct] = [thing.in_view_s, thing.noticed_s, thing.right_s].map(seconds);
    format!(
        "{} {verb} at {:.0} s: in view {in_view}, first cell correct {noticed}, 90 % correct {correct}",
        thing.name, thing.happened_s
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::ChangingAccuracy;

    fn results(coverage: f64, age: Age, rates: RateScores) -> RunResults {
        RunResults {
            map: MapScores { coverage, map_quality: 0.9999 },
            reachable: ReachableScores { coverage_reachable: coverage, map_quality_reachable: 0.9999 },
            changing: ChangingAccuracy::default().scores(),
            predicted: PredictedScores::default(),
            rates,
            age,
            block_latency: Delays::default(),
            free_latency: Delays::default(),
            collisions: 0,
            contacts_while_standing: 0,
            contacts: Contacts { own_motion: 1, run_into: 2 },
            pose: PoseScores { mode: "exact", ..PoseScores::default() },
            longest_standstill_s: [("cat", 312.4), ("dummy", 3.0)]
                .map(|(name, s)| (name.to_owned(), s))
                .into(),
            goals: GoalCount::default(),
            strategy_share: BTreeMap::new(),
            things: Vec::new(),
            curve: Vec::new(),
            map_hash: String::new(),
            liveliest: None,
        }
    }

    #[test]
    fn figures_say_what_they_are_and_agree() {
        let rates = RateScores {
            rate_error: Some(0.29),
            rate_error_cells: 43,
            rate_error_all: Some(2.51),
            log_error: Some(0.912),
            log_error_of_range: Some(0.534),
            rate_auc: Some(0.83),
            static_cells: 50_000,
            ..RateScores::default()
        };
        let age = Age { mean_s: 60.0, max_s: 600.0, never_seen: 2 };
        let predicted = PredictedScores {
            balanced_accuracy_out_of_view: None,
            brier: Some(0.0159),
            brier_last_seen: Some(0.02702),
            brier_mean: Some(0.01612),
            brier_true_chains: Some(0.014),
        };
        insta::assert_snapshot!(RunResults { predicted, ..results(0.99999, age, rates) }, @"
          seen      >99.9 % of the cells in sight of reachable places, >99.9 % of free cells and their borders; 2 cells were never seen
          map       >99.9 % correct now; 0 false changes on 50000 static cells
          changes   none seen
          rates     mean error 251.0 % over all changing cells, 29.0 % over the 43 in view for 3 cycles or more
                    log error 0.91, mean over moving things: 0 is perfect, 0.69 a factor of 2, 2.30 a factor of 10 or no estimate
                    log error 0.53 where a pass that covers only a part of a cell may count or not
                    AUC 0.83: how well the rates separate changing from static cells, 1 is perfect, 0.5 is chance
          predicted Brier score 0.0159 on changing cells out of view; as last seen 0.0270, share of time blocked 0.0161, true chains 0.0140
          stood     longest time without moving 0.1 m: cat 312 s
          contacts  1 by its own motion, 2 in which something ran into it
        ");
    }

    #[test]
    fn a_complete_map_without_changes_is_short() {
        let age = Age { mean_s: 60.0, max_s: 431.0, never_seen: 0 };
        insta::assert_snapshot!(results(1.0, age, RateScores::default()), @"
          seen      100.0 % of the cells in sight of reachable places, 100.0 % of free cells and their borders; every cell was seen in the last 431 s
          map       >99.9 % correct now; 0 false changes on 0 static cells
          changes   none seen
          stood     longest time without moving 0.1 m: cat 312 s
          contacts  1 by its own motion, 2 in which something ran into it
        ");
    }

    #[test]
    fn closed_loops_are_in_the_line_of_the_pose() {
        let line = |loops_closed| {
            let pose = PoseScores {
                mode: "localized",
                median_m: Some(0.001),
                p95_m: Some(0.004),
                ..PoseScores::default()
            };
            let pose = PoseScores { loops_closed, largest_correction_m: 0.253, ..pose };
            let age = Age { mean_s: 60.0, max_s: 431.0, never_seen: 0 };
            RunResults { pose, ..results(1.0, age, RateScores::default()) }.pose().unwrap()
        };
        assert!(line(0).ends_with("certain but wrong 0 times"));
        assert!(
            line(2).ends_with("wrong 0 times; 2 loops closed, which moved poses of the past by up to 0.25 m")
        );
    }
}
