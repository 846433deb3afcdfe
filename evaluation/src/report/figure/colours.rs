//! Colours that stay apart for the colour-blind, and mean the same in every figure.

use crate::report::REFERENCE;
use plotters::style::RGBColor;
use xxhash_rust::xxh3::xxh3_64;

/// After Okabe and Ito, with their yellow, which is lost on white, made brown.
const STRATEGIES: [(&str, RGBColor); 9] = [
    ("curious", RGBColor(0, 114, 178)),
    ("recency", RGBColor(0, 158, 115)),
    ("poisson", RGBColor(230, 159, 0)),
    ("random", RGBColor(150, 150, 150)),
    ("coin", RGBColor(86, 180, 233)),
    ("information-gain", RGBColor(213, 94, 0)),
    ("optimal-revisiting", RGBColor(204, 121, 167)),
    ("frontier", RGBColor(122, 92, 40)),
    ("oracle", RGBColor(0, 0, 0)),
];

/// For other strategies: the dark ones of Paul Tol's muted scheme.
const OTHERS: [RGBColor; 5] = [
    RGBColor(51, 34, 136),
    RGBColor(17, 119, 51),
    RGBColor(136, 34, 85),
    RGBColor(153, 153, 51),
    RGBColor(68, 170, 153),
];

/// For what moves in a world: Paul Tol's light scheme, so that no cell looks like a curve.
const THINGS: [RGBColor; 8] = [
    RGBColor(238, 136, 102),
    RGBColor(119, 170, 221),
    RGBColor(238, 221, 136),
    RGBColor(68, 187, 153),
    RGBColor(255, 170, 187),
    RGBColor(170, 170, 0),
    RGBColor(153, 221, 255),
    RGBColor(187, 204, 51),
];

/// The colour of a strategy's curve.
pub(super) fn of_strategy(name: &str) -> RGBColor {
    let known = STRATEGIES.iter().find(|(known, _)| *known == name).map(|(_, colour)| *colour);
    known.unwrap_or_else(|| OTHERS[(xxh3_64(name.as_bytes()) % OTHERS.len() as u64) as usize])
}

/// The colour of a thing's cells.
pub(super) fn of_thing(index: usize) -> RGBColor {
    THINGS[index % THINGS.len()]
}

/// Whether a strategy's curve is dashed: those that are shown to compare with.
pub(super) fn is_dashed(name: &str) -> bool {
    ["random", "coin", REFERENCE].contains(&name)
}
