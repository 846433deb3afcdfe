//! One mapper update with everything on: projection, footprint, occupancy, change statistics and
//! the features. `naive` walks every beam; its time is the measure for `steady`.

#[path = "../tests/house/mod.rs"]
mod house;

use divan::Bencher;
use house::House;
use mapper::{Mapper, MapperSettings, OccupancyModel};

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 2000, args = [(OccupancyModel::Steady, 360), (OccupancyModel::Naive, 360),
                       (OccupancyModel::Steady, 720), (OccupancyModel::Naive, 720)])]
fn update(bencher: Bencher, (occupancy, beams): (OccupancyModel, usize)) {
    let mut house = House::new(0.1, 0.0, 0.0, beams, 1);
    let readings: Vec<_> = (0..2000)
        .map(|reading| {
            let time_s = f64::from(reading) * 0.1;
            house.reading(time_s, house.tour(time_s), &[])
        })
        .collect();
    let settings = MapperSettings { occupancy, ..MapperSettings::default() };
    let mut mapper = Mapper::new(&settings, house.frame).unwrap();
    let mut next = 0;
    let mut laps = 0.0;
    bencher.bench_local(|| {
        let mut reading = readings[next].clone();
        reading.time_s += laps;
        next += 1;
        if next == readings.len() {
            (next, laps) = (0, laps + 200.0);
        }
        mapper.update(&reading).unwrap();
        mapper.features()
    });
}
