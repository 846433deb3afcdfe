//! The flicker study: how often does a static wall change in the map, and what does it cost to prevent this? Writes
//! the rows of the tables of `docs/flicker.md`, and draws `docs/flicker.svg`.
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
use serde::Serialize;
use things::{cleared_after, latencies, median};

const SCANS: u32 = 6000;
const PERIOD_S: f64 = 0.1;

const ROWS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/results/flicker.csv");
const CURVE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/results/flicker_curve.csv");

/// The results of an occupancy model in a house.
#[derive(Debug, Default, Serialize)]
struct Row {
    house: &'static str,
    map: &'static str,
    false_changes: usize,
    /// The false changes that were not the first one of their cell.
    repeated: usize,
    /// The times until half and nine tenths of the cells of a removed box are free: in the open, and at a wall.
    open_half_s: f64,
    open_most_s: f64,
    wall_half_s: f64,
    wall_most_s: f64,
    /// The median time from the first beam that shows a cell as free to the change of the map.
    free_s: f64,
    missed: f64,
}

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

fn row(bench: Bench, occupancy: &OccupancyChoice) -> anyhow::Result<Row> {
    let settings = bench.settings(occupancy.clone());
    let (house, readings) = bench.tour(1);
    let (false_changes, repeated) = false_changes(&house, &readings, &settings)?;
    let cleared = |corner| cleared_after(bench.house(2), &settings, corner);
    let [(open_half_s, open_most_s), (wall_half_s, wall_most_s)] =
        [cleared(things::BOXES[0])?, cleared(things::BOXES[1])?];
    let mut latency = latencies(bench.house(3), &settings)?;
    let (house, map) = (bench.name, occupancy.name());
    let (free_s, missed) = (median(&mut latency.free_s), latency.missed_share());
    Ok(Row {
        house,
        map,
        false_changes,
        repeated,
        open_half_s,
        open_most_s,
        wall_half_s,
        wall_most_s,
        free_s,
        missed,
    })
}

fn write<R: Serialize>(path: &str, rows: &[R]) -> anyhow::Result<()> {
    let mut writer = csv::Writer::from_path(path)?;
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(writer.flush()?)
}

fn main() -> anyhow::Result<()> {
    let mut rows = Vec::new();
    for bench in BENCHES {
        for occupancy in [OccupancyChoice::steady(), OccupancyChoice::naive()] {
            let row = row(bench, &occupancy)?;
            println!("{row:?}");
            rows.push(row);
        }
    }
    write(ROWS, &rows)?;
    let points = curve::sweep()?;
    write(CURVE, &points)?;
    curve::draw(&points, concat!(env!("CARGO_MANIFEST_DIR"), "/docs/flicker.svg"))
}
