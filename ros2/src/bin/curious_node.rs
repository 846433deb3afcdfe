//! Maps what a live robot sees, and where the place changes; can explore.

use agent::Policy;
use anyhow::Context;
use clap::Parser;
use clap::builder::{PossibleValue, PossibleValuesParser};
use cli::flags::output_file;
use cli::program::{Failure, input, interrupt_flag};
use ros2::node_program::{note_unused_files, output, say, start};
use ros2::{
    CuriousNode, DdsLink, Environment, Guard, Names, Parameters, RosArgs, ScanCount, Service, Signals, Topic,
    Value, curious_wiring,
};
use std::path::PathBuf;
use std::process::ExitCode;

/// Maps what a live robot of ROS 2 sees, and learns where and how often the place changes
///
/// The node needs no installation of ROS. It subscribes to scans, transforms and odometry, and publishes the map, the map of
/// changes, the prediction, and the transform from the map to the odometry. With `--mode explore` it also drives the robot.
#[derive(Debug, Parser)]
#[command(name = "curious_node", version, after_long_help = manual(), max_term_width = 100)]
struct Args {
    /// What the node does; the same as `--ros-args -p mode:=MODE`
    ///
    /// map: only maps, while someone else drives; explore: drives to where looking is worth most
    #[arg(long, value_parser = ["map", "explore"])]
    mode: Option<String>,
    /// With the mode explore, where the robot goes; the same as `--ros-args -p strategy:=STRATEGY`
    #[arg(long, value_parser = strategies())]
    strategy: Option<String>,
    /// Goes on from this file if it exists, and saves to it: every minute, at the end, at the signal USR1, and when the
    /// service `~/save_state` is called
    #[arg(long, value_name = "FILE", value_parser = output_file())]
    state: Option<PathBuf>,
}

fn strategies() -> PossibleValuesParser {
    let value = |policy: &Policy| PossibleValue::new(policy.name()).help(policy.description());
    PossibleValuesParser::new(Policy::built_in().iter().map(value))
}

/// Topics, services, parameters, and more.
fn manual() -> String {
    let row = |name: &str, (package, kind): (&str, &str), more: &str| {
        format!("  {name:<28}{package}/{kind}{}{more}\n", if more.is_empty() { "" } else { ", " })
    };
    let topics = Topic::all().filter(|topic| !topic.direction().is_empty());
    let topics = topics.map(|topic| row(topic.default_name(), topic.type_name(), topic.direction()));
    let services = Service::all().map(|service| row(service.default_name(), service.type_name(), ""));
    format!(
        "TOPICS (docs/robots.md says what they mean; the parameters scan_topic and odom_topic name two of them)\n{}\n\
         SERVICES, beside clients of navigate_to_pose (navigator:=nav2) and route_edges_service (route_graph)\n{}\n{REST}",
        topics.collect::<String>(),
        services.collect::<String>(),
    )
}

const REST: &str = concat!(
    "\
PARAMETERS (--ros-args -p name:=value, or --params-file FILE with a file like this one, which has the defaults)
",
    include_str!("../../config/params.yaml"),
    "
ENVIRONMENT
  ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_LOCALHOST_ONLY
  RMW_IMPLEMENTATION      rmw_cyclonedds_cpp: services and actions are those of nodes with CycloneDDS

EXAMPLES
  curious_node --state office.state
  curious_node --mode explore --strategy fresh-map --state office.state
  curious_node --mode explore --ros-args -p robot_radius:=0.18 -p max_vel_x:=0.5 -r scan:=/front/scan
  curious_node --mode explore --ros-args -p navigator:=nav2 -r __ns:=/robot1
  curious_node --ros-args --params-file mapping.yaml

EXIT CODES
  0 ended by Ctrl-C, SIGTERM or SIGHUP; 1 the node failed; 2 an argument or the state file is not valid"
);

fn main() -> ExitCode {
    start(run)
}

fn run(args: &Args, ros: RosArgs) -> Result<ExitCode, Failure> {
    let names = Names::new("curious_node", &ros).map_err(input)?;
    let mut parameters = Parameters::default();
    parameters.set_all(ros.parameters_of(&names.full_name())).map_err(input)?;
    note_unused_files(&names, &ros);
    for (name, value) in [("mode", &args.mode), ("strategy", &args.strategy)] {
        value
            .iter()
            .try_for_each(|value| parameters.set(name, &Value::Text(value.clone())))
            .map_err(input)?;
    }
    parameters.check().map_err(input)?;
    let environment = Environment::read(|name| Some(std::env::var_os(name)?.to_string_lossy().into_owned()))
        .map_err(input)?;
    let wiring = curious_wiring(&parameters, &names, &ros).map_err(input)?;
    let signals = Signals { stop: interrupt_flag()?, ..Signals::default() };
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGUSR1, signals.save.clone())
        .context("cannot listen for SIGUSR1")?;
    let link = DdsLink::open(&wiring, &environment)?;
    let guard = Guard::start(signals.stop.clone(), parameters.memory_limit_mib)
        .context("cannot watch the network")?;
    let node = CuriousNode::new(link, &parameters, args.state.as_deref(), output(&names.node));
    let mut node = node.map_err(input)?;
    say(&format!("[{}] waiting for scans on {}", names.node, parameters.scan_topic));
    let report = node.run(&signals)?;
    guard.check()?;
    let ScanCount { received, invalid, unplaced, late, other } = report.scans;
    say(&format!(
        "[{}] {received} scans: {} readings, {} in the map; {invalid} not valid, {unplaced} without a pose, {late} late, {other} of \
         another laser; longest turn {:.1} ms",
        names.node,
        report.readings,
        report.mapped,
        report.longest_us as f64 * 1e-3
    ));
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_flag_refuses_a_wrong_value_by_its_name() {
        let wrong = [("mode", "sleep"), ("strategy", "fame"), ("state", "/")];
        for argument in
            Args::command().get_arguments().filter(|argument| argument.get_action().takes_values())
        {
            let Some(flag) = argument.get_long() else { continue };
            let (_, value) =
                wrong.iter().find(|(known, _)| *known == flag).unwrap_or_else(|| panic!("--{flag}"));
            let error = Args::try_parse_from(["curious_node", &format!("--{flag}"), value]).unwrap_err();
            assert!(error.exit_code() == 2 && error.to_string().contains(&format!("--{flag} ")), "{error}");
        }
    }
}
