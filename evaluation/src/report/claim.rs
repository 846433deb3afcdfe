//! The paper's claim (section 5, Figure 3): the curious robot learns rates faster than a robot with either
//! strategy alone, and its map is as good as the map of recency.

use super::comparison::Comparison;
use super::metric::{Measure, Metric};
use super::run::Run;
use super::wording::{difference, p_value, value};

/// A map whose quality is lower by at most this value counts as equally good.
const QUALITY_MARGIN: f64 = 0.005;

/// The verdict on the claim in one run. All differences are curious − the other strategy.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The world, or `all worlds (N)`.
    pub world: String,
    /// The estimator.
    pub estimator: String,
    /// The difference to recency in the log error of the rates, over the run.
    pub faster_than_recency: Comparison,
    /// The difference to poisson in the log error of the rates, over the run.
    pub faster_than_poisson: Comparison,
    /// The difference to recency in the relative error of the rates, over the run; not part of the verdict.
    pub rate_error_to_recency: Comparison,
    /// The difference to poisson in the relative error of the rates, over the run; not part of the verdict.
    pub rate_error_to_poisson: Comparison,
    /// The difference to recency in the map quality at the end.
    pub quality_like_recency: Comparison,
    /// Whether the claim holds.
    pub verdict: Verdict,
}

/// Whether the claim holds.
///
/// All parts of the claim must hold at the same time, so that a test of each part at 5 % needs no correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The log error over the run is significantly smaller than that of recency and that of poisson, and the map is
    /// as good.
    Holds,
    /// The log error is neither significantly smaller than both nor significantly larger than either, and the map
    /// is as good.
    NotShown,
    /// The log error is significantly larger than that of recency or that of poisson, or the map is worse
    /// (significantly, and by more than 0.005).
    Fails,
}

impl Verdict {
    /// The verdict in one or two words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::NotShown => "not shown",
            Self::Fails => "fails",
        }
    }
}

fn is_faster(error: &Comparison) -> bool {
    error.is_significant() && error.mean_difference < 0.0
}

fn is_slower(error: &Comparison) -> bool {
    error.is_significant() && error.mean_difference > 0.0
}

fn is_worse_map(quality: &Comparison) -> bool {
    quality.is_significant() && quality.mean_difference < -QUALITY_MARGIN
}

impl Claim {
    /// The verdict of one run; `None` unless the run has `curious`, `recency` and `poisson`.
    pub fn of(run: &Run) -> Option<Self> {
        let against = |other, measure| run.comparison("curious", other, measure);
        let faster_than_recency = against("recency", Measure::PRIMARY)?;
        let faster_than_poisson = against("poisson", Measure::PRIMARY)?;
        let quality_like_recency = against("recency", Measure::Final(Metric::MapQuality))?;

        let speed = [&faster_than_recency, &faster_than_poisson];
        let verdict = if is_worse_map(&quality_like_recency) || speed.iter().any(|error| is_slower(error)) {
            Verdict::Fails
        } else if speed.iter().all(|error| is_faster(error)) {
            Verdict::Holds
        } else {
            Verdict::NotShown
        };
        Some(Self {
            world: run.world.clone(),
            estimator: run.estimator.clone(),
            rate_error_to_recency: against("recency", Measure::Area(Metric::RateError))?,
            rate_error_to_poisson: against("poisson", Measure::Area(Metric::RateError))?,
            faster_than_recency,
            faster_than_poisson,
            quality_like_recency,
            verdict,
        })
    }

    /// The verdict and its parts as text of three lines.
    pub fn sentence(&self) -> String {
        let speed = |error: &Comparison| match error {
            error if is_faster(error) => "faster than",
            error if is_slower(error) => "slower than",
            _ => "level with",
        };
        let quality = &self.quality_like_recency;
        let map = match quality.mean_difference {
            _ if is_worse_map(quality) => "worse than",
            difference if difference < -QUALITY_MARGIN => "not significantly worse than",
            _ => "as good as",
        };
        format!(
            "The paper's claim {}: curious learns rates {} recency\nand {} poisson, and its map is {map}\nthat of recency.",
            if self.verdict == Verdict::NotShown { "is not shown" } else { self.verdict.name() },
            speed(&self.faster_than_recency),
            speed(&self.faster_than_poisson),
        )
    }

    /// The two head lines of a Markdown table of claims.
    pub fn markdown_head() -> &'static str {
        "| world | estimator | verdict | log error to recency | log error to poisson \
         | rate error to recency | rate error to poisson | map quality to recency |\n\
         |---|---|---|---|---|---|---|---|"
    }

    /// The claim as a row of that table, without a line's end: mean difference with its 95 %
    /// interval, ratio (of errors), Cohen's d of pairs and p-value.
    pub fn markdown_row(&self) -> String {
        let error = |comparison: &Comparison| {
            format!("{}, ×{}{}", interval(comparison, 3), value(comparison.ratio, 2), test(comparison))
        };
        let quality = &self.quality_like_recency;
        format!(
            "| {} | {} | **{}** | {} | {} | {} | {} | {}{} |",
            self.world.replace('|', "\\|"),
            self.estimator,
            self.verdict.name(),
            error(&self.faster_than_recency),
            error(&self.faster_than_poisson),
            error(&self.rate_error_to_recency),
            error(&self.rate_error_to_poisson),
            interval(quality, 4),
            test(quality),
        )
    }
}

fn interval(comparison: &Comparison, decimals: usize) -> String {
    let [mean, low, high] =
        [comparison.mean_difference, comparison.low, comparison.high].map(|end| difference(end, decimals));
    format!("{mean} [{low}, {high}]")
}

fn test(comparison: &Comparison) -> String {
    format!(", d {}, {}", difference(comparison.effect_size, 2), p_value(comparison.p_value))
}
