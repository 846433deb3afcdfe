//! One number for a minute in a world in which everything moves, to compare builds and machines: `cargo run -p
//! worldfile --example golden -- [THREADS]`.

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
    println!("{:016x}", hash(&fleet));
    Ok(())
}

/// FNV-1a of every bit of the poses, velocities and readings of the robots, and of the obstacles. The format of
/// snapshots does not matter.
fn hash(fleet: &Fleet) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut eat = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x0100_0000_01b3);
    for robot in fleet.robots() {
        let (at, rotation) = (robot.pose.translation.vector, robot.pose.rotation);
        let velocity = [robot.twist.linear_mps, robot.left_mps, robot.twist.angular_radps];
        for value in [at.x, at.y, rotation.re, rotation.im].into_iter().chain(velocity) {
            eat(value.to_bits());
        }
        for reading in robot.lasers().flatten() {
            let (at, rotation) = (reading.pose.translation.vector, reading.pose.rotation);
            for value in [reading.time_s, at.x, at.y, rotation.re, rotation.im] {
                eat(value.to_bits());
            }
            reading.scan.ranges_m.iter().for_each(|range_m| eat(u64::from(range_m.to_bits())));
        }
        for reading in robot.sonars().flatten() {
            eat(reading.time_s.to_bits());
            eat(u64::from(reading.range_m.to_bits()));
        }
        robot.bumpers().for_each(|is_pressed| eat(u64::from(is_pressed)));
    }
    for corner in fleet.obstacles().flat_map(|obstacle| obstacle.corners) {
        eat(corner.x.to_bits());
        eat(corner.y.to_bits());
    }
    hash
}
