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
    let mut subscribed =
        vec![Topic::Scan, Topic::Odometry, Topic::Transforms, Topic::StaticTransforms, Topic::InitialPose];
    let mut published = vec![
        Topic::Transforms,
        Topic::Map,
        Topic::MapUpdates,
        Topic::ChangeMap,
        Topic::PredictedMap,
        Topic::RateMap,
        Topic::ExpiryMap,
        Topic::EstimatedPose,
        Topic::Diagnostics,
        Topic::Log,
        Topic::ParameterEvents,
        Topic::TransitionEvents,
    ];
    if parameters.mask_update_interval_s > 0.0 {
        let masks = [Topic::SpeedMask, Topic::KeepoutMask, Topic::SpeedFilterInfo, Topic::KeepoutFilterInfo];
        published.extend(masks);
    }
    let mut navigate_to_pose = None;
    if parameters.mode == Mode::Explore {
        subscribed.push(Topic::Resume);
        published.push(Topic::Path);
        match parameters.navigator {
            Navigator::CmdVel if parameters.enable_stamped_cmd_vel => published.push(Topic::StampedVelocity),
            Navigator::CmdVel => published.push(Topic::Velocity),
            Navigator::GoalPose => published.push(Topic::GoalPose),
            Navigator::Nav2 => navigate_to_pose = Some(names.resolved("action", "navigate_to_pose", ros)?),
        }
    }
    let adjust_edges = match parameters.route_graph.is_empty() {
        true => None,
        false => Some(names.resolved("service", &parameters.route_edges_service, ros)?),
    };
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
    let services =
        Service::all().map(|service| Ok((service, names.resolved("service", service.default_name(), ros)?)));
    Ok(Wiring {
        services: services.collect::<anyhow::Result<_>>()?,
        navigate_to_pose,
        adjust_edges,
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
        name: names.node().to_owned(),
        namespace: names.namespace().to_owned(),
        subscribed: subscribed?,
        published: published?,
        services: Vec::new(),
        navigate_to_pose: None,
        adjust_edges: None,
    })
}
