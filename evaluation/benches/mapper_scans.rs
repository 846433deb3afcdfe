//! One mapper update with all parts: projection, footprint, occupancy, change statistics and features. The model
//! `naive` follows every beam cell by cell; its time on the same scans is the reference for `steady`. Compare the
//! two within one run, since machines differ: `steady` takes about a fifth of the time. A part of the difference is
//! that `naive` flickers, and the time of the features is proportional to the number of cells that ever changed. The last of the arguments: with a clock for every tile in which something changes.

#[path = "../../mapper/tests/house/mod.rs"]
mod house;

use divan::Bencher;
use house::House;
use interfaces::LaserReading;
use mapper::{EstimatorChoice, Mapper, MapperSettings, OccupancyChoice};

/// The number of scans in a round; the next round repeats them at later times.
const SCANS: u32 = 2000;
const PERIOD_S: f64 = 0.1;

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 4000, sample_size = 1, args = [
    ("steady", "shared-prior", 360, false), ("steady", "shared-prior", 360, true), ("steady", "two-state-gaps", 360, false),
    ("naive", "shared-prior", 360, false), ("steady", "shared-prior", 720, false), ("steady", "shared-prior", 720, true),
    ("steady", "two-state-gaps", 720, false), ("naive", "shared-prior", 720, false)])]
fn update(bencher: Bencher, (occupancy, estimator, beams, clocks): (&str, &str, usize, bool)) {
    let occupancy = OccupancyChoice::named(occupancy).unwrap();
    let estimator = EstimatorChoice::named(estimator).unwrap();
    let mut house = House::new(0.1, 0.0, 0.0, beams, 1);
    let mut readings: Vec<LaserReading> = (0..SCANS)
        .map(|scan| f64::from(scan) * PERIOD_S)
        .map(|time_s| house.reading(time_s, house.tour(time_s), &[]))
        .collect();
    let settings = MapperSettings { occupancy, estimator, clocks, ..MapperSettings::default() };
    let mut mapper = Mapper::new(&settings, house.frame).unwrap();
    let mut next = 0;
    bencher.bench_local(|| {
        let updated =
            mapper.update(&readings[next]).map(|()| (mapper.sum_change_probability(), mapper.max_recency()));
        readings[next].time_s += f64::from(SCANS) * PERIOD_S; // for the next round
        next = (next + 1) % readings.len();
        updated.unwrap()
    });
}
