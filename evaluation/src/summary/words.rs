//! The results as a few lines for the terminal.

use super::{Contacts, RunResults, Summary};
use crate::metrics::{PoseScores, RateScores, StateScores};
use results::numbers::percent;
use robot::GoalCount;
use std::fmt;

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
        let [reachable, all, correct] =
            [self.reachable.coverage_reachable, self.map.coverage, self.map.map_quality].map(percent);
        let RateScores { false_change_events, false_map_changes, static_cells, .. } = self.rates;
        writeln!(
            f,
            "  seen      {reachable} of the cells in sight of reachable places, {all} of free cells and their borders"
        )?;
        writeln!(
            f,
            "  map       {correct} correct now; {false_change_events} false changes recorded, {false_map_changes} in the map, on \
             {static_cells} static cells"
        )?;
        for (name, text) in [
            ("rates", self.rates()),
            ("predicted", self.prediction()),
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
    use crate::metrics::{MapScores, ReachableScores};

    fn results(rates: RateScores, predicted: StateScores) -> RunResults {
        RunResults {
            map: MapScores { coverage: 0.99999, map_quality: 0.9999 },
            reachable: ReachableScores { coverage_reachable: 1.0, map_quality_reachable: 0.9999 },
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
          seen      100.0 % of the cells in sight of reachable places, >99.9 % of free cells and their borders
          map       >99.9 % correct now; 0 false changes recorded, 0 in the map, on 50000 static cells
          rates     mean error 251.0 % over all changing cells, 29.0 % over the 43 in view for 3 cycles or more; log error 0.91 (0.69: a factor of 2); AUC 0.83 (1 is perfect, 0.5 chance)
          predicted Brier score out of view 0.016 (as last seen 0.027, share of time blocked 0.016, true rates 0.014)
          contacts  1 by its own motion, 2 in which something ran into it
        ");
    }

    #[test]
    fn a_map_without_changes_is_short() {
        insta::assert_snapshot!(results(RateScores::default(), StateScores::default()), @"
          seen      100.0 % of the cells in sight of reachable places, >99.9 % of free cells and their borders
          map       >99.9 % correct now; 0 false changes recorded, 0 in the map, on 0 static cells
          contacts  1 by its own motion, 2 in which something ran into it
        ");
    }
}
