//! A run: a strategy in a building for some days; and its line in the table of all runs.

use crate::study::Line;
use agent::Policy;
use anyhow::Context;
use days::Kind;
use evaluation::physics_trial::{PhysicsTrial, day, in_own_frame, settings};
use robot::PatrolDay;
use sim::physics::{PatrolDaySpec, WorldSpec};

/// What is computed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) kind: Kind,
    /// The share of the time that the robot can be on patrol.
    pub(crate) share: f64,
    /// How long it can be on patrol with a full battery, s.
    pub(crate) battery_s: f64,
    pub(crate) days: u32,
    pub(crate) seed: u64,
    pub(crate) strategy: Policy,
}

/// A run, and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) run: Run,
    pub(crate) values: [f64; VALUES.len()],
}

/// The measures of a run: the Brier score; the median and the 95 % point of the delays, min; the share of lasting changes that were
/// missed; what users lose per trip, s; the share of the trips not made; the share of the time on patrol; how often the battery was
/// flat away from the dock; contacts by the robot's own motion.
pub(crate) const VALUES: [&str; 9] =
    ["brier", "median_min", "delay95_min", "missed", "lost_s", "not_made", "patrol", "flat", "contacts"];

impl Run {
    /// Computes the row.
    pub(crate) fn row(&self) -> anyhow::Result<Row> {
        let spec = WorldSpec::generate_calendar(self.kind, self.seed);
        let spec = spec
            .with_patrol(PatrolDaySpec { battery_s: self.battery_s, ..PatrolDaySpec::of_share(self.share) });
        let settings = settings(&spec)?;
        let own = in_own_frame(&settings, &spec, self.seed);
        let day = day(own.as_ref().map_or(&spec, |(spec, _)| spec)).context("the robot has no patrol")?;
        let agent = settings.agent(&self.strategy, self.seed)?;
        let pilot = PatrolDay::new(settings.pilot(agent, self.seed)?, day);
        let mut trial = PhysicsTrial::new(&spec, self.seed, &settings, None, pilot)?.on_battery();
        let end_s = f64::from(self.days) * 86_400.0;
        trial.run_exactly(end_s)?;
        let results = trial.results();
        let scheduled = results.scheduled.context("nothing in the world has a schedule")?;
        let day = results.day.context("the robot has no day")?;
        let [median_s, late_s] = scheduled.detection_delay_s;
        Ok(Row {
            run: self.clone(),
            values: [
                scheduled.brier,
                median_s / 60.0,
                late_s / 60.0,
                scheduled.missed,
                scheduled.user_lost_s,
                scheduled.trips_not_made,
                day.patrol_s / end_s,
                f64::from(day.flat),
                results.contacts.own_motion as f64,
            ],
        })
    }
}

impl Line for Row {
    type Run = Run;

    fn titles() -> String {
        format!("kind,share,battery_s,days,seed,strategy,{}", VALUES.join(","))
    }

    fn run(&self) -> &Run {
        &self.run
    }

    fn line(&self) -> String {
        let Run { kind, share, battery_s, days, seed, strategy } = &self.run;
        let values = self.values.map(|value| value.to_string()).join(",");
        format!("{},{share},{battery_s},{days},{seed},{},{values}", kind.name(), strategy.name())
    }

    fn parse(line: &str) -> anyhow::Result<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let ([kind, share, battery_s, days, seed, strategy], numbers) =
            fields.split_first_chunk().context("it has less than 7 fields")?;
        let numbers: Vec<f64> = numbers.iter().map(|text| text.parse()).collect::<Result<_, _>>()?;
        let run = Run {
            kind: kind.parse().map_err(anyhow::Error::msg)?,
            share: share.parse()?,
            battery_s: battery_s.parse()?,
            days: days.parse()?,
            seed: seed.parse()?,
            strategy: strategy.parse()?,
        };
        let values = <[f64; VALUES.len()]>::try_from(numbers).ok();
        Ok(Self { run, values: values.with_context(|| format!("it has {} fields", fields.len()))? })
    }
}
