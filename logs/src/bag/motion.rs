//! Where the motions of the robot of a bag come from: the odometry, or another SLAM.

use super::inventory::{Inventory, LaserTopic, OdometryTopic};
use super::message::Usable;
use crate::assemble::{Chain, Frames, can_be_base, is_odom, is_world};
use crate::checks::Jumps;
use crate::summary::{TopicChoice, bare, listed};
use nalgebra::Isometry2;
use ros::flat;
use std::collections::{BTreeSet, VecDeque};

/// The frame of the map by default.
const MAP: &str = "map";

/// Where the motions come from.
#[derive(Clone, Debug)]
pub(super) enum MotionSource {
    /// The messages of a topic.
    Topic(String),
    /// A transform, by its number.
    Transform(usize),
    Standing,
}

/// How the pose of a frame of the robot is known.
pub(super) struct Motion {
    pub(super) source: MotionSource,
    /// The frame whose pose is known.
    pub(super) moving: Option<String>,
    /// From the frame of the map of another SLAM to the one in which the motions are given; `None`: odometry alone.
    pub(super) correction: Option<Chain>,
    /// Frames that do not move with the robot.
    pub(super) fixed: Vec<String>,
}

/// The motions by odometry: of its topic, or of a transform.
pub(super) fn by_odometry(found: &Inventory, lasers: &[&LaserTopic], choice: &TopicChoice) -> Usable<Motion> {
    let of = |source, moving, fixed| Motion { source, moving, correction: None, fixed };
    if let Some(OdometryTopic { topic, odom_frame, child_frame }) = chosen_odometry(found, choice)? {
        let (moving, fixed) = (Some(child_frame.clone()), vec![odom_frame.clone()]);
        return Ok(of(MotionSource::Topic(topic.clone()), moving, fixed));
    }
    let Some(index) = moving_edge(&found.frames, lasers, choice)? else {
        return Ok(of(MotionSource::Standing, None, Vec::new()));
    };
    let moving = found.frames.edge(index).child.clone();
    Ok(of(MotionSource::Transform(index), Some(moving), Vec::new()))
}

/// The poses of the robot of the first laser in the map of another SLAM.
///
/// # Errors
///
/// When no transforms lead from the map to the laser, and when none of them moves.
pub(super) fn by_slam(found: &Inventory, lasers: &[&LaserTopic], choice: &TopicChoice) -> Usable<Motion> {
    let frames = &found.frames;
    let map = bare(choice.map_frame.as_deref().unwrap_or(MAP));
    if frames.is_empty() {
        return Err(
            "the bag has no transforms (tf), which would have the corrected poses of another SLAM".to_owned()
        );
    }
    let names = listed(frames.names().into_iter());
    if !frames.names().contains(&map) {
        return Err(format!(
            "no transform (tf) has the frame `{map}`, in which another SLAM would have corrected the poses; --map-frame names it; \
             the frames are {names}"
        ));
    }
    let laser = lasers.first().map_or("", |laser| laser.frame.as_str());
    let robot = choice.base_frame.as_deref().map_or(laser, bare);
    let of = |source, correction: Chain, moving: String, parent: &str| {
        let fixed = vec![map.to_owned(), parent.to_owned()];
        Motion { source, moving: Some(moving), correction: Some(correction), fixed }
    };
    if let Some(chain) = frames.chain(map, robot, &[]) {
        let Some(at) = moving_part(frames, &chain) else {
            return Err(format!(
                "no transform between `{map}` and `{robot}` moves: another SLAM gives no poses there"
            ));
        };
        let edge = frames.edge(chain[at].0);
        let source = MotionSource::Transform(chain[at].0);
        return Ok(of(source, chain[..at].to_vec(), edge.child.clone(), &edge.parent));
    }
    // The odometry can be in messages alone.
    if let Some(odometry) = chosen_odometry(found, choice)?
        && let Some(correction) = frames.chain(map, &odometry.odom_frame, &[])
    {
        let source = MotionSource::Topic(odometry.topic.clone());
        return Ok(of(source, correction, odometry.child_frame.clone(), &odometry.odom_frame));
    }
    Err(format!(
        "no transforms (tf) lead from the map of another SLAM, `{map}`, to `{robot}`; the frames are {names} (--map-frame and \
         --base-frame name those of the map and of the robot)"
    ))
}

/// The part of a chain from a map to a robot that is the odometry: below a frame of odometry by its name, otherwise the one of
/// which there are most poses.
fn moving_part(frames: &Frames, chain: &Chain) -> Option<usize> {
    let down = || chain.iter().enumerate().filter(|(_, (_, is_down))| *is_down);
    let named =
        down().find(|(_, (index, _))| is_odom(&frames.edge(*index).parent) && frames.edge(*index).poses > 1);
    let moving = down().filter(|(_, (index, _))| frames.edge(*index).moves);
    let most = || moving.max_by_key(|(at, (index, _))| (frames.edge(*index).poses, usize::MAX - at));
    named.or_else(most).map(|(at, _)| at)
}

/// The topic of odometry, if there is one.
fn chosen_odometry<'a>(found: &'a Inventory, choice: &TopicChoice) -> Usable<Option<&'a OdometryTopic>> {
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

/// The transform that is the odometry: from a frame of odometry, or of the world, to the robot. Where a transform below the world
/// moves, that of the world is the correction by another SLAM.
fn moving_edge(frames: &Frames, lasers: &[&LaserTopic], choice: &TopicChoice) -> Usable<Option<usize>> {
    let starts = choice.base_frame.iter().map(|base| bare(base));
    for start in starts.chain(lasers.iter().map(|laser| laser.frame.as_str())) {
        let above = frames.above(start)?;
        let by_name = |is: fn(&str) -> bool| {
            above.iter().find(|index| is(&frames.edge(**index).parent) && frames.edge(**index).poses > 1)
        };
        let moves = |index: &&usize| frames.edge(**index).moves;
        // Below the frame of the robot, its lasers may pan.
        let robot = above.iter().rposition(|index| can_be_base(&frames.edge(*index).child)).unwrap_or(0);
        let below_world = || {
            let below = above[robot..].iter().take_while(|index| !is_world(&frames.edge(**index).parent));
            below.filter(moves).last()
        };
        let named = by_name(is_odom).or_else(below_world).or_else(|| by_name(is_world));
        if let Some(index) = named.or_else(|| above.iter().rev().find(moves)) {
            return Ok(Some(*index));
        }
    }
    Ok(None)
}

// The corrections of another SLAM in the transforms of a bag (REP-105): from the frame of its map to that of the odometry, which
// jumps where the SLAM corrects itself.

/// The corrections that are kept: scans wait for later poses.
const KEPT: usize = 512;
/// Times that differ by less are the same, s: they are rounded.
const SAME_S: f64 = 1e-3;

/// The corrections so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Corrections {
    chain: Chain,
    /// The transforms of the chain that are not known yet.
    missing: BTreeSet<usize>,
    /// The poses of the odometry in the map, and since when each of them was known, s; the newest last.
    known: VecDeque<(f64, Isometry2<f64>)>,
    jumps: Jumps,
}

impl Corrections {
    /// Those along a chain. Transforms that never move are known from the begin on.
    pub(super) fn new(chain: &Chain, frames: &Frames) -> Self {
        let missing =
            chain.iter().map(|(index, _)| *index).filter(|index| frames.edge(*index).moves).collect();
        let mut corrections = Self { chain: chain.clone(), missing, ..Self::default() };
        corrections.learn(f64::NEG_INFINITY, frames, &Isometry2::identity());
        corrections
    }

    /// Notes that a transform was set by a message with this time, s, while the odometry has the robot at a pose. Some SLAMs write
    /// later times, until which the transform shall hold: it is known since `newest_s`, the newest time in the bag so far.
    pub(super) fn note(
        &mut self,
        edge: usize,
        frames: &Frames,
        [time_s, newest_s]: [f64; 2],
        robot: &Isometry2<f64>,
    ) {
        if self.chain.iter().any(|(index, _)| *index == edge) {
            self.missing.remove(&edge);
            self.learn(time_s.min(newest_s), frames, robot);
        }
    }

    fn learn(&mut self, time_s: f64, frames: &Frames, robot: &Isometry2<f64>) {
        let now = flat(&frames.along(&self.chain));
        let before = self.known.back().map(|(_, before)| *before);
        if !self.missing.is_empty() || before == Some(now) {
            return;
        }
        if let Some(before) = before {
            self.jumps.add(time_s, &(before * robot).inv_mul(&(now * robot)));
        }
        if self.known.len() == KEPT {
            self.known.pop_front();
        }
        self.known.push_back((time_s, now));
    }

    /// The pose of the odometry in the map, as it was known at a time, s; `None` before the first one.
    pub(super) fn at(&self, time_s: f64) -> Option<Isometry2<f64>> {
        let is_known = |(since_s, _): &&(f64, Isometry2<f64>)| *since_s <= time_s + SAME_S;
        self.known.iter().rev().find(is_known).map(|(_, pose)| *pose)
    }

    /// The corrections; without a frame of odometry, they are jumps of the poses themselves.
    pub(super) fn described(&self, of_poses: &Jumps, begin_s: f64) -> String {
        let jumps = if self.chain.is_empty() { of_poses } else { &self.jumps };
        jumps.described(begin_s)
    }
}
