//! What other nodes have heard.

use crate::maps::{PublishedMaps, PublishedMasks};
use nalgebra::{Isometry2, Point2};
use std::time::Instant;

/// What other nodes have heard.
#[derive(Default)]
pub(super) struct Published {
    pub(super) maps: PublishedMaps,
    pub(super) masks: PublishedMasks,
    pub(super) next_diagnostics: Option<Instant>,
    /// The path to the goal.
    pub(super) path: Vec<Point2<f64>>,
    /// The pose of the frame of the odometry in the frame of the map.
    pub(super) map_to_odom: Option<Isometry2<f64>>,
    pub(super) next_transform: Option<Instant>,
    pub(super) is_lost: bool,
    /// The number of maps that were learned again.
    pub(super) switches: usize,
}
