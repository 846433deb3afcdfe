//! What it costs to save the state of a run: `cargo run -p curious-evaluation --example state_size -- WORLD.toml MINUTES…`
//!
//! For each number of simulated minutes: how long the loop stops to copy the state (the shortest of many copies, which no
//! other program has interrupted, and the median), how long a thread takes to turn the copy into bytes, and the size per
//! known cell.

use agent::Policy;
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::trial_state::TrialFacts;
use interfaces::CellState;
use robot::state::{SavedSettings, Sessions};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

const SEED: u64 = 100;
const COPIES: usize = 40;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("give a world file and a number of minutes")?;
    let name = Path::new(&path).file_stem().ok_or("give a world file")?.to_string_lossy();
    let spec = worldfile::physics::load_world(Path::new(&path))?;
    let settings = physics_trial::settings(&spec)?;
    let facts = TrialFacts::new(&spec, SEED, &settings, SavedSettings::default());
    let sessions = Sessions::of("trial");
    let pilot = settings.pilot(settings.agent(&Policy::default(), SEED)?, SEED)?;
    let mut trial = PhysicsTrial::new(&spec, SEED, &settings, None, pilot)?;
    for minutes in arguments {
        trial.run(60.0 * minutes.parse::<f64>()?)?;
        let mut copies_ms: Vec<f64> = (0..COPIES)
            .map(|_| {
                let start = Instant::now();
                let copy = trial.snapshot(&facts, &sessions);
                let copy_ms = 1e3 * start.elapsed().as_secs_f64();
                drop(copy);
                copy_ms
            })
            .collect();
        copies_ms.sort_by(f64::total_cmp);
        let copy = trial.snapshot(&facts, &sessions);
        let start = Instant::now();
        let bytes = copy().to_bytes()?;
        let write_ms = 1e3 * start.elapsed().as_secs_f64();
        let known =
            trial.robot.mapper.states().cells().iter().filter(|state| **state != CellState::Unknown).count();
        println!(
            "{name}, {minutes} min: stop {:.1} ms (median {:.1}), bytes {write_ms:.0} ms, {} kB, {:.1} bytes per known cell",
            copies_ms[0],
            copies_ms[COPIES / 2],
            bytes.len() / 1000,
            bytes.len() as f64 / known as f64,
        );
    }
    Ok(())
}
