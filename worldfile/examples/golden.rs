//! One number for a minute in a place where everything moves, to compare builds and machines by:
//! `cargo run -p worldfile --example golden -- [THREADS]`.

use interfaces::{LaserReading, Twist};
use sim::physics::{Fleet, RobotView};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let threads = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let spec = worldfile::physics::parse_fleet("yard.toml", include_str!("../../worlds/yard.toml"))?;
    let mut fleet = Fleet::new(&spec, 7);
    fleet.set_parallel_lasers(threads > 1);
    let mut ahead = |_: &RobotView<'_>, _: &LaserReading| Twist { linear_mps: 0.3, angular_radps: 0.2 };
    pool.install(|| fleet.run_until(60.0, &mut ahead));
    // FNV-1a of all bytes of the state.
    let eat = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    println!("{:016x}", fleet.snapshot().iter().fold(0xcbf2_9ce4_8422_2325, eat));
    Ok(())
}
