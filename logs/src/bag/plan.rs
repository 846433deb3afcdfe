//! What to use of a bag: which lasers, where they are mounted, and where the poses come from.

use super::inventory::{Inventory, Kind, LaserTopic, OdometryTopic};
use super::message::Topic;
use crate::choice::{TopicChoice, bare};
use crate::ros::{Chain, Frames, is_odom, is_world, mounted};
use crate::summary::PoseSource;

/// A laser that is used.
#[derive(Clone, Debug)]
pub(super) struct Laser {
    pub(super) topic: String,
    pub(super) frame: String,
    /// From the frame of the robot to that of the laser.
    pub(super) chain: Chain,
}

/// Where the poses come from.
#[derive(Clone, Debug)]
pub(super) enum MotionSource {
    /// The messages of a topic.
    Topic(String),
    /// A transform, by its number.
    Transform(usize),
    Standing,
}

/// What to use of a bag.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) lasers: Vec<Laser>,
    pub(super) motion: MotionSource,
    pub(super) pose_source: PoseSource,
    /// From the frame whose poses are known to that of the robot.
    pub(super) to_base: Chain,
    /// With the first poses.
    pub(super) frames: Frames,
}

impl Plan {
    /// Chooses. What is left out is noted.
    ///
    /// # Errors
    ///
    /// When there is no scan, when the choice is up to the user, or when no laser is connected to the robot.
    pub(super) fn new(
        found: &Inventory,
        choice: &TopicChoice,
        notes: &mut Vec<String>,
    ) -> Result<Self, String> {
        let lasers = chosen_lasers(found, choice, notes)?;
        let odometry = chosen_odometry(found, choice)?;
        let frames = &found.frames;
        let (motion, pose_source, moving_frame) = match odometry {
            Some(odometry) => {
                let source = PoseSource::OdometryTopic(odometry.topic.clone());
                (MotionSource::Topic(odometry.topic.clone()), source, Some(odometry.child_frame.clone()))
            }
            None => match moving_edge(frames, &lasers, choice)? {
                Some(index) => {
                    let edge = frames.edge(index);
                    let (odom_frame, base_frame) = (edge.parent.clone(), edge.child.clone());
                    let moving = base_frame.clone();
                    let source = PoseSource::Transforms { odom_frame, base_frame };
                    (MotionSource::Transform(index), source, Some(moving))
                }
                None => (MotionSource::Standing, PoseSource::Standing, None),
            },
        };
        let base = match (&choice.base_frame, &moving_frame) {
            (Some(base), _) => bare(base).to_owned(),
            (None, Some(moving)) if !moving.is_empty() => moving.clone(),
            // Some drivers do not name the frame whose pose they give.
            _ => likely_base(frames, &lasers)?,
        };
        let mut world: Vec<&str> =
            frames.names().into_iter().filter(|name| is_odom(name) || is_world(name)).collect();
        world.extend(odometry.map(|odometry| odometry.odom_frame.as_str()));
        let to_base = match &moving_frame {
            Some(moving) if !moving.is_empty() => frames.chain(moving, &base, &world).unwrap_or_else(|| {
                notes.push(format!(
                    "no transform connects `{moving}`, whose poses are known, with `{base}`: they count as one frame"
                ));
                Chain::new()
            }),
            _ => Chain::new(),
        };
        let lasers = connected(frames, lasers, &base, &world, notes)?;
        Ok(Self { lasers, motion, pose_source, to_base, frames: frames.clone() })
    }

    /// Whether the messages of a topic are needed.
    pub(super) fn needs(&self, topic: &Topic) -> bool {
        match Kind::of_readable(topic) {
            Some(Kind::Scans) => self.lasers.iter().any(|laser| laser.topic == topic.name),
            Some(Kind::Odometry) => {
                matches!(&self.motion, MotionSource::Topic(name) if *name == topic.name)
            }
            Some(Kind::Transforms) => true,
            None => false,
        }
    }
}

/// The lasers on the topics that were chosen. Two topics of one frame are one laser, filtered or not.
fn chosen_lasers<'a>(
    found: &'a Inventory,
    choice: &TopicChoice,
    notes: &mut Vec<String>,
) -> Result<Vec<&'a LaserTopic>, String> {
    let mut lasers: Vec<&LaserTopic> = found.lasers.iter().collect();
    if lasers.is_empty() {
        return Err(no_scans(found));
    }
    if !choice.scan_topics.is_empty() {
        let is = |laser: &LaserTopic, name: &String| bare(&laser.topic) == bare(name);
        for name in &choice.scan_topics {
            if !lasers.iter().any(|laser| is(laser, name)) {
                let topics = listed(lasers.iter().map(|laser| laser.topic.as_str()));
                return Err(format!("no scans on the topic `{name}` of --scan-topic; there are {topics}"));
            }
        }
        lasers.retain(|laser| choice.scan_topics.iter().any(|name| is(laser, name)));
        return Ok(lasers);
    }
    lasers.sort_by_key(|laser| {
        (laser.frame.as_str(), std::cmp::Reverse(laser.scans), laser.topic.len(), laser.topic.as_str())
    });
    let mut kept: Vec<&LaserTopic> = Vec::new();
    for laser in lasers {
        match kept.last().filter(|last| last.frame == laser.frame) {
            Some(last) => notes.push(format!(
                "{} and {} are of one laser (`{}`): {} is used, --scan-topic names another",
                last.topic, laser.topic, laser.frame, last.topic
            )),
            None => kept.push(laser),
        }
    }
    Ok(kept)
}

fn no_scans(found: &Inventory) -> String {
    let types = listed(found.topics.iter().map(|topic| match Kind::of(topic) {
        Some(Kind::Scans) => topic.encoding.as_str(),
        _ => topic.type_name.as_str(),
    }));
    match found.topics.iter().any(|topic| Kind::of(topic) == Some(Kind::Scans) && topic.encoding != "cdr") {
        true => format!("the scans are not encoded as cdr, which is what is read; there are {types}"),
        false if types.is_empty() => "no message: the bag is empty".to_owned(),
        false => format!("no message of sensor_msgs/msg/LaserScan; there are {types}"),
    }
}

/// The topic of odometry, if there is one.
fn chosen_odometry<'a>(
    found: &'a Inventory,
    choice: &TopicChoice,
) -> Result<Option<&'a OdometryTopic>, String> {
    let topics = || listed(found.odometry.iter().map(|odometry| odometry.topic.as_str()));
    match &choice.odom_topic {
        Some(name) => {
            let chosen = found.odometry.iter().find(|odometry| bare(&odometry.topic) == bare(name));
            let missing = || {
                let known = if found.odometry.is_empty() { "none".to_owned() } else { topics() };
                format!("no odometry on the topic `{name}` of --odom-topic; there is {known}")
            };
            chosen.map(Some).ok_or_else(missing)
        }
        None if found.odometry.len() > 1 => Err(format!(
            "several topics of odometry: {}; choose one with --odom-topic (other choices: --scan-topic, --base-frame)",
            topics()
        )),
        None => Ok(found.odometry.first()),
    }
}

/// The transform that is the odometry: from a frame of odometry, or of the world, to the robot.
fn moving_edge(
    frames: &Frames,
    lasers: &[&LaserTopic],
    choice: &TopicChoice,
) -> Result<Option<usize>, String> {
    let starts = choice.base_frame.iter().map(|base| bare(base));
    for start in starts.chain(lasers.iter().map(|laser| laser.frame.as_str())) {
        let above = frames.above(start)?;
        let by_name = |is: fn(&str) -> bool| {
            above.iter().find(|index| is(&frames.edge(**index).parent) && frames.edge(**index).poses > 1)
        };
        let moving = || above.iter().rev().find(|index| frames.edge(**index).moves);
        if let Some(index) = by_name(is_odom).or_else(|| by_name(is_world)).or_else(moving) {
            return Ok(Some(*index));
        }
    }
    Ok(None)
}

/// The frame of a robot that is not named: one above its first laser with the usual name, or what all lasers are mounted on.
fn likely_base(frames: &Frames, lasers: &[&LaserTopic]) -> Result<String, String> {
    let Some(first) = lasers.first() else { return Ok(String::new()) };
    let above = frames.above(&first.frame)?;
    let parents = above.iter().map(|index| frames.edge(*index).parent.as_str());
    let is_robot = |name: &&str| name.rsplit('/').next().is_some_and(|name| name.starts_with("base"));
    let on_ground = |name: &&str| !is_odom(name) && !is_world(name);
    let root = parents.clone().rfind(on_ground);
    Ok(parents.clone().find(is_robot).or(root).unwrap_or(&first.frame).to_owned())
}

/// The lasers that are connected to the robot.
fn connected(
    frames: &Frames,
    lasers: Vec<&LaserTopic>,
    base: &str,
    world: &[&str],
    notes: &mut Vec<String>,
) -> Result<Vec<Laser>, String> {
    let (mut kept, mut refused) = (Vec::new(), Vec::new());
    for LaserTopic { topic, frame, .. } in lasers {
        frames.above(frame)?; // not in a cycle
        let chain = frames.chain(base, frame, world).ok_or_else(|| match frames.is_empty() {
            true => format!("is not connected to the robot `{base}`: the bag has no transforms (tf)"),
            false => format!(
                "is not connected to the robot `{base}` by transforms; the frames are {}",
                listed(frames.names().into_iter())
            ),
        });
        let checked = chain.and_then(|chain| mounted(&frames.along(&chain)).map(|_| chain));
        match checked {
            Ok(chain) => kept.push(Laser { topic: topic.clone(), frame: frame.clone(), chain }),
            Err(why) => refused.push(format!("the laser `{frame}` of {topic} {why}")),
        }
    }
    if kept.is_empty() {
        refused.truncate(1);
        let why = refused.pop().unwrap_or_default();
        return Err(format!("{why} (--base-frame names the frame of the robot; the laser itself can be it)"));
    }
    notes.extend(refused.into_iter().map(|why| format!("{why}: left out")));
    Ok(kept)
}

/// Names for a sentence, at most ten.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MAX: usize = 10;
    let mut names: Vec<String> = names.map(str::to_owned).collect();
    names.sort();
    names.dedup();
    let more = names.len().saturating_sub(MAX);
    names.truncate(MAX);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    names.join(", ") + &rest
}
