//! What to use of a bag: which lasers, where they are mounted, and where the poses come from.

use super::inventory::{Inventory, LaserTopic, no_scans};
use super::message::{Kind, Topic, Usable};
use super::motion::{self, Motion, MotionSource};
use crate::assemble::{Chain, Frames, can_be_base, is_base, is_odom, is_world};
use crate::summary::{TopicChoice, bare, listed};
use ros::mounted;

/// A laser that is used.
#[derive(Clone, Debug)]
pub(super) struct Laser {
    pub(super) topic: String,
    pub(super) frame: String,
    /// From the frame of the robot to that of the laser.
    pub(super) chain: Chain,
}

/// What to use of a bag.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) lasers: Vec<Laser>,
    pub(super) motion: MotionSource,
    /// With poses of another SLAM, from the frame of its map to the one in which the motions are given.
    pub(super) correction: Option<Chain>,
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
    pub(super) fn new(found: &Inventory, choice: &TopicChoice, notes: &mut Vec<String>) -> Usable<Self> {
        let lasers = chosen_lasers(found, choice, notes)?;
        let frames = &found.frames;
        let Motion { source: motion, moving: moving_frame, correction, fixed } = if choice.is_corrected {
            motion::by_slam(found, &lasers, choice)?
        } else {
            motion::by_odometry(found, &lasers, choice)?
        };
        let base = match (&choice.base_frame, &moving_frame) {
            (Some(base), _) => bare(base).to_owned(),
            (None, Some(moving)) if !moving.is_empty() => moving.clone(),
            // Some drivers do not name the frame whose pose they give.
            _ => likely_base(frames, &lasers)?,
        };
        let mut world: Vec<&str> =
            frames.names().into_iter().filter(|name| is_odom(name) || is_world(name)).collect();
        world.extend(fixed.iter().map(String::as_str));
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
        Ok(Self { lasers, motion, correction, to_base, frames: frames.clone() })
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

/// The lasers on the topics that were chosen. Two topics of one frame are one laser, and the one with more scans is used. Of `/scan`
/// and `/scan_filtered`, this is the filtered one, without the parts of the robot, unless it has less than half of the scans.
fn chosen_lasers<'a>(
    found: &'a Inventory,
    choice: &TopicChoice,
    notes: &mut Vec<String>,
) -> Usable<Vec<&'a LaserTopic>> {
    let mut lasers: Vec<&LaserTopic> = found.lasers.iter().collect();
    if lasers.is_empty() {
        return Err(no_scans(&found.topics));
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
        let preferred = if laser.topic.ends_with("_filtered") { 2 * laser.scans } else { laser.scans };
        (laser.frame.as_str(), std::cmp::Reverse(preferred), laser.topic.len(), laser.topic.as_str())
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

/// The frame of a robot that is not named: one above its first laser with the usual name, or what all lasers are mounted on.
fn likely_base(frames: &Frames, lasers: &[&LaserTopic]) -> Usable<String> {
    let Some(first) = lasers.first() else { return Ok(String::new()) };
    let above = frames.above(&first.frame)?;
    let parents = above.iter().map(|index| frames.edge(*index).parent.as_str());
    if let Some(base) = parents.clone().find(|name| is_base(name)) {
        return Ok(base.to_owned());
    }
    let below_odom = parents.clone().take_while(|name| !is_odom(name)).last();
    let base = match parents.clone().any(is_odom) {
        true => below_odom,
        false => {
            let root = || parents.clone().rfind(|name| !is_world(name));
            parents.clone().rfind(|name| can_be_base(name)).or_else(root)
        }
    };
    Ok(base.unwrap_or(&first.frame).to_owned())
}

/// The lasers that are connected to the robot.
fn connected(
    frames: &Frames,
    lasers: Vec<&LaserTopic>,
    base: &str,
    world: &[&str],
    notes: &mut Vec<String>,
) -> Usable<Vec<Laser>> {
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
