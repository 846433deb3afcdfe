//! The tables of the pages that are laid out on the page and filled from files of results (`reports::pages::layout`).
//!
//! ```sh
//! cargo run -p curious-reports --example page_tables -- docs/*.md     # makes the tables anew
//! ```

use anyhow::Context;
use clap::Parser;
use reports::pages::{PageError, Rows, layout, with_tables};
use std::path::{Path, PathBuf};

/// Tables of pages.
#[derive(Parser)]
struct Args {
    /// The pages whose tables are made anew
    #[arg(required = true)]
    pages: Vec<PathBuf>,
}

fn main() -> anyhow::Result<()> {
    for path in &Args::parse().pages {
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

#[cfg(test)]
#[path = "page_tables/tests.rs"]
mod tests;
