//! Which topics the nodes have, and how these are named.

use crate::link::Wiring;
use crate::message::{Quality, Topic};
use crate::names::Names;
use crate::parameters::{Mode, Navigator, Parameters};
use crate::ros_args::RosArgs;
use crate::service::Service;

/// Scans that wait for the node: a node that saves its state must not lose one.
const SCANS: usize = 100;

/// The topics and services of the mapping node.
///
/// # Errors
///
/// When a name is not valid.
pub fn curious_wiring(parameters: &Parameters, names: &Names, ros: &RosArgs) -> anyhow::Result<Wiring> {
    let explores = parameters.mode == Mode::Explore;
    let drives_by = |navigator| explores && parameters.navigator == navigator;
    let is_on = |topic: &Topic| match topic {
        Topic::SpeedMask | Topic::KeepoutMask | Topic::SpeedFilterInfo | Topic::KeepoutFilterInfo => {
            parameters.mask_update_interval_s > 0.0
        }
        Topic::Resume | Topic::Path => explores,
        Topic::StampedVelocity => drives_by(Navigator::CmdVel) && parameters.enable_stamped_cmd_vel,
        Topic::Velocity => drives_by(Navigator::CmdVel) && !parameters.enable_stamped_cmd_vel,
        Topic::GoalPose => drives_by(Navigator::GoalPose),
        _ => true,
    };
    let [subscribed, published] = ["in", "out"].map(|direction| {
        let topics = Topic::all().filter(|topic| topic.direction().contains(direction));
        topics.filter(is_on).collect::<Vec<_>>()
    });
    let resolved = |kind, name| names.resolved(kind, name, ros);
    let navigate_to_pose = drives_by(Navigator::Nav2).then(|| resolved("action", "navigate_to_pose"));
    let has_routes = !parameters.route_graph.is_empty();
    let adjust_edges = has_routes.then(|| resolved("service", &parameters.route_edges_service));
    let scan = Quality {
        is_reliable: parameters.scan_reliability == "reliable",
        depth: SCANS,
        ..Topic::Scan.quality()
    };
    let name = |topic: Topic| match topic {
        Topic::Scan => &parameters.scan_topic,
        Topic::Odometry => &parameters.odom_topic,
        _ => topic.default_name(),
    };
    let services = Service::all().map(|service| Ok((service, resolved("service", service.default_name())?)));
    Ok(Wiring {
        services: services.collect::<anyhow::Result<_>>()?,
        navigate_to_pose: navigate_to_pose.transpose()?,
        adjust_edges: adjust_edges.transpose()?,
        ..wiring(names, ros, [&subscribed, &published], scan, name)?
    })
}

/// The topics of the simulated robot.
///
/// # Errors
///
/// When a name is not valid.
pub fn simulation_wiring(names: &Names, ros: &RosArgs) -> anyhow::Result<Wiring> {
    let subscribed = [Topic::Velocity, Topic::StampedVelocity];
    let published = [
        Topic::Scan,
        Topic::Odometry,
        Topic::Transforms,
        Topic::StaticTransforms,
        Topic::Clock,
        Topic::GroundTruth,
    ];
    let scan = Quality { is_reliable: true, ..Quality::SENSOR };
    wiring(names, ros, [&subscribed, &published], scan, Topic::default_name)
}

/// The wiring of a node that subscribes and publishes these topics.
fn wiring<'a>(
    names: &Names,
    ros: &RosArgs,
    topics: [&[Topic]; 2],
    scan: Quality,
    name: impl Fn(Topic) -> &'a str,
) -> anyhow::Result<Wiring> {
    let named = |topic: &Topic| -> anyhow::Result<_> {
        let quality = if *topic == Topic::Scan { scan } else { topic.quality() };
        Ok((*topic, names.resolved("topic", name(*topic), ros)?, quality))
    };
    let all = |topics: &[Topic]| topics.iter().map(named).collect::<anyhow::Result<Vec<_>>>();
    let [subscribed, published] = topics.map(all);
    Ok(Wiring {
        name: names.node.clone(),
        namespace: names.namespace.clone(),
        subscribed: subscribed?,
        published: published?,
        services: Vec::new(),
        navigate_to_pose: None,
        adjust_edges: None,
    })
}
