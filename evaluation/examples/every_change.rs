//! How much the mapper loses by changes that it does not notice: the bound of the rates for the same observations.
//!
//! Two mappers with the same settings learn from one run. The first gets the scans, and the robot drives by its map. The
//! second gets, for every cell that the first observes in a scan, the true state of the cell (a partly covered cell
//! counts as blocked): it misses no change that was shown. A line per world and seed, as CSV: the area under the ROC curve of both
//! maps of rates, the share of the first area in the second, and the log error of both.
//!
//! ```text
//! (echo "# $(git show -s --format='commit %h of %cs'), cargo run -p curious-evaluation --example every_change -- 60 0,1,2 …"
//!  cargo run -p curious-evaluation --example every_change -- 60 0,1,2 house office cave warehouse yard) > docs/results/missed_changes.csv
//! ```

use agent::Policy;
use evaluation::metrics::{RateScores, rate_scores};
use evaluation::physics_trial::{self, PhysicsTrial};
use interfaces::{CellReading, GroundTruth, TrueState};
use mapper::Mapper;
use sim::physics::WorldSpec;
use std::error::Error;

const COLUMNS: &str = "world,seed,rate_auc,bound_rate_auc,share,log_error,bound_log_error";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [minutes, seeds, worlds @ ..] = &arguments[..] else {
        return Err("usage: every_change MINUTES SEED,SEED.. WORLD..".into());
    };
    let duration_s = 60.0 * minutes.parse::<f64>()?;
    println!("{COLUMNS}");
    for world in worlds {
        let spec = worldfile::shipped::load(world)?;
        for seed in seeds.split(',') {
            let [own, bound] = scores(&spec, seed.parse()?, duration_s)?;
            let text = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
            let share = own.rate_auc.zip(bound.rate_auc).map(|(own, bound)| own / bound);
            let scores = [own.rate_auc, bound.rate_auc, share, own.log_error, bound.log_error].map(text);
            println!("{world},{seed},{}", scores.join(","));
        }
    }
    Ok(())
}

/// The scores of the mapper of the robot, and of the one that misses no change that was shown.
fn scores(spec: &WorldSpec, seed: u64, duration_s: f64) -> Result<[RateScores; 2], Box<dyn Error>> {
    let settings = physics_trial::settings(spec)?;
    let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
    let mut trial = PhysicsTrial::new(spec, seed, &settings, None, pilot)?;
    let mut informed = Mapper::new(&settings.mapper, spec.frame)?;
    let frame = spec.frame;
    while trial.robot.mapper.time() < duration_s {
        let reading = trial.turn()?.reading;
        let seen = (0..frame.len()).filter(|&index| trial.robot.mapper.is_in_view(index));
        let is_blocked = |index| trial.world.truth().state(index) != TrueState::Free;
        let cells = seen.map(|index| (frame.cell(index), is_blocked(index))).collect();
        informed.update(&CellReading { time: reading.time_s, pose: reading.pose, cells })?;
    }
    let truth = trial.world.truth();
    Ok([&trial.robot.mapper, &informed].map(|mapper| rate_scores(mapper, truth)))
}
