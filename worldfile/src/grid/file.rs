//! The world file as it is written: every key with its place in the text.

use crate::reader::{Sound, Tables};
use serde::Deserialize;
use serde_spanned::Spanned;

/// A whole number, whether or not it is in range.
pub(super) type Whole = Spanned<i64>;
/// Column and row, if the file has it right.
pub(super) type WayPoint = Spanned<Vec<i64>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GridFile {
    pub(super) name: Sound<String>,
    pub(super) description: Option<String>,
    pub(super) sensor_radius: Sound<i64>,
    pub(super) map: Sound<String>,
    pub(super) transitions: Sound<TransitionsFile>,
    #[serde(rename = "block")]
    pub(super) blocks: Tables<BlockFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TransitionsFile {
    pub(super) block_chance: Option<Spanned<f64>>,
    pub(super) robot_chance: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BlockFile {
    pub(super) name: Spanned<String>,
    pub(super) dwell: Whole,
    pub(super) stood: Option<Whole>,
    pub(super) course: Spanned<String>,
    pub(super) path: Spanned<Vec<WayPoint>>,
}
