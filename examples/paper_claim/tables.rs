//! The tables of docs/figure3/results.md.

use crate::Finding;
use crate::claim::{Claim, in_short};
use evaluation::trials::Metric;
use reports::Measure;
use std::fmt::Write;

/// The columns of the strategies of a condition.
const SHARES: &str = "| world | strategy | log error, area | log error, end | time at changes | map correct | changing cells | coverage |";
/// The last columns of the overview.
const RATIOS: &str = "generated: to recency | to coin | to poisson |";

pub(crate) fn markdown(findings: &[Finding], seeds: u64) -> String {
    let mut text = format!(
        "# Does the paper's Figure 3 hold? All results\n\n\
         Made by `cargo run --example paper_claim`, {seeds} seeds in each shipped world and {seeds} generated worlds, \
         each with its own seed. [figure3.md](../figure3.md) explains the results.\n\n\
         Differences are curious minus the other strategy, over the run (area under the curve) for errors and \
         at the end for map correct, each with its 95 % interval, the ratio of the means, Cohen's d of the pairs \
         and the p-value of the paired t test. For errors, lower is better.\n"
    );
    text.push_str(&overview(findings));
    for finding in findings {
        let _ = write!(text, "\n## {}\n\n{}\n", capital(&finding.condition.name), Claim::HEAD);
        for claim in finding.claims() {
            let _ = writeln!(text, "{}", claim.row());
        }
        let _ = write!(text, "\n{}", shares(finding));
    }
    text
}

/// One row per condition: the verdict in each world, and the ratios of curious over all generated worlds.
fn overview(findings: &[Finding]) -> String {
    let first = findings.first().map_or_else(Vec::new, Finding::claims);
    let worlds = first.iter().map(|claim| claim.world.as_str()).collect::<Vec<_>>().join(" | ");
    let rules = "---|".repeat(first.len() + 4);
    let mut text = format!(
        "\n## All conditions\n\n\
         | condition | {worlds} | {RATIOS}\n|{rules}\n"
    );
    for finding in findings {
        let claims = finding.claims();
        let verdicts = claims.iter().map(|claim| claim.verdict).collect::<Vec<_>>().join(" | ");
        let generated = finding.runs().find(|run| run.worlds > 1);
        let ratios = ["recency", "coin", "poisson"].map(|other| {
            let comparison = generated.and_then(|run| run.comparison("curious", other, Measure::PRIMARY));
            comparison.map_or_else(String::new, |comparison| in_short(&comparison))
        });
        let _ = writeln!(text, "| {} | {verdicts} | {} |", finding.condition.name, ratios.join(" | "));
    }
    text
}

/// The share of time with changing cells in view, and the quality of the map.
fn shares(finding: &Finding) -> String {
    let mut text = format!("{SHARES}\n{}|\n", "|---".repeat(SHARES.matches(" | ").count() + 1));
    for run in finding.runs() {
        for strategy in &run.strategies {
            let last = |metric| strategy.value(Measure::Final(metric));
            let _ = writeln!(
                text,
                "| {} | {} | {:.3} | {:.3} | {:.2} | {:.4} | {:.3} | {:.4} |",
                run.world,
                strategy.name,
                strategy.value(Measure::PRIMARY),
                last(Metric::LogError),
                last(Metric::ChangingShare),
                last(Metric::MapQuality),
                last(Metric::MapQualityChanging),
                last(Metric::Coverage),
            );
        }
    }
    text
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
