//! The colors of every figure, picture and recording: one color for one meaning.
//!
//! They are the colors of Okabe and Ito where possible, so that color-blind readers can tell them apart.
//! Their yellow has too little contrast on white: brown replaces it.

use xxhash_rust::xxh3::xxh3_64;

/// A color: red, green, blue.
pub type Rgb = [u8; 3];

/// Text and axes.
pub const INK: Rgb = [40, 44, 52];
/// The curious robot.
pub const CURIOUS: Rgb = [0, 114, 178];
/// The curious robot where it believes to be.
pub const ESTIMATE: Rgb = [122, 92, 40];
/// Every other robot.
pub const OTHER_ROBOT: Rgb = [0, 158, 115];
/// The planned path of the curious robot.
pub const PATH: Rgb = [230, 159, 0];
/// A goal of the curious robot.
pub const GOAL: Rgb = [213, 94, 0];
/// The line around the area that a sensor covers.
pub const SENSOR: Rgb = [86, 180, 233];
/// The area that a sensor covers, on white.
pub const SENSOR_AREA: Rgb = [214, 236, 250];
/// A wall.
pub const WALL: Rgb = [70, 74, 82];
/// A fixed obstacle: furniture.
pub const FURNITURE: Rgb = [190, 170, 140];
/// Something that moves, appears or disappears: a door, a block, a toy.
pub const MOVING: Rgb = [204, 121, 167];
/// The area that a moving thing sweeps, on white.
pub const SWEPT: Rgb = [246, 228, 238];
/// A free cell of a map.
pub const FREE: Rgb = [255, 255, 255];
/// A blocked cell of a map.
pub const BLOCKED: Rgb = [32, 36, 44];
/// A blocked cell in maps that show another quantity than the occupancy.
pub const BLOCKED_FAINT: Rgb = [158, 160, 165];
/// A cell of a map that was never seen.
pub const UNKNOWN: Rgb = [211, 219, 232];

const STRATEGIES: [(&str, Rgb); 7] = [
    ("curious", CURIOUS),
    ("recency", OTHER_ROBOT),
    ("poisson", PATH),
    ("random", [150, 150, 150]),
    ("coin", SENSOR),
    ("information-gain", GOAL),
    ("full-observation", [110, 110, 110]),
];

/// For other strategies: the dark colors of Paul Tol's muted scheme.
const OTHER_STRATEGIES: [Rgb; 5] =
    [[51, 34, 136], [17, 119, 51], [136, 34, 85], [153, 153, 51], [68, 170, 153]];

/// The color of a strategy's curve.
pub fn strategy(name: &str) -> Rgb {
    let known = STRATEGIES.iter().find(|(known, _)| *known == name).map(|(_, color)| *color);
    let other = || (xxh3_64(name.as_bytes()) % OTHER_STRATEGIES.len() as u64) as usize;
    known.unwrap_or_else(|| OTHER_STRATEGIES[other()])
}

/// A color of the same hue, bright enough for a dark background.
pub fn on_dark(color: Rgb) -> Rgb {
    let brightest = color.into_iter().max().unwrap_or(0);
    let lift = |part: u8| part + (255 - part) / 5 * (190_u8.saturating_sub(brightest) / 20).min(4);
    color.map(lift)
}
