//! A run: a strategy in a building, or its lower bound.

use crate::recorded::Recorded;
use crate::rows::Row;
use days::{Building, Duty, Habits, Kind, Patrol, Plan, STEP_S};
use evaluation::freshness_bound::building::{BoundSettings, BuildingBound};
use evaluation::metrics::{Freshness, Routes, UserRegret};

/// The names of the strategies, and of the lower bound of all of them.
pub(crate) const STRATEGIES: [&str; 6] = ["no-looks", "curious", "round", "coverage", "gain", BOUND];
pub(crate) const BOUND: &str = "bound";
/// The name of the robot that never looks.
pub(crate) const NO_LOOKS: &str = STRATEGIES[0];

const DAY_STEPS: f64 = 86_400.0 / STEP_S;
/// Users want to go somewhere every 50 minutes: at all times of the day in turn.
const TRIP_STEPS: usize = 300;

/// What the things do, and what the robot knows of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Things {
    /// They follow generated habits, which the robot knows or learns.
    Generated(Habits),
    /// They repeat what was recorded in real buildings. The robot learns from its looks.
    Recorded,
}

impl Things {
    const RECORDED: &'static str = "recorded";

    /// The name: that of the habits, or `recorded`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Generated(habits) => habits.name(),
            Self::Recorded => Self::RECORDED,
        }
    }

    /// The place in the order of the tables.
    pub(crate) fn place(self) -> usize {
        Habits::ALL.iter().position(|(name, _)| *name == self.name()).unwrap_or(Habits::ALL.len())
    }
}

impl std::str::FromStr for Things {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        if word == Self::RECORDED {
            return Ok(Self::Recorded);
        }
        let habits = word.parse().map(Self::Generated);
        habits.map_err(|error: String| error.replacen("one of", "one of recorded,", 1))
    }
}

/// What is computed, and what a row of the table begins with.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) kind: Kind,
    pub(crate) things: Things,
    /// The share of the time that the robot can be on patrol.
    pub(crate) share: f64,
    pub(crate) days: f64,
    pub(crate) seed: u64,
    pub(crate) strategy: String,
    /// The length of a patrol, min; `None` where the strategy chooses it, and for a robot that always moves.
    pub(crate) length_min: Option<f64>,
}

/// What came of a run; all but the score is NaN for a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outcome {
    pub(crate) brier: f64,
    /// Delays of lasting changes, min: the median and the 95 % point.
    pub(crate) delays_min: [f64; 2],
    pub(crate) missed: f64,
    /// The share of the time on patrol.
    pub(crate) patrol: f64,
    /// The share of looks that ended in front of a closed door.
    pub(crate) closed: f64,
    /// The time that users lose per trip, s, and the share of the possible trips that are not made: see [`UserRegret`].
    pub(crate) lost_s: f64,
    pub(crate) not_made: f64,
}

impl Run {
    /// The runs of a strategy, with each length of patrols that it does not choose.
    pub(crate) fn all(
        kind: Kind,
        things: Things,
        share: f64,
        seed: u64,
        days: f64,
        strategy: &str,
        lengths_min: &[f64],
    ) -> Vec<Self> {
        let run =
            |length_min| Self { kind, things, share, seed, days, strategy: strategy.to_owned(), length_min };
        if share >= 1.0 || !["curious", "round", "coverage"].contains(&strategy) {
            return vec![run(None)];
        }
        // The best ones in buildings of seeds from 100000 on.
        let usual = [if kind == Kind::Home { 2.5 } else { 3.5 }];
        let lengths_min = if lengths_min.is_empty() { &usual } else { lengths_min };
        lengths_min.iter().map(|length_min| run(Some(*length_min))).collect()
    }

    /// Computes the row; `recorded` has what the things do if they repeat recorded series.
    pub(crate) fn row(&self, recorded: &Recorded) -> Row {
        let building = Building::generate(self.kind, self.seed);
        let outcome =
            if self.strategy == BOUND { self.bound(&building) } else { self.patrol(&building, recorded) };
        Row { run: self.clone(), outcome }
    }

    fn steps(&self) -> usize {
        (self.days * DAY_STEPS) as usize
    }

    fn plan(&self) -> Plan {
        let length = self.length_min.map_or(1, |minutes| (60.0 * minutes / STEP_S) as usize);
        match self.strategy.as_str() {
            "curious" => Plan::Curious(length),
            "round" => Plan::Round(length),
            "coverage" => Plan::Coverage(length),
            "gain" => Plan::Gain,
            _ => Plan::Never,
        }
    }

    fn patrol(&self, building: &Building, recorded: &Recorded) -> Outcome {
        let duty = Duty::share(self.share);
        let mut patrol = match self.things {
            Things::Generated(habits) => Patrol::with(building, duty, habits, self.seed),
            Things::Recorded => {
                let mut draw = recorded.draw(self.days, self.seed);
                Patrol::following(building, duty, |thing| draw.timeline(thing.kind), self.seed)
            }
        };
        let mut strategy = self.plan().strategy(building, duty);
        let mut freshness = Freshness::new(STEP_S);
        let (routes, mut users, mut step) = (Routes::of_building(building), UserRegret::default(), 0);
        let totals = patrol.run(strategy.as_mut(), self.steps(), |predicted, is_blocked| {
            freshness.add(predicted, is_blocked);
            step += 1;
            if step % TRIP_STEPS == 0 {
                users.add(&routes, predicted, is_blocked);
            }
        });
        let scores = freshness.scores();
        Outcome {
            brier: scores.brier,
            delays_min: scores.detection_delay_s.map(|delay_s| delay_s / 60.0),
            missed: scores.missed,
            patrol: totals.patrol_steps as f64 / totals.steps as f64,
            closed: totals.closed as f64 / totals.looks.max(1) as f64,
            lost_s: users.lost_s(),
            not_made: users.not_made(),
        }
    }

    fn bound(&self, building: &Building) -> Outcome {
        let duty = Duty::share(self.share);
        let settings = BoundSettings::of(building, duty);
        let brier = BuildingBound::new(building, duty, self.steps(), settings).brier(self.seed);
        let [missed, patrol, closed, lost_s, not_made] = [f64::NAN; 5];
        Outcome { brier, delays_min: [f64::NAN; 2], missed, patrol, closed, lost_s, not_made }
    }
}
