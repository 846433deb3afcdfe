//! Changes where nothing can have changed: on cells that the laser hit in the first and in the last third of a log.
//!
//! A thing that came and went between counts as well, and so does a person who stood at the same place twice: the figure
//! is an upper bound of the false changes.
//!
//! ```text
//! cargo run -p curious-survey --example static_changes -- LOG
//! ```

use interfaces::PoseMode;
use logs::{Log, TopicChoice};
use mapper::NoReturn;
use std::collections::BTreeSet;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use survey::{LogEntry, Survey, SurveySettings};

fn main() -> Result<(), Box<dyn Error>> {
    let Some(file) = std::env::args().nth(1) else { return Err("usage: static_changes LOG".into()) };
    let log = Log::open(Path::new(&file), &TopicChoice::default())?;
    let mut settings = SurveySettings::of(PoseMode::Localized);
    settings.filter.no_return = NoReturn::Free;
    let max_range_m = settings.filter.max_range_m;
    let mut survey = Survey::new(settings, true);
    let entry = LogEntry::of(file, &log, &TopicChoice::default())?;
    survey.first_pass(&log, entry, false, |_| ControlFlow::Continue(()))?;
    let mut replay = survey.replay(0, &log)?.ok_or("the log has no reading")?;
    while survey.turn(&mut replay)?.is_some() {}
    let mapper = survey.mapper().ok_or("the log has no reading")?;

    let third_s = log.summary().duration_s / 3.0;
    let mut hit = [BTreeSet::new(), BTreeSet::new()];
    // What was hit is judged by the scans as they are: nothing is left out.
    for (reading, found) in log.readings()?.zip(survey.logs()[0].route()) {
        let reading = reading?;
        let part = match reading.time_s {
            time_s if time_s < third_s => 0,
            time_s if time_s > 2.0 * third_s => 1,
            _ => continue,
        };
        let cells = reading.hits().filter(|at| at.coords.norm() < max_range_m);
        hit[part]
            .extend(cells.filter_map(|at| mapper.frame().index(mapper.frame().cell_at(&(found.pose * at)))));
    }

    let scans = survey.logs()[0].readings;
    let events = |index: usize| u64::from(mapper.statistics(index).events());
    let static_cells = hit[0].intersection(&hit[1]);
    let changes: u64 = static_cells.clone().map(|index| events(*index)).sum();
    let all: u64 = mapper.changed().map(events).sum();
    println!(
        "noise {:.3} m, {scans} scans, {all} changes of cells",
        survey.settings_of(0).mapper.steady.range_noise_std_m
    );
    println!(
        "{changes} changes on {} static cells: {:.1} per 1000 scans",
        static_cells.count(),
        changes as f64 * 1000.0 / scans as f64
    );
    Ok(())
}
