//! A simulated world as a robot of ROS 2.

use anyhow::{Context, anyhow};
use clap::Parser;
use cli::flags::number;
use cli::program::{Failure, duration_s, input, interrupt_flag};
use ros2::node_program::{note_unused_files, say, start};
use ros2::{
    DdsLink, Environment, Given, Guard, Names, RosArgs, SimulatedRobot, SimulationSettings, simulation_wiring,
};
use std::process::ExitCode;
use std::time::{SystemTime, UNIX_EPOCH};

/// Simulates a robot of ROS 2 in one of this project's worlds
///
/// The node needs no installation of ROS. The driven robot of the world publishes scans, odometry and transforms, and obeys
/// velocities; doors, things and other robots of the world move by themselves.
#[derive(Debug, Parser)]
#[command(name = "sim_node", version, after_long_help = MANUAL, max_term_width = 100)]
struct Args {
    /// A world that ships, or a world file
    #[arg(value_name = "WORLD", default_value = "four_rooms")]
    world: String,
    /// The seed of everything random
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// The simulated time per real time
    #[arg(long, default_value_t = 1.0, value_parser = number(0.01..=1000.0), allow_negative_numbers = true)]
    speed: f64,
    /// Ends after this simulated time: seconds, or with a unit as in 90s, 20m, 1h [default: at Ctrl-C]
    #[arg(long, value_name = "TIME", value_parser = duration_s, allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Times are those of the wall clock at the start, and not from 10 s on: for nodes without use_sim_time; for speed 1
    #[arg(long)]
    wall_time: bool,
}

const MANUAL: &str = "\
SUBSCRIBES
  cmd_vel       geometry_msgs/TwistStamped or geometry_msgs/Twist, as others publish it; the robot stops 0.5 s after the last one

PUBLISHES
  scan          sensor_msgs/LaserScan in the frame laser
  odom          nav_msgs/Odometry from odom to base_link, at most 50 Hz, with the errors of the world file
  ground_truth  nav_msgs/Odometry from world to base_link: the true pose
  /tf           odom to base_link
  /tf_static    base_link to laser
  /clock        rosgraph_msgs/Clock

ENVIRONMENT
  ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_LOCALHOST_ONLY

EXAMPLES
  sim_node house --speed 5
  sim_node worlds/office.toml --ros-args -r __ns:=/robot1

EXIT CODES
  0 ended by Ctrl-C, or by --duration; 1 the node failed; 2 an argument or the world is not valid";

/// The simulation takes less than a hundredth of it: what the network may fill.
const MAX_MEMORY_MIB: f64 = 1024.0;

fn main() -> ExitCode {
    start(run)
}

fn run(args: &Args, ros: RosArgs) -> Result<ExitCode, Failure> {
    let names = Names::new("sim_node", &ros).map_err(input)?;
    let is_unknown = |given: &&Given| given.name != "use_sim_time" && !given.is_for_others_too();
    if let Some(Given { name, .. }) = ros.parameters_of(&names.full_name()).find(is_unknown) {
        return Err(input(anyhow!("there is no parameter `{name}`: sim_node has options, see --help")));
    }
    note_unused_files(&names, &ros);
    let world = worldfile::shipped::load(&args.world).map_err(input)?;
    let environment = Environment::read(|name| Some(std::env::var_os(name)?.to_string_lossy().into_owned()))
        .map_err(input)?;
    let wiring = simulation_wiring(&names, &ros).map_err(input)?;
    let stop = interrupt_flag()?;
    let link = DdsLink::open(&wiring, &environment)?;
    let guard = Guard::start(stop.clone(), MAX_MEMORY_MIB).context("cannot watch the network")?;
    let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let begin_ns = if args.wall_time { i64::try_from(since_epoch.as_nanos()).unwrap_or(0) } else { 0 };
    let settings = SimulationSettings { seed: args.seed, speed: args.speed, begin_ns };
    let mut robot = SimulatedRobot::new(link, &world, settings);
    say(&format!("[{}] {}: {:.0} times real time", names.node, world.name, args.speed));
    let scans = robot.run(&stop, args.duration.unwrap_or(f64::INFINITY));
    guard.check()?;
    say(&format!("[{}] {scans} scans in {:.1} s", names.node, robot.time_s()));
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_flag_refuses_a_wrong_value_by_its_name() {
        let wrong = [("seed", "-1"), ("speed", "0"), ("duration", "-1")];
        for argument in
            Args::command().get_arguments().filter(|argument| argument.get_action().takes_values())
        {
            let Some(flag) = argument.get_long() else { continue };
            let (_, value) =
                wrong.iter().find(|(known, _)| *known == flag).unwrap_or_else(|| panic!("--{flag}"));
            let error = Args::try_parse_from(["sim_node", &format!("--{flag}"), value]).unwrap_err();
            assert!(error.exit_code() == 2 && error.to_string().contains(&format!("--{flag} ")), "{error}");
        }
    }
}
