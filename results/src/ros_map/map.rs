//! A map as the two files of ROS.

use interfaces::{CellState, Grid, GridFrame};

/// What a map is saved with. 205 is p = 0.19608: with the customary threshold of 0.25 it would
/// come back as free.
const FREE_THRESHOLD: f64 = 0.196;
const OCCUPIED_THRESHOLD: f64 = 0.65;
const FREE: u8 = 254;
const UNKNOWN: u8 = 205;
const BLOCKED: u8 = 0;

/// The picture of a map (PGM, binary).
pub fn pgm(map: &Grid<CellState>) -> Vec<u8> {
    let frame = map.frame();
    let mut bytes = format!("P5\n{} {}\n255\n", frame.width(), frame.height()).into_bytes();
    let value = |state: &CellState| match state {
        CellState::Free => FREE,
        CellState::Unknown => UNKNOWN,
        CellState::Blocked => BLOCKED,
    };
    bytes.extend(map.cells().chunks(frame.width()).rev().flatten().map(value));
    bytes
}

/// The YAML file of a map with this frame, whose picture is called `image`.
pub fn yaml(frame: &GridFrame, image: &str) -> String {
    let (origin, resolution_m) = (frame.origin(), frame.resolution_m());
    format!(
        "image: {image}\nmode: trinary\nresolution: {resolution_m:?}\norigin: [{:?}, {:?}, 0.0]\nnegate: 0\n\
         occupied_thresh: {OCCUPIED_THRESHOLD}\nfree_thresh: {FREE_THRESHOLD}\n",
        origin.x, origin.y
    )
}
