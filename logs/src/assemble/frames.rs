//! Frames and the transforms between them (tf).

use crate::bounds;
use crate::summary::bare;
use nalgebra::Isometry3;
use std::collections::{BTreeMap, VecDeque};

/// The most frames of a robot.
const MAX_FRAMES: usize = 10_000;
/// Frames that move against each other are the robot and the world.
const MIN_MOTION: f64 = 1e-6;

/// A transform between two frames.
#[derive(Clone, Debug)]
pub(crate) struct Edge {
    pub(crate) parent: String,
    pub(crate) child: String,
    /// The newest pose of the child in the frame of the parent, and the first one.
    pub(crate) pose: Isometry3<f64>,
    first: Isometry3<f64>,
    /// The number of poses, and whether they differ.
    pub(crate) poses: usize,
    pub(crate) moves: bool,
}

/// A frame beside another one, and the edge to it: its number, and whether it is taken from the parent to the child.
type Neighbour<'a> = (&'a str, (usize, bool));

/// A chain of transforms: the edges, and whether each is taken from the parent to the child.
pub type Chain = Vec<(usize, bool)>;

/// The transforms between the frames of a robot (tf). The newest one between two frames holds.
#[derive(Clone, Debug, Default)]
pub struct Frames {
    edges: Vec<Edge>,
    /// The edges by child and parent.
    known: BTreeMap<(String, String), usize>,
}

impl Frames {
    /// Takes a pose of `child` in the frame of `parent`. Gives the number of the edge.
    ///
    /// # Errors
    ///
    /// When there are too many frames, or the name of one is too long.
    pub fn set(&mut self, parent: &str, child: &str, pose: Isometry3<f64>) -> Result<usize, String> {
        let name = |name| bounds::name("a frame", bare(name)).map(str::to_owned);
        let key = (name(child)?, name(parent)?);
        if let Some(index) = self.known.get(&key) {
            let edge = &mut self.edges[*index];
            let step = edge.pose.inv_mul(&pose);
            edge.moves |= step.translation.vector.norm().max(step.rotation.angle()) > MIN_MOTION;
            edge.pose = pose;
            edge.poses += 1;
            return Ok(*index);
        }
        if self.edges.len() == MAX_FRAMES {
            return Err(format!("more than {MAX_FRAMES} transforms between frames"));
        }
        let (child, parent) = key.clone();
        self.edges.push(Edge { parent, child, pose, first: pose, poses: 1, moves: false });
        self.known.insert(key, self.edges.len() - 1);
        Ok(self.edges.len() - 1)
    }

    /// Sets all transforms back to their first poses.
    pub(crate) fn rewind(&mut self) {
        self.edges.iter_mut().for_each(|edge| edge.pose = edge.first);
    }

    pub(crate) fn edge(&self, index: usize) -> &Edge {
        &self.edges[index]
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// The names of all frames, in order.
    pub fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> =
            self.edges.iter().flat_map(|edge| [&edge.parent[..], &edge.child[..]]).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// The edges from a frame up to its root, the nearest first. Of two parents, one in which robots are located is
    /// taken.
    ///
    /// # Errors
    ///
    /// When the frames form a cycle.
    pub(crate) fn above(&self, frame: &str) -> Result<Vec<usize>, String> {
        let (mut above, mut at) = (Vec::new(), bare(frame));
        loop {
            let from = (at.to_owned(), String::new());
            let to =
                self.known.range(from..).take_while(|((child, _), _)| child == at).map(|(_, index)| *index);
            let Some(edge) = to.max_by_key(|index| {
                let edge = &self.edges[*index];
                (is_odom(&edge.parent), !is_world(&edge.parent), usize::MAX - index)
            }) else {
                return Ok(above);
            };
            if above.contains(&edge) {
                return Err(format!("the frames form a cycle: {} is above itself", self.edges[edge].child));
            }
            above.push(edge);
            at = &self.edges[edge].parent;
        }
    }

    /// The shortest chain from one frame to another that does not contain the frames of the world.
    pub fn chain(&self, from: &str, to: &str, world: &[&str]) -> Option<Chain> {
        let (from, to) = (bare(from), bare(to));
        let mut neighbours: BTreeMap<&str, Vec<Neighbour>> = BTreeMap::new();
        for (index, Edge { parent, child, .. }) in self.edges.iter().enumerate() {
            neighbours.entry(parent).or_default().push((child, (index, true)));
            neighbours.entry(child).or_default().push((parent, (index, false)));
        }
        // How each frame was reached: from which one, by which edge.
        let mut reached: BTreeMap<&str, Neighbour> = BTreeMap::new();
        let mut open = VecDeque::from([from]);
        while let Some(mut at) = open.pop_front() {
            if at == to {
                let mut chain = Chain::new();
                while at != from {
                    let (before, edge) = reached[at];
                    chain.push(edge);
                    at = before;
                }
                chain.reverse();
                return Some(chain);
            }
            for (next, edge) in neighbours.get(at).into_iter().flatten() {
                if *next != from && !reached.contains_key(next) && !world.contains(next) {
                    reached.insert(next, (at, *edge));
                    open.push_back(next);
                }
            }
        }
        None
    }

    /// The pose of the frame at the end of a chain in the frame at its begin.
    pub fn along(&self, chain: &Chain) -> Isometry3<f64> {
        chain.iter().fold(Isometry3::identity(), |pose, (index, is_down)| {
            let edge = self.edges[*index].pose;
            if *is_down { pose * edge } else { pose * edge.inverse() }
        })
    }
}

/// Whether this is the name of a frame of odometry (REP-105): `odom`, `odom_combined`, `robot1_odom`, `camera_odom_frame`.
pub(crate) fn is_odom(frame: &str) -> bool {
    frame.rsplit('/').next().is_some_and(|name| name.contains("odom"))
}

/// Whether this is the usual name of the frame of a robot (REP-105): `base_link`, `base_footprint`.
pub(crate) fn is_base(frame: &str) -> bool {
    frame.rsplit('/').next().is_some_and(|name| name.starts_with("base"))
}

/// The same with a prefix, as of one of many robots: `robot1_base_link`. Parts of a robot can have such names as well.
pub(crate) fn can_be_base(frame: &str) -> bool {
    frame.rsplit('/').next().is_some_and(|name| name.contains("base"))
}

/// Whether this is the name of a frame in which the world stands still.
pub(crate) fn is_world(frame: &str) -> bool {
    matches!(frame.rsplit('/').next(), Some("map" | "world" | "earth"))
}
