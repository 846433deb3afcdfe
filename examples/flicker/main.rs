//! The flicker study: how often does a static wall change in the map, and what does it cost to prevent this? Prints
//! the table of `docs/flicker.md` and draws `docs/flicker.svg`.
//!
//! ```text
//! cargo run --release --example flicker
//! ```
//!
//! Every house is toured for ten minutes (6000 scans) while nothing moves: each change in the map is false. Then
//! things appear, disappear and move in the same house: a box is removed, and a disc drives past. Both parts are
//! needed: a map that never changes never flickers.

mod curve;
#[path = "../../mapper/tests/house/mod.rs"]
mod house;
mod things;

use house::House;
use interfaces::LaserReading;
use mapper::{Mapper, MapperSettings, OccupancyChoice, SurfaceGridSettings};
use std::fmt::Write as _;
use things::{cleared_after, latencies, median};

const SCANS: u32 = 6000;
const PERIOD_S: f64 = 0.1;

const HEADER: &str = "| house | map | false changes | repeated | box in the open: half, 90 % free | \
                      box at a wall | free event | missed % |";

/// A house to tour.
#[derive(Clone, Copy)]
struct Bench {
    name: &'static str,
    thickness_m: f64,
    turn_deg: f64,
    noise_std_m: f64,
    beams: usize,
}

/// Walls 0.1 m thick, turned by 10°, 1 cm of range noise: the reference.
const TURNED: Bench = Bench {
    name: "R: thick, turned by 10°",
    thickness_m: 0.1,
    turn_deg: 10.0,
    noise_std_m: 0.01,
    beams: 360,
};

const BENCHES: [Bench; 7] = [
    Bench {
        name: "T: thin, on cell borders",
        thickness_m: 0.05,
        turn_deg: 0.0,
        noise_std_m: 0.0,
        beams: 360,
    },
    Bench {
        name: "K: thick, on cell borders",
        thickness_m: 0.1,
        turn_deg: 0.0,
        noise_std_m: 0.0,
        beams: 360,
    },
    TURNED,
    Bench { name: "R with 720 beams", beams: 720, ..TURNED },
    Bench { name: "R turned by 37°", turn_deg: 37.0, ..TURNED },
    Bench { name: "R with thin walls", thickness_m: 0.05, ..TURNED },
    Bench { name: "R with 3 cm of noise", noise_std_m: 0.03, ..TURNED },
];

impl Bench {
    fn house(self, seed: u64) -> House {
        House::new(self.thickness_m, self.turn_deg, self.noise_std_m, self.beams, seed)
    }

    /// The default settings with the noise of the laser.
    fn settings(self, occupancy: OccupancyChoice) -> MapperSettings {
        let range_noise_std_m = self.noise_std_m.max(SurfaceGridSettings::default().range_noise_std_m);
        let steady = SurfaceGridSettings { range_noise_std_m, ..SurfaceGridSettings::default() };
        MapperSettings { occupancy, steady, ..MapperSettings::default() }
    }

    /// Ten minutes of observation while nothing moves.
    fn tour(self, seed: u64) -> (House, Vec<LaserReading>) {
        let mut house = self.house(seed);
        let time_s = |scan: u32| f64::from(scan) * PERIOD_S;
        let readings =
            (0..SCANS).map(|scan| house.reading(time_s(scan), house.tour(time_s(scan)), &[])).collect();
        (house, readings)
    }
}

/// The number of changes of known cells that a mapper reports in a static house, and how many of them were not the
/// first change of their cell.
fn false_changes(
    house: &House,
    readings: &[LaserReading],
    settings: &MapperSettings,
) -> anyhow::Result<(usize, usize)> {
    let mut mapper = Mapper::new(settings, house.frame)?;
    let (mut changes, mut cells) = (0, std::collections::BTreeSet::new());
    for reading in readings {
        mapper.update(reading)?;
        for transition in mapper.transitions().iter().filter(|transition| transition.event().is_some()) {
            changes += 1;
            cells.insert(transition.cell);
        }
    }
    Ok((changes, changes - cells.len()))
}

fn row(bench: Bench, occupancy: OccupancyChoice) -> anyhow::Result<String> {
    let settings = bench.settings(occupancy.clone());
    let (house, readings) = bench.tour(1);
    let (changes, repeated) = false_changes(&house, &readings, &settings)?;
    let mut row = format!("| {} | {} | {changes} | {repeated} |", bench.name, occupancy.name());
    for corner in things::BOXES {
        let (half_s, most_s) = cleared_after(bench.house(2), &settings, corner)?;
        write!(row, " {half_s:.1}, {most_s:.1} |")?;
    }
    let mut latency = latencies(bench.house(3), &settings)?;
    write!(row, " {:.1} | {:.1} |", median(&mut latency.free_s), 100.0 * latency.missed_share())?;
    Ok(row)
}

fn main() -> anyhow::Result<()> {
    println!("{HEADER}\n|---|---|---|---|---|---|---|---|");
    for bench in BENCHES {
        for occupancy in [OccupancyChoice::steady(), OccupancyChoice::naive()] {
            println!("{}", row(bench, occupancy)?);
        }
    }
    println!();
    let points = curve::sweep()?;
    println!("| misses to free | false changes | half cleared |\n|---|---|---|");
    for point in &points {
        println!("| {} | {:.1} | {:.2} |", point.misses_to_free, point.false_changes, point.half_cleared_s);
    }
    curve::draw(&points, concat!(env!("CARGO_MANIFEST_DIR"), "/docs/flicker.svg"))
}
