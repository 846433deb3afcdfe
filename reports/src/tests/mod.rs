mod figures;
mod files;
mod runs;
mod statistics;
mod table;

use super::*;
use evaluation::trials::{Metric, Sample};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use sim::grid::GridSpec;
pub(crate) mod synthetic;

use synthetic::{HORIZON, experiment, normal, uniform, world};

fn report(worlds: usize, estimators: &[&str], strategies: &[&str], seeds: u64) -> Report {
    let (settings, trials) = experiment(worlds, estimators, strategies, seeds);
    Report::new(settings, trials)
}

/// All that a report writes, as names and contents: `report.json`, and the other files by name.
fn written(report: &Report) -> Vec<(String, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    let folder = RunFolder::open(folder.path()).unwrap();
    let worlds: Vec<GridSpec> = (0..3).map(world).collect();
    let names = report.write(&folder, &worlds).unwrap();
    let content = |name: &String| std::fs::read(folder.unfinished().join(name)).unwrap();
    names.iter().map(|name| (name.clone(), content(name))).collect()
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} is not {b} ± {tolerance}");
}
