//! The memory of the map of a large place, as the operating system counts it. One test, in a process of its own.

mod house;

use interfaces::{GridFrame, LaserReading};
use mapper::{Mapper, MapperSettings, SharedPrior};
use nalgebra::Point2;
use std::f64::consts::TAU;

/// The corners of two rooms, m: in the outline of 1 km², almost nothing else is seen.
const ROOMS_M: [f64; 2] = [1.0, 959.0];
const SIDE_M: f64 = 40.0;
const SCANS: u32 = 30;

/// A reading in an empty square room; `offset` is the position from the middle of the room, m.
fn reading(room_m: f64, offset: [f64; 2], time_s: f64) -> LaserReading {
    const BEAMS: usize = 3000;
    let half = SIDE_M / 2.0;
    let range_m = |beam: usize| {
        let angle = TAU * beam as f64 / BEAMS as f64;
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let along =
            |at: f64, step: f64| if step == 0.0 { f64::INFINITY } else { (half * step.signum() - at) / step };
        along(offset[0], cos).min(along(offset[1], sin)) as f32
    };
    let middle = room_m + half;
    let pose = interfaces::pose(middle + offset[0], middle + offset[1], 0.0);
    let mut reading = house::scan(time_s, pose, 0.0, (0..BEAMS).map(range_m).collect());
    reading.scan.range_max_m = 60.0;
    reading
}

/// A reading in the middle of a round room, m.
fn round(radius_m: f64, time_s: f64) -> LaserReading {
    let mut reading = reading(0.0, [0.0; 2], time_s);
    reading.scan.ranges_m.fill(radius_m as f32);
    reading
}

/// The resident memory of this process, bytes; `None` where the operating system does not say it.
fn resident() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(pages.split(' ').nth(1)?.parse::<usize>().ok()? * 4096)
}

/// One after the other: the memory is that of the process.
#[test]
fn a_large_place_takes_the_memory_of_what_was_seen() {
    cells_that_change_take_little_more_memory();
    two_rooms_a_kilometer_apart_take_the_memory_of_two_rooms();
    a_full_map_goes_on_where_it_is();
}

fn two_rooms_a_kilometer_apart_take_the_memory_of_two_rooms() {
    let before = resident();
    let frame = GridFrame::new(Point2::origin(), 0.05, 20_000, 20_000).unwrap();
    let settings = MapperSettings { estimator: SharedPrior.into(), ..MapperSettings::default() };
    let mut mapper = Mapper::new(&settings, frame).unwrap();
    let outline = mapper.bytes();
    assert!(outline < 80 << 20, "the outline alone takes {outline} bytes");
    let mut time_s = 0.0;
    // Every cell is seen, is out of view while the robot is in the other room, and is seen again.
    for room_m in ROOMS_M.repeat(2) {
        for scan in 0..SCANS {
            time_s += 0.5;
            let angle = TAU * f64::from(scan) / f64::from(SCANS);
            let offset = [5.0 * libm::cos(angle), 5.0 * libm::sin(angle)];
            mapper.update(&reading(room_m, offset, time_s)).unwrap();
        }
    }
    let (seen, changed) = (mapper.seen().count(), mapper.changed().count());
    assert!(seen > 1_250_000 && changed == 0, "{seen} cells seen, {changed} changed");
    let per_cell = (mapper.bytes() - outline) as f64 / seen as f64;
    println!("{per_cell:.1} bytes per cell by Mapper::bytes");
    assert!(per_cell <= Mapper::BYTES_PER_SEEN_CELL as f64, "{per_cell} bytes per cell");
    if let Some((before, after)) = before.zip(resident()) {
        let (resident, counted) = (after - before, mapper.bytes());
        println!("{resident} bytes are resident, {counted} by Mapper::bytes with the outline");
        assert!(resident as f64 <= 1.1 * counted as f64, "{resident} bytes resident, {counted} counted");
    }
}

fn a_full_map_goes_on_where_it_is() {
    let frame = GridFrame::new(Point2::origin(), 0.05, 20_000, 20_000).unwrap();
    let mut settings = MapperSettings::default();
    let mut mapper = Mapper::new(&settings, frame).unwrap();
    settings.max_bytes = mapper.bytes() + (20 << 20);
    mapper = Mapper::new(&settings, frame).unwrap();
    let see = |room_m: f64, first: u32, mapper: &mut Mapper| {
        for scan in first..first + 10 {
            mapper.update(&reading(room_m, [0.1 * f64::from(scan), 0.0], f64::from(scan))).unwrap();
        }
        mapper.seen().count()
    };
    let of_one = see(ROOMS_M[0], 0, &mut mapper);
    assert!(of_one > 600_000 && mapper.is_full(), "{of_one} cells, {} bytes", mapper.bytes());
    let full = mapper.bytes();
    // The other room is not seen; the first one still is.
    assert_eq!(see(ROOMS_M[1], 10, &mut mapper), of_one);
    assert!(see(ROOMS_M[0], 20, &mut mapper) >= of_one);
    // Its cells have a gap each now.
    assert!(mapper.bytes() < full + 70 * of_one, "{} bytes, {full} before", mapper.bytes());
    let index = frame.index(frame.cell_at(&Point2::new(21.0, 21.0))).unwrap();
    assert!(mapper.is_in_view(index) && mapper.statistics(index).unobserved > 0.0);
}

/// A round wall that comes near and goes away again, cell by cell, three times: each of its cells becomes blocked and free, and is
/// hidden in between.
fn cells_that_change_take_little_more_memory() {
    const FAR_M: f64 = 9.0;
    const NEAR_M: f64 = 5.0;
    const STEPS: u32 = 80;
    const SCANS_PER_STEP: u32 = 4;
    let frame = GridFrame::new(Point2::origin(), 0.05, 800, 800).unwrap();
    let settings = MapperSettings { estimator: SharedPrior.into(), ..MapperSettings::default() };
    let mut mapper = Mapper::new(&settings, frame).unwrap();
    let mut time_s = 0.0;
    let mut look = |mapper: &mut Mapper, radius_m: f64, scans: u32| {
        for _ in 0..scans {
            time_s += 0.1;
            mapper.update(&round(radius_m, time_s)).unwrap();
        }
    };
    let mut come_and_go = |mapper: &mut Mapper, steps: u32, cycles: u32| {
        for step in (0..steps).chain((0..steps).rev()).cycle().take((2 * steps * cycles) as usize) {
            let share = f64::from(step) / f64::from(STEPS);
            look(mapper, FAR_M + (NEAR_M - FAR_M) * share, SCANS_PER_STEP);
        }
    };
    // What a map with changes takes whatever their number, as the prior of the rates, is there after a few of them.
    come_and_go(&mut mapper, STEPS / 8, 3);
    let (still, resident_before, few) = (mapper.bytes(), resident(), mapper.changed().count());
    come_and_go(&mut mapper, STEPS, 3);
    let changed: Vec<usize> = mapper.changed().collect();
    let cycles: u32 = changed.iter().map(|&index| mapper.statistics(index).cycles()).sum();
    let count = (changed.len() - few) as f64;
    assert!(count > 50_000.0 && f64::from(cycles) > 2.0 * count, "{count} changed cells, {cycles} cycles");
    let per_cell = (mapper.bytes() - still) as f64 / count;
    println!("{per_cell:.0} bytes per changed cell by Mapper::bytes, {count} cells, {cycles} cycles");
    let seen = Mapper::BYTES_PER_SEEN_CELL as f64;
    assert!(seen + per_cell <= 410.0, "{per_cell} bytes per changed cell beside {seen} per seen cell");
    if let Some((before, after)) = resident_before.zip(resident()) {
        let resident = (after - before) as f64 / count;
        println!("{resident:.0} bytes per changed cell are resident");
        assert!(resident <= 470.0, "{resident} bytes per changed cell are resident");
    }
}
