//! Does the paper's claim hold? The tables and figures of docs/figure3.md.
//!
//! ```text
//! cargo run --example paper_claim                     everything, a quarter of an hour on two cores
//! cargo run --example paper_claim -- quick 5          into another folder, with fewer seeds
//! ```
//!
//! Each condition changes one setting. It runs in the shipped worlds, with N seeds in each, and in N generated
//! worlds, each with its own seed.

mod claim;
mod condition;
mod forest;
mod tables;

use anyhow::Context;
use claim::Claim;
use condition::{BASE, Condition, conditions};
use files::{RunFolder, make_folder, write_file};
use reports::{Report, Run};
use std::path::{Path, PathBuf};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/figure3");
const SEEDS: u64 = 50;

/// The results of one condition.
struct Finding {
    condition: Condition,
    /// The runs in the shipped worlds.
    shipped: Report,
    /// The run over all generated worlds.
    generated: Report,
}

impl Finding {
    /// The runs with a verdict: every shipped world, then all generated worlds as one.
    fn runs(&self) -> impl Iterator<Item = &Run> {
        let shipped = self.shipped.runs.iter().filter(|run| run.worlds == 1);
        shipped.chain(self.generated.runs.iter().filter(|run| run.worlds > 1))
    }

    fn claims(&self) -> Vec<Claim> {
        self.runs().filter_map(Claim::of).collect()
    }
}

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or(FOLDER.to_owned()));
    let seeds = arguments.next().map_or(Ok(SEEDS), |seeds| seeds.parse()).context("the number of seeds")?;
    make_folder(&folder)?;
    let mut findings = Vec::new();
    for condition in conditions() {
        eprintln!("{}", condition.name);
        let (shipped, generated) = condition.run(seeds)?;
        findings.push(Finding { condition, shipped, generated });
    }
    forest::draw(&findings, &folder.join("claim.svg"))?;
    figures(&findings, &folder)?;
    write_file(&folder.join("results.md"), |file| {
        file.write_all(tables::markdown(&findings, seeds).as_bytes())
    })?;
    Ok(())
}

/// The curves of the first condition, in the paper's form.
fn figures(findings: &[Finding], folder: &Path) -> anyhow::Result<()> {
    let base = findings.iter().find(|finding| finding.condition.name == BASE).context("no base")?;
    for (report, name) in [(&base.shipped, "two_blocks"), (&base.generated, "generated")] {
        let out = tempfile::tempdir()?;
        let run = RunFolder::open(out.path())?;
        report.write(&run, &condition::shipped())?;
        run.finish(&[])?;
        let figure = "figure3.svg";
        let from = out.path().join(figure);
        let text = std::fs::read(&from).with_context(|| format!("there is no {}", from.display()))?;
        write_file(&folder.join(format!("{name}.svg")), |file| file.write_all(&text))?;
    }
    Ok(())
}
