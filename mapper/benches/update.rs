//! One mapper update with everything on: projection, footprint, occupancy, change statistics and
//! the features. `Naive` walks every beam cell by cell; its time on the same scans is the measure for
//! `Steady`: compare the two of one run, since a machine's speed is its own. `Steady` takes about a fifth
//! of it. A part of that is `Naive`'s own doing: it flickers, and the features cost time in proportion to
//! the cells that ever changed.

#[path = "../tests/house/mod.rs"]
mod house;

use divan::Bencher;
use house::House;
use interfaces::LaserReading;
use mapper::{Mapper, MapperSettings, OccupancyModel};

/// Scans of one round; the next repeats them later.
const SCANS: u32 = 2000;
const PERIOD_S: f64 = 0.1;

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 4000, sample_size = 1, args = [(OccupancyModel::Steady, 360),
    (OccupancyModel::Naive, 360), (OccupancyModel::Steady, 720), (OccupancyModel::Naive, 720)])]
fn update(bencher: Bencher, (occupancy, beams): (OccupancyModel, usize)) {
    let mut house = House::new(0.1, 0.0, 0.0, beams, 1);
    let mut readings: Vec<LaserReading> = (0..SCANS)
        .map(|scan| f64::from(scan) * PERIOD_S)
        .map(|time_s| house.reading(time_s, house.tour(time_s), &[]))
        .collect();
    let settings = MapperSettings { occupancy, ..MapperSettings::default() };
    let mut mapper = Mapper::new(&settings, house.frame).unwrap();
    let mut next = 0;
    bencher.bench_local(|| {
        let updated = mapper.update(&readings[next]);
        divan::black_box((mapper.sum_change_probability(), mapper.max_recency()));
        readings[next].time_s += f64::from(SCANS) * PERIOD_S; // for the next round
        next = (next + 1) % readings.len();
        updated.unwrap()
    });
}
