//! Which topics the nodes have, and how these are named.

use crate::link::Wiring;
use crate::message::{Quality, Topic};
use crate::names::{NameError, Names};
use crate::parameters::{Mode, Navigator, Parameters};
use crate::ros_args::RosArgs;

/// Scans that wait for the node: a node that saves its state must not lose one.
const SCANS: usize = 100;

/// A topic with its full name.
type Named = (Topic, String, Quality);

/// The topics and services of the mapping node.
///
/// # Errors
///
/// When a name is not valid.
pub fn curious_wiring(parameters: &Parameters, names: &Names, ros: &RosArgs) -> Result<Wiring, NameError> {
    let named = |topic: Topic| -> Result<Named, NameError> {
        let name = match topic {
            Topic::Scan => &parameters.scan_topic,
            Topic::Odometry => &parameters.odom_topic,
            _ => topic.default_name(),
        };
        let quality = match topic {
            Topic::Scan => Quality {
                is_reliable: parameters.scan_reliability == "reliable",
                depth: SCANS,
                ..topic.quality()
            },
            _ => topic.quality(),
        };
        Ok((topic, names.resolved("topic", name, ros)?, quality))
    };
    let mut subscribed = vec![Topic::Scan, Topic::Odometry, Topic::Transforms, Topic::StaticTransforms];
    let mut published =
        vec![Topic::Transforms, Topic::Map, Topic::MapUpdates, Topic::ChangeMap, Topic::PredictedMap];
    let mut navigate_to_pose = None;
    if parameters.mode == Mode::Explore {
        subscribed.push(Topic::Resume);
        published.push(Topic::Markers);
        match parameters.navigator {
            Navigator::CmdVel if parameters.enable_stamped_cmd_vel => published.push(Topic::StampedVelocity),
            Navigator::CmdVel => published.push(Topic::Velocity),
            Navigator::GoalPose => published.push(Topic::GoalPose),
            Navigator::Nav2 => navigate_to_pose = Some(names.resolved("action", "navigate_to_pose", ros)?),
        }
    }
    Ok(Wiring {
        name: names.node().to_owned(),
        namespace: names.namespace().to_owned(),
        subscribed: subscribed.into_iter().map(named).collect::<Result<_, _>>()?,
        published: published.into_iter().map(named).collect::<Result<_, _>>()?,
        save_state: Some(names.resolved("service", "~/save_state", ros)?),
        navigate_to_pose,
        parameters: parameters.list(),
    })
}

/// The topics of the simulated robot.
///
/// # Errors
///
/// When a name is not valid.
pub fn simulation_wiring(names: &Names, ros: &RosArgs) -> Result<Wiring, NameError> {
    let named = |topic: Topic| -> Result<Named, NameError> {
        Ok((topic, names.resolved("topic", topic.default_name(), ros)?, topic.quality()))
    };
    let scan = Quality { is_reliable: true, ..Quality::SENSOR };
    let published = [
        Topic::Scan,
        Topic::Odometry,
        Topic::Transforms,
        Topic::StaticTransforms,
        Topic::Clock,
        Topic::GroundTruth,
    ];
    let with_scan = |(topic, name, quality)| (topic, name, if topic == Topic::Scan { scan } else { quality });
    Ok(Wiring {
        name: names.node().to_owned(),
        namespace: names.namespace().to_owned(),
        subscribed: [Topic::Velocity, Topic::StampedVelocity]
            .into_iter()
            .map(named)
            .collect::<Result<_, _>>()?,
        published: published
            .into_iter()
            .map(|topic| named(topic).map(with_scan))
            .collect::<Result<_, _>>()?,
        save_state: None,
        navigate_to_pose: None,
        parameters: Vec::new(),
    })
}
