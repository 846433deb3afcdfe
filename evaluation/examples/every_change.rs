//! How much the mapper loses by changes that it does not notice: the bound of the rates for the same observations.
//!
//! Two mappers with the same settings learn from one run. The first gets the scans, and the robot drives by its map. The
//! second gets, for every cell that the first observes in a scan, the true state of the cell (a partly covered cell
//! counts as blocked): it misses no change that was shown. Printed: the area under the ROC curve of both maps of rates,
//! the log error of both, and the quotient of the areas.
//!
//! ```text
//! cargo run -p curious-evaluation --example every_change -- worlds/office.toml [SEED [MINUTES]]
//! ```

use agent::Policy;
use evaluation::metrics::rate_scores;
use evaluation::physics_trial::{self, PhysicsTrial};
use interfaces::{CellReading, GroundTruth, TrueState};
use mapper::Mapper;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default| arguments.get(index).map_or(Ok(default), |text| text.parse::<u64>());
    let Some(path) = arguments.first() else {
        return Err("usage: every_change WORLD [SEED [MINUTES]]".into());
    };
    let (seed, minutes) = (number(1, 100)?, number(2, 60)?);

    let spec = worldfile::physics::load_world(path)?;
    let settings = physics_trial::settings(&spec)?;
    let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
    let mut trial = PhysicsTrial::new(&spec, seed, &settings, None, pilot)?;
    let mut informed = Mapper::new(&settings.mapper, spec.frame)?;
    let frame = spec.frame;
    while trial.robot.mapper.time() < minutes as f64 * 60.0 {
        let reading = trial.turn()?.reading;
        let seen = (0..frame.len()).filter(|&index| trial.robot.mapper.is_in_view(index));
        let is_blocked = |index| trial.world.truth().state(index) != TrueState::Free;
        let cells = seen.map(|index| (frame.cell(index), is_blocked(index))).collect();
        informed.update(&CellReading { time: reading.time_s, pose: reading.pose, cells })?;
    }

    let truth = trial.world.truth();
    let [noticed, bound] = [&trial.robot.mapper, &informed].map(|mapper| rate_scores(mapper, truth));
    let text = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"));
    println!("{path}, seed {seed}, {minutes} min: noticed / every shown change");
    println!("rate AUC   {} / {}", text(noticed.rate_auc), text(bound.rate_auc));
    println!("log error  {} / {}", text(noticed.log_error), text(bound.log_error));
    if let (Some(noticed), Some(bound)) = (noticed.rate_auc, bound.rate_auc) {
        println!("share of the bound: {:.1} %", noticed / bound * 100.0);
    }
    Ok(())
}
