//! Maps what a live robot sees, and where the place changes; can explore.

use agent::PURPOSES;
use anyhow::Context;
use clap::Parser;
use clap::builder::{PossibleValue, PossibleValuesParser};
use cli::flags::output_file;
use cli::program::{Failure, input, interrupt_flag};
use ros2::node_program::{note_unused_files, output, say, start};
use ros2::{
    CuriousNode, DdsLink, Environment, Names, Parameters, RosArgs, ScanCount, Signals, Value, curious_wiring,
};
use std::path::PathBuf;
use std::process::ExitCode;

/// Maps what a live robot of ROS 2 sees, and learns where and how often the place changes
///
/// The node needs no installation of ROS. It subscribes to scans, transforms and odometry, and publishes the map, the map of
/// changes, the prediction, and the transform from the map to the odometry. With `--mode explore` it also drives the robot.
#[derive(Debug, Parser)]
#[command(name = "curious_node", version, after_long_help = MANUAL, max_term_width = 100)]
struct Args {
    /// What the node does; the same as `--ros-args -p mode:=MODE`
    ///
    /// map: only maps, while someone else drives; explore: drives to where looking is worth most
    #[arg(long, value_parser = ["map", "explore"])]
    mode: Option<String>,
    /// With the mode explore, what the robot explores for; the same as `--ros-args -p purpose:=PURPOSE`
    ///
    /// It names the strategy that was best for it in our trials, where no parameter `strategy` is given.
    #[arg(long, value_parser = purposes())]
    purpose: Option<String>,
    /// Goes on from this file if it exists, and saves to it: every minute, at the end, at the signal USR1, and when the
    /// service `~/save_state` is called
    #[arg(long, value_name = "FILE", value_parser = output_file())]
    state: Option<PathBuf>,
    /// Corrected maps replace the old one with these readings, as an earlier run of the same readings has printed: repeats
    /// that run
    #[arg(long, value_name = "READINGS", value_delimiter = ',')]
    switch_at: Vec<usize>,
}

fn purposes() -> PossibleValuesParser {
    PossibleValuesParser::new(
        PURPOSES.map(|[name, description, policy]| {
            PossibleValue::new(name).help(format!("{description}: {policy}"))
        }),
    )
}

const MANUAL: &str = concat!(
    "\
SUBSCRIBES
  scan_topic (/scan)      sensor_msgs/LaserScan, sensor-data QoS
  /tf, /tf_static         tf2_msgs/TFMessage: odom_frame to base_frame, base_frame to the laser
  odom_topic (odom)       nav_msgs/Odometry: used if /tf has no odometry
  initialpose             geometry_msgs/PoseWithCovarianceStamped in map_frame: where the robot is
  explore/resume          std_msgs/Bool: false pauses exploring, true resumes it

PUBLISHES
  map                     nav_msgs/OccupancyGrid: -1, 0, 100; reliable, transient local
  map_updates             map_msgs/OccupancyGridUpdate: what changed, at once
  change_map              nav_msgs/OccupancyGrid: 0 to 100, where the place changes within change_horizon
  predicted_map           nav_msgs/OccupancyGrid: 0 to 100, where it is probably blocked after prediction_horizon
  rate_map                nav_msgs/OccupancyGrid: cycles per hour, at most 100
  expiry_map              nav_msgs/OccupancyGrid: for how long a look is worth something, minutes, at most 100
  speed_mask, keepout_mask
                          nav_msgs/OccupancyGrid: for the costmap filters of Nav2, every mask_update_interval
  speed_filter_info, keepout_filter_info
                          nav2_msgs/CostmapFilterInfo: what the values of the masks mean
  pose                    geometry_msgs/PoseWithCovarianceStamped: the robot in the map
  /diagnostics            diagnostic_msgs/DiagnosticArray: tracking, uncertain or lost; scans left out; once per second
  /rosout                 rcl_interfaces/Log: what the node prints
  /parameter_events       rcl_interfaces/ParameterEvent
  ~/transition_event      lifecycle_msgs/TransitionEvent
  /tf                     tf2_msgs/TFMessage: map_frame to odom_frame
  cmd_vel                 geometry_msgs/TwistStamped, or Twist with enable_stamped_cmd_vel:=false
  goal_pose               geometry_msgs/PoseStamped, with navigator:=goal_pose
  explore/path            nav_msgs/Path: the path to the goal

SERVICES AND ACTIONS
  ~/save_state            std_srvs/Trigger: saves the state
  ~/save_map              slam_toolbox/SaveMap: NAME.pgm and NAME.yaml for the map server
  ~/serialize_map, ~/deserialize_map
                          slam_toolbox/SerializePoseGraph, DeserializePoseGraph: writes and loads a state
  ~/change_state, ~/get_state, ~/get_available_states, ~/get_available_transitions, ~/get_transition_graph
                          lifecycle_msgs: the managed lifecycle
  ~/get_parameters, ~/set_parameters, ~/set_parameters_atomically, ~/list_parameters, ~/describe_parameters,
  ~/get_parameter_types   rcl_interfaces
  route_edges_service     nav2_msgs/DynamicEdges, with route_graph: a client
  navigate_to_pose        nav2_msgs/NavigateToPose, with navigator:=nav2: a client

PARAMETERS (--ros-args -p name:=value, or --params-file FILE with a file like this one, which has the defaults)
",
    include_str!("../../config/params.yaml"),
    "
ENVIRONMENT
  ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_LOCALHOST_ONLY
  RMW_IMPLEMENTATION      rmw_cyclonedds_cpp: services and actions are those of nodes with CycloneDDS

EXAMPLES
  curious_node --state office.state
  curious_node --mode explore --purpose fresh-map --state office.state
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
    for (name, value) in [("mode", &args.mode), ("purpose", &args.purpose)] {
        value
            .iter()
            .try_for_each(|value| parameters.set(name, &Value::Text(value.clone())))
            .map_err(input)?;
    }
    parameters.switch_at.clone_from(&args.switch_at);
    parameters.check().map_err(input)?;
    let environment = Environment::read(|name| std::env::var(name).ok()).map_err(input)?;
    let wiring = curious_wiring(&parameters, &names, &ros).map_err(input)?;
    let signals = Signals { stop: interrupt_flag()?, ..Signals::default() };
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGUSR1, signals.save.clone())
        .context("cannot listen for SIGUSR1")?;
    let link = DdsLink::open(&wiring, &environment)?;
    let node = CuriousNode::new(link, &parameters, args.state.as_deref(), output(names.node()));
    let mut node = node.map_err(input)?;
    say(&format!("[{}] waiting for scans on {}", names.node(), parameters.scan_topic));
    let report = node.run(&signals)?;
    let ScanCount { received, invalid, unplaced, late, other } = report.scans;
    say(&format!(
        "[{}] {received} scans: {} readings, {} in the map; {invalid} not valid, {unplaced} without a pose, {late} late, {other} of \
         another laser; longest turn {:.1} ms",
        names.node(),
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
        let wrong = [("mode", "sleep"), ("purpose", "fame"), ("state", "/"), ("switch-at", "-")];
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
