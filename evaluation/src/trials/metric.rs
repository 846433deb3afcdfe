//! The metrics of a trial over time.

use crate::metrics::MAX_LOG_ERROR;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// A share, or the mean of shares.
const SHARE: RangeInclusive<f64> = 0.0..=1.0;
/// An error or a rate without an upper limit.
const NOT_NEGATIVE: RangeInclusive<f64> = 0.0..=f64::INFINITY;

/// Defines [`Sample`] and [`Metric`] from one list of metrics.
macro_rules! metrics {
    ($count:literal: $($(#[$doc:meta])+ $field:ident => $metric:ident in $range:expr,)+) => {
        /// The metrics at one time, see [`crate::metrics`]. A metric that is undefined at this time, as the error of
        /// the rates before anything changed, is NaN. Serialized, it is its numbers as text, since reading a JSON number need
        /// not give every bit again.
        #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
        #[serde(into = "String", try_from = "String")]
        pub struct Sample {
            /// The time: steps, or s in a physics world.
            pub time: u64,
            $($(#[$doc])+ pub $field: f64,)+
        }

        impl Sample {
            /// The sample with these values, in the order of [`Metric::ALL`].
            pub fn new(time: u64, [$($field),+]: [f64; $count]) -> Self {
                Self { time, $($field),+ }
            }
        }

        /// A metric of the samples.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Metric {
            $($(#[$doc])+ $metric,)+
        }

        impl Metric {
            /// All, in the order of the files.
            pub const ALL: [Self; $count] = [$(Self::$metric),+];

            /// The name in `report.json` and `trials.csv`.
            pub fn name(self) -> &'static str {
                match self { $(Self::$metric => stringify!($field),)+ }
            }

            /// The values that the metric can have.
            pub fn range(self) -> RangeInclusive<f64> {
                match self { $(Self::$metric => $range,)+ }
            }

            /// The value in `sample`.
            pub fn of(self, sample: &Sample) -> f64 {
                match self { $(Self::$metric => sample.$field,)+ }
            }
        }
    };
}

metrics! {
    19:
    /// Mean relative error of the rates over the cells that truly changed.
    rate_error => RateError in NOT_NEGATIVE,
    /// The log error of the rates: per moving thing, then over the things.
    log_error => LogError in 0.0..=MAX_LOG_ERROR,
    /// The log error, where a pass that covers only a part of a cell may count or not.
    log_error_of_range => LogErrorOfRange in 0.0..=MAX_LOG_ERROR,
    /// The share of the cells that can be seen whose mapped state is the true state.
    map_quality => MapQuality in SHARE,
    /// Balanced accuracy of the map on swept cells.
    map_quality_changing => MapQualityChanging in SHARE,
    /// Share of the cells that can be seen that were seen.
    coverage => Coverage in SHARE,
    /// Mean estimated rate over the observed static cells, 1/step or Hz.
    false_rate => FalseRate in NOT_NEGATIVE,
    /// The share of the readings so far with a swept cell in view. A large share is the paper's lock-down.
    changing_share => ChangingShare in SHARE,
    /// Brier score of the two-state model for swept cells out of view.
    brier => Brier in SHARE,
    /// Brier score of the same for all swept cells, in view or not: how fresh the map is.
    brier_of_all => BrierOfAll in SHARE,
    /// Brier score of the state that was last seen, for swept cells out of view.
    brier_last_seen => BrierLastSeen in SHARE,
    /// Brier score of the share of the time in view during which the cell was blocked, for swept cells out of view.
    brier_mean => BrierMean in SHARE,
    /// How well the estimated rates separate changing cells from static cells: the area under the ROC curve.
    rate_auc => RateAuc in SHARE,
    /// The explained Poisson deviance of the events that followed, against the best constant, by the last forecast.
    predictive_deviance => PredictiveDeviance in f64::NEG_INFINITY..=1.0,
    /// The same, against the constant that the robot knew when it made the forecast.
    predictive_deviance_known => PredictiveDevianceKnown in f64::NEG_INFINITY..=1.0,
    /// The log error of passages per hour over busy tiles of 0.5 m.
    passages_log_error => PassagesLogError in 0.0..=MAX_LOG_ERROR,
    /// The share of the truly busiest tenth of these tiles that is in the busiest tenth by the estimates.
    busiest_tenth_hit => BusiestTenthHit in SHARE,
    /// Brier score of things that come and go, divided by that of the nominal chains of the world.
    things_by_nominal => ThingsByNominal in NOT_NEGATIVE,
    /// The same, divided by that of a posterior that knows which cells are which thing.
    things_by_floor => ThingsByFloor in NOT_NEGATIVE,
}

impl From<Sample> for String {
    fn from(sample: Sample) -> Self {
        let values = Metric::ALL.map(|metric| metric.of(&sample).to_string()).join(" ");
        format!("{} {values}", sample.time)
    }
}

impl TryFrom<String> for Sample {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        let read = || {
            let (time, values) = text.split_once(' ')?;
            let values: Vec<f64> = values.split(' ').map(str::parse).collect::<Result<_, _>>().ok()?;
            Some(Self::new(time.parse().ok()?, values.try_into().ok()?))
        };
        read().ok_or("not the numbers of a sample")
    }
}

/// Names with numbers, which are serialized as text as those of a [`Sample`].
mod as_text {
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::ser::Serializer;

    pub(super) fn serialize<S: Serializer>(shares: &[(String, f64)], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(shares.iter().map(|(name, share)| (name, share.to_string())))
    }

    pub(super) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Vec<(String, f64)>, D::Error> {
        let shares = Vec::<(String, String)>::deserialize(from)?.into_iter();
        shares.map(|(name, share)| Ok((name, share.parse().map_err(D::Error::custom)?))).collect()
    }
}

/// The result of one trial: a strategy with an estimator in a world.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Trial {
    /// The name of the world.
    pub world: String,
    /// The name of the estimator.
    pub estimator: String,
    /// The name of the strategy.
    pub strategy: String,
    /// The seed of all random streams. Trials of different strategies with the same seed are paired.
    pub seed: u64,
    /// The samples in order of time: at the same times in all trials of a report, the last at the end.
    pub samples: Vec<Sample>,
    /// For each strategy of the agent, in the order of the chooser, the share of the goals that it selected.
    #[serde(with = "as_text")]
    pub strategy_share: Vec<(String, f64)>,
    /// The number of change events on static cells.
    pub false_change_events: u64,
    /// The number of changes of static cells in the map, with corrections of wrong first observations.
    pub false_map_changes: u64,
    /// The number of contacts of the robot that began while it moved; `None` in a grid world.
    pub collisions: Option<u64>,
    /// The hash of everything that was learned, see [`crate::observer::map_hash`].
    pub map_hash: String,
}
