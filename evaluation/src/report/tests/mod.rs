mod claim;
mod figures;
mod files;
mod runs;
mod statistics;

use super::synthetic::{HORIZON, experiment, normal, uniform, world};
use super::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

fn report(worlds: usize, estimators: &[&str], strategies: &[&str], seeds: u64) -> Report {
    let (settings, trials) = experiment(worlds, estimators, strategies, seeds);
    Report::new(settings, trials)
}

/// All that a report writes, as names and contents.
fn written(report: &Report) -> Vec<(String, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    let worlds: Vec<GridSpec> = (0..3).map(world).collect();
    let files = report.write(folder.path(), &worlds).unwrap();
    let name = |file: &PathBuf| file.file_name().unwrap().to_str().unwrap().to_owned();
    files.iter().map(|file| (name(file), std::fs::read(file).unwrap())).collect()
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} is not {b} ± {tolerance}");
}
