//! What a run showed, in numbers: `summary.json`, and a few sentences for a person.

use crate::metrics::{Age, Delays, RateScores, ThingReport};
use mapper::Mapper;
use robot::GoalCount;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Coverage and map quality at one time.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CurvePoint {
    /// Simulated time, s.
    pub time_s: f64,
    /// Share of the cells that can be seen that were seen.
    pub coverage: f64,
    /// Share of the cells that can be seen whose mapped state is true.
    pub map_quality: f64,
}

/// `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Of the program.
    pub version: &'static str,
    /// The command line, without the program's name.
    pub arguments: Vec<String>,
    /// Every setting of the mapper, the agent and the controller.
    pub settings: serde_json::Value,
    /// The world's name.
    pub world: String,
    /// The seed of all chance.
    pub seed: u64,
    /// Who drove.
    pub drive: &'static str,
    /// How the agent chose its goals; `null` where it did not drive.
    pub strategy: Option<&'static str>,
    /// How rates were estimated.
    pub estimator: &'static str,
    /// How evidence became a map.
    pub occupancy: &'static str,
    /// Why the run ended: `duration`, `tour`, `person` or `interrupted`.
    pub ended_by: &'static str,
    /// Simulated time, s.
    pub simulated_s: f64,
    /// Time on the wall, s.
    pub wall_s: f64,
    /// Simulated over wall time.
    pub real_time_factor: f64,
    /// Share of the cells that can be seen that were seen.
    pub coverage: f64,
    /// Share of the cells that can be seen whose mapped state is true now.
    pub map_quality: f64,
    /// Balanced accuracy on the cells that truly change and are in view, over the run; `null` where
    /// there was nothing to count.
    pub map_quality_changing: Option<f64>,
    /// The same for those out of view.
    pub map_quality_changing_out_of_view: Option<f64>,
    /// The rates of change against those that really happened.
    #[serde(flatten)]
    pub rates: RateScores,
    /// Time since cells were seen, at the end.
    pub age: Age,
    /// How soon the map followed block events that a beam had shown.
    pub block_latency: Delays,
    /// The same for free events.
    pub free_latency: Delays,
    /// Contacts of the curious robot that began while it moved.
    pub collisions: usize,
    /// Contacts that began while it stood: it was run into.
    pub contacts_while_standing: usize,
    /// How goals ended.
    pub goals: GoalCount,
    /// Share of the goals that each strategy chose.
    pub strategy_share: BTreeMap<String, f64>,
    /// Things that appeared or went.
    pub things: Vec<ThingReport>,
    /// Coverage and quality over time.
    pub curve: Vec<CurvePoint>,
    /// A hash over every map and statistic: equal hashes mean equal minds.
    pub map_hash: String,
    /// The middle of where the map changes most often, m, and how long a cycle takes there, s.
    pub liveliest: Option<Liveliest>,
}

/// Where the map changes, by its own account.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Liveliest {
    /// The corners of the smallest box around the cells with more than one event, m.
    pub low_m: [f64; 2],
    /// See `low_m`.
    pub high_m: [f64; 2],
    /// How many cells.
    pub cells: usize,
    /// The median time of a cycle over these cells, s.
    pub median_interval_s: f64,
}

impl Liveliest {
    /// The cells of the map that changed there and back.
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
    time_s.map_or("never".into(), |time_s| format!("{time_s:.1} s"))
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rates, goals, .. } = self;
        let minutes = self.simulated_s / 60.0;
        writeln!(
            f,
            "{} in {}: {minutes:.1} simulated minutes in {:.1} s ({:.0} x real time)",
            self.drive, self.world, self.wall_s, self.real_time_factor
        )?;
        writeln!(
            f,
            "  seen      {} of the cells that can be seen; the oldest look is {:.0} s old",
            percent(self.coverage),
            self.age.max_s
        )?;
        writeln!(
            f,
            "  map       {} right now; {} false changes on {} static cells",
            percent(self.map_quality),
            rates.false_change_events,
            rates.static_cells
        )?;
        match &self.liveliest {
            None => writeln!(f, "  changes   none seen")?,
            Some(Liveliest { low_m, high_m, cells, median_interval_s }) => {
                write!(
                    f,
                    "  changes   {cells} cells between ({:.1}, {:.1}) and ({:.1}, {:.1}) m, there and back in {median_interval_s:.0} s",
                    low_m[0], low_m[1], high_m[0], high_m[1]
                )?;
                match rates.rate_error {
                    Some(error) => writeln!(f, " (mean error of the rates {})", percent(error))?,
                    None => writeln!(f)?,
                }
            }
        }
        for thing in &self.things {
            let verb = if thing.appeared { "appeared" } else { "went" };
            writeln!(
                f,
                "  thing     {} {verb} at {:.0} s: in view {}, noticed {}, the map right {}",
                thing.name,
                thing.happened_s,
                seconds(thing.in_view_s),
                seconds(thing.noticed_s),
                seconds(thing.right_s)
            )?;
        }
        let all = goals.reached + goals.given_up;
        if all > 0 {
            writeln!(f, "  goals     {} of {all} reached, {} given up", goals.reached, goals.given_up)?;
        }
        if !self.strategy_share.is_empty() {
            let shares: Vec<String> = self
                .strategy_share
                .iter()
                .map(|(name, share)| format!("{name} {}", percent(*share)))
                .collect();
            writeln!(f, "  chose     {}", shares.join(", "))?;
        }
        write!(
            f,
            "  contacts  {} while it moved, {} while it stood",
            self.collisions, self.contacts_while_standing
        )
    }
}
