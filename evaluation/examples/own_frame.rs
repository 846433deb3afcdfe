//! What a robot that is localized loses when its map is not aligned with the walls: false changes and errors of poses.
//!
//! ```text
//! cargo run -p curious-evaluation --example own_frame -- worlds/drifting_house.toml [SEEDS [MINUTES]]
//! ```

use agent::Policy;
use evaluation::metrics::rate_scores;
use evaluation::physics_trial::{self, PhysicsTrial};
use interfaces::{GroundTruth, LaserReading, TrueState};
use mapper::Mapper;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default| arguments.get(index).map_or(Ok(default), |text| text.parse::<u64>());
    let spec =
        worldfile::physics::load_world(arguments.first().ok_or("usage: own_frame WORLD [SEEDS [MINUTES]]")?)?;
    let (first, seeds, minutes) = (number(3, 0)?, number(1, 10)?, number(2, 20)?);
    let settings = physics_trial::settings(&spec)?;
    for seed in first..seeds {
        let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
        let mut trial = PhysicsTrial::new(&spec, seed, &settings, None, pilot)?;
        let mut true_poses = Mapper::new(&settings.mapper, trial.world.spec().frame)?;
        while trial.world.time_s() < minutes as f64 * 60.0 {
            let turn = trial.turn()?;
            true_poses.update(&LaserReading { pose: *trial.world.true_pose(), ..turn.reading })?;
        }
        let truth = trial.world.truth();
        let partly =
            (0..truth.frame().len()).filter(|index| truth.state(*index) == TrueState::PartlyCovered).count();
        let false_changes =
            [&trial.robot.mapper, &true_poses].map(|mapper| rate_scores(mapper, truth).false_change_events);
        let results = trial.results();
        println!(
            "seed {seed}: false changes {false_changes:?} (own, true poses), {partly} cells partly covered of {}; {}",
            truth.frame().len(),
            serde_json::to_string(&results.pose)?
        );
    }
    Ok(())
}
