//! One scan through the localizer (undo the sweep, match, judge, learn), and through the mapper: the reference. Compare
//! the two within one run, since machines differ: the localizer takes about as long as the mapper. A search in the whole
//! map (branch and bound) is the start at an unknown pose.

#[path = "../../mapper/tests/house/mod.rs"]
mod house;

use divan::Bencher;
use house::House;
use interfaces::{CellState, Grid, LaserReading, Purpose, RandomStream};
use localizer::{Localizer, LocalizerSettings, Start};
use mapper::{Mapper, MapperSettings};

/// The number of scans in a round; the next round repeats them at later times.
const SCANS: u32 = 1450;
const PERIOD_S: f64 = 0.1;

fn main() {
    divan::main();
}

/// A round through the house with 1 cm of range noise, and a drifting odometry.
fn readings(house: &mut House) -> Vec<LaserReading> {
    let mut random = RandomStream::new(100, Purpose::OdometryNoise(0));
    let (mut odometry, mut before) = (house.tour(0.0), house.tour(0.0));
    let mut readings = Vec::new();
    for scan in 0..SCANS {
        let time_s = f64::from(scan) * PERIOD_S;
        let pose = house.tour(time_s);
        let mut reading = house.reading(time_s, pose, &[]);
        odometry *=
            before.inv_mul(&pose) * interfaces::pose(0.002 * random.normal(), 0.0, 0.003 * random.normal());
        reading.pose = odometry;
        before = pose;
        readings.push(reading);
    }
    readings
}

#[divan::bench(sample_count = 2900, sample_size = 1, args = [360, 720])]
fn localize(bencher: Bencher, beams: usize) {
    let mut house = House::new(0.1, 7.0, 0.01, beams, 1);
    let mut readings = readings(&mut house);
    // As in the loop, the map knows the rooms.
    let mut map = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
    for reading in &readings {
        map.update(&LaserReading { pose: house.tour(reading.time_s), ..reading.clone() }).unwrap();
    }
    let mut localizer =
        Localizer::from_nothing(&LocalizerSettings::default(), &house.frame, house.tour(0.0)).unwrap();
    let mut next = 0;
    bencher.bench_local(|| {
        let localized = localizer.localize(&readings[next], &map);
        readings[next].time_s += f64::from(SCANS) * PERIOD_S;
        next = (next + 1) % readings.len();
        localized.estimate
    });
}

#[divan::bench(sample_count = 2900, sample_size = 1, args = [360, 720])]
fn map(bencher: Bencher, beams: usize) {
    let mut house = House::new(0.1, 7.0, 0.01, beams, 1);
    let mut readings = readings(&mut house);
    let mut map = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
    let mut next = 0;
    bencher.bench_local(|| {
        let time_s = readings[next].time_s;
        readings[next].pose = house.tour(time_s);
        map.update(&readings[next]).unwrap();
        readings[next].time_s += f64::from(SCANS) * PERIOD_S;
        next = (next + 1) % readings.len();
    });
}

#[divan::bench(sample_count = 20, sample_size = 1)]
fn find_anywhere(bencher: Bencher) {
    let mut house = House::new(0.1, 7.0, 0.01, 360, 1);
    let mut map = Grid::filled(house.frame, CellState::Free);
    for index in (0..house.frame.len()).filter(|index| house.truth(*index, 0.0) != CellState::Free) {
        map.cells_mut()[index] = CellState::Blocked;
    }
    let reading = house.reading(0.0, house.tour(30.0), &[]);
    bencher
        .with_inputs(|| Localizer::in_map(&LocalizerSettings::default(), &map, Start::Unknown).unwrap())
        .bench_local_values(|mut localizer| localizer.localize(&reading, &map).estimate);
}
