//! The world file as it is written: every key with its place in the text.

use serde::Deserialize;
use serde_spanned::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GridFile {
    pub(super) name: Spanned<String>,
    #[serde(default)]
    pub(super) description: String,
    pub(super) sensor_radius: Spanned<u32>,
    pub(super) map: Spanned<String>,
    #[serde(default)]
    pub(super) transitions: TransitionsFile,
    #[serde(default, rename = "block")]
    pub(super) blocks: Vec<BlockFile>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TransitionsFile {
    pub(super) block_chance: Option<Spanned<f64>>,
    pub(super) robot_chance: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BlockFile {
    pub(super) name: Spanned<String>,
    pub(super) dwell: Spanned<u32>,
    pub(super) stood: Option<Spanned<u32>>,
    pub(super) course: Spanned<String>,
    pub(super) path: Spanned<Vec<Spanned<WayPoint>>>,
}

/// Column and row. Exactly two numbers: an array would let a third one pass.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "Vec<i64>")]
pub(super) struct WayPoint(pub(super) [i64; 2]);

impl TryFrom<Vec<i64>> for WayPoint {
    type Error = String;

    fn try_from(numbers: Vec<i64>) -> Result<Self, String> {
        let count = numbers.len();
        numbers
            .try_into()
            .map(Self)
            .map_err(|_| format!("invalid length {count}, expected an array of length 2"))
    }
}
