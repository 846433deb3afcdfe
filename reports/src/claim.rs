//! The paper's claim (section 5, Figure 3): the curious robot learns rates faster than a robot with either
//! strategy alone, and its map is as good as the map of recency.

use super::comparison::Comparison;
use super::measure::Measure;
use super::run::Run;
use super::wording::{difference, p_value, value};
use evaluation::trials::Metric;

/// A map whose quality is lower by at most this value counts as equally good.
const QUALITY_MARGIN: f64 = 0.005;
/// The verdict on the claim in one run. All differences are curious − the other strategy.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The world, or `all worlds (N)`.
    pub world: String,
    /// The estimator.
    pub estimator: String,
    /// What is compared pair by pair: `5 trials`, or `50 worlds`.
    pub pairs: String,
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
    /// as good: the 95 % interval of the difference in map quality is above −0.005.
    Holds,
    /// Neither of the other two.
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

fn is_as_good_map(quality: &Comparison) -> bool {
    quality.low >= -QUALITY_MARGIN
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

        let units = if run.worlds > 1 { "world" } else { "trial" };
        let plural = if quality_like_recency.pairs == 1 { "" } else { "s" };
        let speed = [&faster_than_recency, &faster_than_poisson];
        let verdict = if is_worse_map(&quality_like_recency) || speed.iter().any(|error| is_slower(error)) {
            Verdict::Fails
        } else if speed.iter().all(|error| is_faster(error)) && is_as_good_map(&quality_like_recency) {
            Verdict::Holds
        } else {
            Verdict::NotShown
        };
        Some(Self {
            world: run.world.clone(),
            estimator: run.estimator.clone(),
            pairs: format!("{} {units}{plural}", quality_like_recency.pairs),
            rate_error_to_recency: against("recency", Measure::Area(Metric::RateError))?,
            rate_error_to_poisson: against("poisson", Measure::Area(Metric::RateError))?,
            faster_than_recency,
            faster_than_poisson,
            quality_like_recency,
            verdict,
        })
    }

    /// The verdict and its three parts, one per line.
    pub fn sentence(&self) -> String {
        let pairs = &self.pairs;
        let speed = |error: &Comparison| match (error, &error.b) {
            (error, other) if is_faster(error) => format!("curious learns rates faster than {other}"),
            (error, other) if is_slower(error) => format!("curious learns rates slower than {other}"),
            (_, other) => format!("{pairs} cannot tell whether curious or {other} learns rates faster"),
        };
        let map = match &self.quality_like_recency {
            quality if is_worse_map(quality) => "curious has a worse map than recency".into(),
            quality if is_as_good_map(quality) => "curious has as good a map as recency".into(),
            _ => format!("{pairs} cannot tell whether curious has as good a map as recency"),
        };
        format!(
            "The paper's claim {}:\n{};\n{};\n{map}.",
            if self.verdict == Verdict::NotShown { "is not shown" } else { self.verdict.name() },
            speed(&self.faster_than_recency),
            speed(&self.faster_than_poisson),
        )
    }

    /// The two head lines of a Markdown table of claims.
    pub fn markdown_head() -> &'static str {
        "| world | estimator | verdict | log error to recency | log error to poisson \
         | rate error to recency | rate error to poisson | map correct to recency |\n\
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
