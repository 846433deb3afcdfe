//! The tables of the pages that are laid out on the page and filled from files of results (`reports::pages::layout`), and the
//! files of those results that are taken from other files.
//!
//! ```sh
//! cargo run -p curious-reports --example page_tables -- docs/*.md     # makes the tables anew
//! cargo run -p curious-reports --example page_tables -- --rows docs/results/drifting_house.csv --keys /world,/seed,/pose/max_m \
//!   --summary results/*/summary.json
//! ```

use anyhow::{Context, ensure};
use clap::Parser;
use reports::pages::{PageError, Rows, commit, layout, with_tables};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Tables of pages.
#[derive(Parser)]
struct Args {
    /// The pages whose tables are made anew
    pages: Vec<PathBuf>,
    /// The file for the rows of --summary
    #[arg(long, value_name = "FILE", requires = "summary")]
    rows: Option<PathBuf>,
    /// The summary.json files of runs: a row each
    #[arg(long, value_name = "SUMMARY", num_args = 1.., requires = "keys")]
    summary: Vec<PathBuf>,
    /// The columns of --summary: places in summary.json
    #[arg(long, value_name = "KEY", value_delimiter = ',')]
    keys: Vec<String>,
    /// The command that made the runs of --summary
    #[arg(long, default_value = "four_rooms")]
    command: String,
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    if let Some(path) = &args.rows {
        std::fs::write(path, of_summaries(&args)?)?;
    }
    for path in &args.pages {
        let page =
            std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        let made = rewritten(&page).with_context(|| path.display().to_string())?;
        if made != page {
            std::fs::write(path, made)?;
        }
    }
    Ok(())
}

/// A page with its tables made anew.
fn rewritten(page: &str) -> Result<String, PageError> {
    with_tables(page, "rows", |layout| layout::table(layout, read))
}

/// The tables of a source: a CSV file, or a Markdown file and a heading in it.
fn read(source: &str) -> Result<Vec<Rows>, String> {
    let (file, heading) = source.split_once('#').unwrap_or((source, ""));
    let text = std::fs::read_to_string(root().join(file)).map_err(|why| format!("{file}: {why}"))?;
    if heading.is_empty() { Ok(vec![Rows::of_csv(&text)?]) } else { Ok(Rows::of_markdown(&text, heading)) }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// CSV with the values of runs.
fn of_summaries(args: &Args) -> anyhow::Result<String> {
    let mut text = format!("# {}, {}\n{}\n", commit(), args.command, args.keys.join(","));
    for path in &args.summary {
        let run = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        let run: Value = serde_json::from_str(&run).with_context(|| path.display().to_string())?;
        let value = |key: &String| match run.pointer(key) {
            Some(Value::String(text)) => text.clone(),
            Some(Value::Null) | None => String::new(),
            Some(other) => other.to_string(),
        };
        let values: Vec<String> = args.keys.iter().map(value).collect();
        ensure!(
            values.iter().all(|value| !value.contains([',', '"', '\n'])),
            "{}: a value has a comma",
            path.display()
        );
        text += &(values.join(",") + "\n");
    }
    Ok(text)
}

#[cfg(test)]
#[path = "page_tables/tests.rs"]
mod tests;
