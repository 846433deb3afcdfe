//! Bags of ROS 2: writing, opening (two passes), reading, and skipping what is no scan. Throughput is in bytes of the
//! compressed file.

use divan::Bencher;
use divan::counter::BytesCount;
use interfaces::{Grid, GridFrame, LaserReading, Purpose, RandomStream, Scan, Twist};
use logs::{Log, McapWriter, TopicChoice};
use nalgebra::Point2;
use std::f64::consts::TAU;
use std::fs;
use std::io::{BufWriter, Cursor};
use tempfile::NamedTempFile;

const SCANS: usize = 2000;
const BEAMS: usize = 720;

fn main() {
    divan::main();
}

/// Scans with noise: numbers that do not compress to nothing.
fn readings() -> Vec<LaserReading> {
    let mut random = RandomStream::new(100, Purpose::LaserNoise(0));
    let mut reading = |step: usize| LaserReading {
        time_s: step as f64 * 0.025,
        pose: interfaces::pose(step as f64 * 0.01, 0.0, 0.0),
        twist: Twist { linear_mps: 0.4, angular_radps: 0.0 },
        velocities: Vec::new(),
        mount: interfaces::pose(0.2, 0.0, 0.0),
        scan: Scan {
            angle_min_rad: 0.0,
            angle_increment_rad: TAU / BEAMS as f64,
            range_min_m: 0.1,
            range_max_m: 20.0,
            sweep_s: 0.0,
            ranges_m: (0..BEAMS)
                .map(|beam| (5.0 + (beam % 90) as f64 * 0.05 + 0.01 * random.normal()) as f32)
                .collect(),
        },
    };
    (0..SCANS).map(&mut reading).collect()
}

fn bag(write: impl FnOnce(&mut McapWriter<BufWriter<fs::File>>)) -> (NamedTempFile, BytesCount) {
    let file = NamedTempFile::new().expect("a temporary file");
    let to = BufWriter::new(file.reopen().expect("the same file"));
    let mut writer = McapWriter::new(to, "bench", 1.7e9).expect("a bag");
    write(&mut writer);
    writer.finish().expect("an end");
    let size = file.path().metadata().expect("its size").len();
    (file, BytesCount::new(size))
}

fn scans() -> (NamedTempFile, BytesCount) {
    bag(|writer| readings().iter().for_each(|reading| writer.reading(reading).expect("a reading")))
}

/// A few scans among large maps of noise.
fn maps() -> (NamedTempFile, BytesCount) {
    let mut random = RandomStream::new(101, Purpose::LaserNoise(0));
    let frame = GridFrame::new(Point2::origin(), 0.05, 1000, 1000).expect("a grid");
    let mut grid = Grid::filled(frame, 0.0);
    bag(|writer| {
        for reading in readings().iter().take(20) {
            writer.reading(reading).expect("a reading");
            (0..frame.len()).for_each(|index| grid.cells_mut()[index] = random.normal().abs() * 0.3);
            let time_s = reading.time_s * 300.0;
            writer.grid("/map", time_s, &grid, |value| Some(*value)).expect("a map");
        }
    })
}

fn open(file: &NamedTempFile) -> Log {
    Log::open(file.path(), &TopicChoice::default()).expect("a bag")
}

#[divan::bench]
fn opening(bencher: Bencher) {
    let (file, size) = scans();
    bencher.counter(size).bench(|| open(&file));
}

#[divan::bench]
fn reading(bencher: Bencher) {
    let (file, size) = scans();
    let log = open(&file);
    bencher.counter(size).bench(|| log.readings().expect("readings").map(Result::unwrap).count());
}

#[divan::bench]
fn skipping(bencher: Bencher) {
    let (file, size) = maps();
    let log = open(&file);
    bencher.counter(size).bench(|| log.readings().expect("readings").map(Result::unwrap).count());
}

#[divan::bench]
fn writing(bencher: Bencher) {
    let (readings, (_, size)) = (readings(), scans());
    bencher.counter(size).bench(|| {
        let mut writer = McapWriter::new(Cursor::new(Vec::new()), "bench", 1.7e9).expect("a bag");
        readings.iter().for_each(|reading| writer.reading(reading).expect("a reading"));
        writer.finish().expect("an end")
    });
}
