//! Random grid worlds for benches.

use sim::grid::{GenerateSettings, GridSpec};

/// A random world of `side` × `side` cells, seen with a sensor of `sensor_radius` cells; larger worlds have more rooms.
pub(crate) fn generated(side: u32, sensor_radius: u32, seed: u64) -> GridSpec {
    let rooms = (side / 12).pow(2);
    let settings = GenerateSettings {
        width: [side; 2],
        height: [side; 2],
        walls: [rooms - 1; 2],
        pillars: [rooms; 2],
        blocks: [4; 2],
        sensor_radius,
        ..GenerateSettings::default()
    };
    GridSpec::generate(&settings, seed)
}
