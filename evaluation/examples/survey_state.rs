//! What it costs to save what was learned from a log: `cargo run -p curious-evaluation --example survey_state -- LOG`
//!
//! How long the loop of `map_log` stops to copy the state (the shortest of many copies, which no other program has
//! interrupted, and the median), how long a thread takes to turn the copy into bytes, and the size per known cell: with the
//! poses of the log, as within it, and without them, as after it.

use interfaces::{CellState, PoseMode};
use logs::{Log, TopicChoice};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;
use survey::{LogEntry, Survey, SurveySettings};

const COPIES: usize = 40;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: survey_state LOG")?;
    let log = Log::open(Path::new(&file), &TopicChoice::default())?;
    let pose = if log.summary().stands { PoseMode::Exact } else { PoseMode::Localized };
    let mut survey = Survey::new(SurveySettings::of(pose), true);
    let entry = LogEntry::of(file.clone(), &log, &TopicChoice::default())?;
    survey.first_pass(&log, entry, true, |_| ControlFlow::Continue(()))?;
    let mut replay = survey.replay(0, &log)?.ok_or("the log has no reading")?;
    let readings = log.summary().scans;
    // As in the middle of the log: what was copied before is still shared.
    for _ in 0..readings / 2 {
        survey.turn(&mut replay)?;
    }
    let earlier = survey.saved();
    while survey.turn(&mut replay)?.is_some() {}
    drop(earlier);

    let mut copies_ms: Vec<f64> = (0..COPIES)
        .map(|_| {
            let start = Instant::now();
            let copy = survey.saved();
            let copy_ms = 1e3 * start.elapsed().as_secs_f64();
            drop(copy);
            copy_ms
        })
        .collect();
    copies_ms.sort_by(f64::total_cmp);
    let mapper = survey.mapper().ok_or("the log has no reading")?;
    let known = mapper.states().cells().iter().filter(|state| **state != CellState::Unknown).count();
    let cells = mapper.frame().len();
    println!(
        "{readings} scans, {known} known cells of {cells}: stop {:.1} ms (median {:.1})",
        copies_ms[0],
        copies_ms[COPIES / 2]
    );
    for what in ["with", "without"] {
        let start = Instant::now();
        let state = survey.saved()();
        let bytes = state.to_bytes()?.len();
        println!(
            "  {what} poses: bytes {:.0} ms, {} kB, {:.1} bytes per known cell",
            1e3 * start.elapsed().as_secs_f64(),
            bytes / 1000,
            bytes as f64 / known as f64
        );
        survey.forget_poses();
    }
    Ok(())
}
