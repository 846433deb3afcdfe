//! The paper's claim (section 5, Figure 3): the curious robot learns rates faster than a robot with either strategy alone, and its
//! map is as good as the map of recency.

use evaluation::trials::Metric;
use reports::{Comparison, Measure, Run};

/// A map whose quality is lower by at most this value counts as equally good.
const QUALITY_MARGIN: f64 = 0.005;

/// The verdict on the claim in one run. All differences are curious − the other strategy.
#[derive(Clone)]
pub(crate) struct Claim {
    pub(crate) world: String,
    estimator: String,
    /// The differences to recency and to poisson in the log error of the rates, over the run.
    pub(crate) speed: [Comparison; 2],
    /// The same for the relative error of the rates; not part of the verdict.
    rate_error: [Comparison; 2],
    /// The difference to recency in the map quality at the end.
    quality: Comparison,
    /// `holds`: both log errors are significantly smaller, and the 95 % interval of the difference in map quality is above −0.005.
    /// `fails`: a log error is significantly larger, or the map is worse, significantly and by more than 0.005.
    ///
    /// All parts must hold at the same time, so that a test of each part at 5 % needs no correction.
    pub(crate) verdict: &'static str,
}

impl Claim {
    pub(crate) fn of(run: &Run) -> Option<Self> {
        let against = |other, measure| run.comparison("curious", other, measure);
        let of_both = |measure| Some([against("recency", measure)?, against("poisson", measure)?]);
        let (speed, rate_error) = (of_both(Measure::PRIMARY)?, of_both(Measure::Area(Metric::RateError))?);
        let quality = against("recency", Measure::Final(Metric::MapQuality))?;
        let is_significant = |sign: f64| {
            move |error: &Comparison| error.is_significant() && sign * error.mean_difference > 0.0
        };
        let is_worse = quality.is_significant() && quality.mean_difference < -QUALITY_MARGIN;
        let verdict = if is_worse || speed.iter().any(is_significant(1.0)) {
            "fails"
        } else if speed.iter().all(is_significant(-1.0)) && quality.low >= -QUALITY_MARGIN {
            "holds"
        } else {
            "not shown"
        };
        let (world, estimator) = (run.world.clone(), run.estimator.clone());
        Some(Self { world, estimator, speed, rate_error, quality, verdict })
    }

    /// The two head lines of a Markdown table of claims.
    pub(crate) const HEAD: &str = "| world | estimator | verdict | log error to recency | log error to poisson \
         | rate error to recency | rate error to poisson | map correct to recency |\n\
         |---|---|---|---|---|---|---|---|";

    /// The claim as a row of that table: mean difference with its 95 % interval, ratio (of errors), Cohen's d of pairs and p-value.
    pub(crate) fn row(&self) -> String {
        let errors = self
            .speed
            .iter()
            .chain(&self.rate_error)
            .map(|error| format!("{}, ×{:.2}{}", interval(error, 3), error.ratio, test(error)));
        let Self { world, estimator, quality, verdict, .. } = self;
        let errors = errors.collect::<Vec<_>>().join(" | ");
        let quality = interval(quality, 4) + &test(quality);
        format!("| {world} | {estimator} | **{verdict}** | {errors} | {quality} |")
    }
}

/// `×0.98, p = 0.012`.
pub(crate) fn in_short(comparison: &Comparison) -> String {
    format!("×{:.2}, {}", comparison.ratio, p_value(comparison))
}

fn interval(comparison: &Comparison, decimals: usize) -> String {
    let Comparison { mean_difference, low, high, .. } = comparison;
    format!("{mean_difference:+.decimals$} [{low:+.decimals$}, {high:+.decimals$}]")
}

fn test(comparison: &Comparison) -> String {
    format!(", d {:+.2}, {}", comparison.effect_size, p_value(comparison))
}

fn p_value(comparison: &Comparison) -> String {
    if comparison.p_value < 0.001 { "p < 0.001".into() } else { format!("p = {:.3}", comparison.p_value) }
}
