//! The results as a few lines for the terminal.

use super::{Contacts, RunResults, Summary};
use crate::metrics::{
    Age, DevianceScores, FreshnessScores, PoseScores, RateScores, StateScores, ThingReport,
};
use crate::scheduled_things::ScheduledScores;
use results::numbers::{duration, percent};
use robot::GoalCount;
use std::fmt;

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
            long if *long < 86_400.0 => format!("{:.1} simulated minutes", long / 60.0),
            days => format!("{:.1} simulated days", days / 86_400.0),
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
        let RateScores {
            false_change_events: events, false_map_changes: changes, static_cells: cells, ..
        } = rates;
        let mut lines = vec![
            ("seen", self.seen()),
            (
                "map",
                format!(
                    "{correct} correct now; {events} false changes recorded, {changes} in the map, on {cells} static cells"
                ),
            ),
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
        lines.extend(self.day().map(|text| ("patrol", text)));
        lines.extend(self.scheduled.iter().flat_map(of_calendar));
        if !self.strategy_share.is_empty() {
            let share = |(name, share): (&String, &f64)| format!("{name} {}", percent(*share));
            let shares: Vec<String> = self.strategy_share.iter().map(share).collect();
            lines.push(("chosen", shares.join(", ")));
        }
        lines.extend(self.pose().map(|text| ("pose", text)));
        for (name, text) in lines {
            writeln!(f, "  {name:<9} {text}")?;
        }
        let Contacts { own_motion, run_into } = self.contacts;
        write!(f, "  contacts  {own_motion} by its own motion, {run_into} in which something ran into it")
    }
}

/// How well the map knew the things with a schedule.
fn of_calendar(scores: &ScheduledScores) -> Vec<(&'static str, String)> {
    let ScheduledScores { things, fresh, .. } = scores;
    let FreshnessScores { brier, lasting_changes, missed, detection_delay_s } = fresh;
    let mut lines = vec![(
        "calendar",
        format!("Brier score {brier:.4} over {things} things with a schedule, at all times"),
    )];
    if *lasting_changes > 0 {
        let [median, late] = detection_delay_s.map(duration);
        let missed = percent(*missed);
        let text = format!(
            "{lasting_changes} changes that last an hour or more: on the map after {median} in the median, {late} for 95 %, {missed} missed"
        );
        lines.push(("", text));
    }
    lines
}

impl RunResults {
    /// What the robot did with its time; `None` if it was always on patrol.
    fn day(&self) -> Option<String> {
        let day = self.day.as_ref()?;
        let share = day.patrol_share()?;
        let [patrol, rest] = [share, 1.0 - share].map(percent);
        let flat = match day.flat {
            0 => "always back in time".to_owned(),
            times => format!("{times} times with a flat battery before it was back"),
        };
        Some(format!("{patrol} of the time on patrol, {rest} at rest; {} patrols, {flat}", day.patrols))
    }

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
        let PoseScores { mode, median_m, p95_m, max_m, uncertain_s, lost_s, lock_ins, .. } = &self.pose;
        let (median, p95) = ((*median_m)? * 1e3, (*p95_m)? * 1e3);
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
                "{mode}: error {median:.1} mm in the median, {p95:.1} mm for 95 %, {:.1} mm at most; {:.1}° for 95 %; \
                 uncertain for {uncertain_s:.1} s, lost for {lost_s:.1} s, certain but wrong {lock_ins} times{loops}",
                max_m * 1e3,
                self.pose.heading_p95_deg.unwrap_or_default(),
            )
        })
    }

    /// The quality of the predicted map beside that of simpler predictions; `None` if nothing changed out of view.
    fn prediction(&self) -> Option<String> {
        let StateScores { brier, brier_last_seen, brier_mean, brier_true_chains, .. } = self.predicted;
        let (last_seen, mean, chains) = (brier_last_seen?, brier_mean?, brier_true_chains?);
        Some(format!(
            "Brier score {:.4} on changing cells out of view; as last seen {last_seen:.4}, share of time blocked \
             {mean:.4}, true chains {chains:.4}",
            brier?
        ))
    }

    /// The events that the rates predicted; `None` before the end of a forecast, and if nothing happened in it.
    fn deviance(&self) -> Option<String> {
        let DevianceScores { from, to, predictive_deviance, predictive_deviance_ceiling, .. } =
            self.forecasts.rates;
        let [from_min, to_min] = [from? / 60.0, to? / 60.0];
        Some(format!(
            "predictive deviance {:.2} from {from_min:.0} to {to_min:.0} min: 1 is perfect, 0 the best constant, {:.2} \
             a full view before",
            predictive_deviance?, predictive_deviance_ceiling?
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
        lines.extend(self.deviance().map(|text| ("", text)));
        if let Some(auc) = rate_auc {
            let meaning =
                "how well the rates separate changing from static cells, 1 is perfect, 0.5 is chance";
            lines.push(("", format!("AUC {auc:.2}: {meaning}")));
        }
        lines
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
    use crate::metrics::{ForecastScores, MapScores, ReachableScores};

    fn results(coverage: f64, age: Age, rates: RateScores) -> RunResults {
        RunResults {
            map: MapScores { coverage, map_quality: 0.9999 },
            reachable: ReachableScores { coverage_reachable: coverage, map_quality_reachable: 0.9999 },
            rates,
            age,
            contacts: Contacts { own_motion: 1, run_into: 2 },
            pose: PoseScores { mode: "exact".into(), ..PoseScores::default() },
            ..RunResults::default()
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
        let age = Age { max_s: 600.0, never_seen: 2 };
        let predicted = StateScores {
            calibration_error: None,
            brier: Some(0.0159),
            brier_last_seen: Some(0.02702),
            brier_mean: Some(0.01612),
            brier_true_chains: Some(0.014),
        };
        let deviance = DevianceScores {
            from: Some(400.0),
            to: Some(1200.0),
            predictive_deviance: Some(0.62),
            predictive_deviance_ceiling: Some(0.823),
            ..DevianceScores::default()
        };
        let forecasts = ForecastScores { rates: deviance, ..ForecastScores::default() };
        insta::assert_snapshot!(RunResults { predicted, forecasts, ..results(0.99999, age, rates) }, @"
          seen      >99.9 % of the cells in sight of reachable places, >99.9 % of free cells and their borders; 2 cells were never seen
          map       >99.9 % correct now; 0 false changes recorded, 0 in the map, on 50000 static cells
          rates     mean error 251.0 % over all changing cells, 29.0 % over the 43 in view for 3 cycles or more
                    log error 0.91, mean over moving things: 0 is perfect, 0.69 a factor of 2, 2.30 a factor of 10 or no estimate
                    log error 0.53 where a pass that covers only a part of a cell may count or not
                    predictive deviance 0.62 from 7 to 20 min: 1 is perfect, 0 the best constant, 0.82 a full view before
                    AUC 0.83: how well the rates separate changing from static cells, 1 is perfect, 0.5 is chance
          predicted Brier score 0.0159 on changing cells out of view; as last seen 0.0270, share of time blocked 0.0161, true chains 0.0140
          contacts  1 by its own motion, 2 in which something ran into it
        ");
    }

    #[test]
    fn a_complete_map_without_changes_is_short() {
        let age = Age { max_s: 431.0, never_seen: 0 };
        insta::assert_snapshot!(results(1.0, age, RateScores::default()), @"
          seen      100.0 % of the cells in sight of reachable places, 100.0 % of free cells and their borders; every cell was seen in the last 431 s
          map       >99.9 % correct now; 0 false changes recorded, 0 in the map, on 0 static cells
          contacts  1 by its own motion, 2 in which something ran into it
        ");
    }
}
