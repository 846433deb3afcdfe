//! Readings of a broken sensor: they are refused without a change of the maps, or used with their defined meaning.

use crate::house::{House, Thing, rectangle};
use crate::observed::{Observed, assert_sound};
use interfaces::{CellState, Grid, GridFrame, LaserReading, Scan, ScanError};
use mapper::{Mapper, MapperSettings, OccupancyChoice, ReadingError, SurfaceGridSettings};
use nalgebra::{Isometry2, Point2, Translation2, UnitComplex};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const BEAMS: usize = 90;

fn mapper(occupancy: OccupancyChoice) -> Mapper {
    let frame = GridFrame::new(Point2::origin(), 0.1, 40, 40).unwrap();
    Mapper::new(&MapperSettings { occupancy, ..MapperSettings::default() }, frame).unwrap()
}

/// A round room of 1.5 m around the middle of the map.
fn reading(time_s: f64) -> LaserReading {
    let mut reading = crate::house::scan(time_s, interfaces::pose(2.0, 2.0, 0.3), -PI, vec![1.5; BEAMS]);
    (reading.scan.range_min_m, reading.scan.range_max_m) = (0.1, 5.0);
    reading
}

fn edited(edit: impl FnOnce(&mut LaserReading)) -> LaserReading {
    let mut reading = reading(10.0);
    edit(&mut reading);
    reading
}

/// A mapper that has observed the room.
fn learned(occupancy: OccupancyChoice) -> Mapper {
    let mut mapper = mapper(occupancy);
    for scan in 0..20 {
        mapper.update(&reading(f64::from(scan) * 0.1)).unwrap();
    }
    mapper
}

/// The complete state of the mapper, including internal values.
fn inside(mapper: &Mapper) -> String {
    format!("{mapper:?}")
}

#[test]
fn nonsense_is_refused_and_changes_nothing() {
    let not_unit = UnitComplex::from_cos_sin_unchecked(0.0, 0.0);
    let turned = UnitComplex::from_cos_sin_unchecked(f64::NAN, 0.0);
    let at = |x, y| Isometry2::from_parts(Translation2::new(x, y), UnitComplex::identity());
    let time = |time: f64| (edited(|r| r.time_s = time), "time");
    let pose = |pose: Isometry2<f64>| (edited(|r| r.pose = pose), "pose");
    let mount = |mount: Isometry2<f64>| (edited(|r| r.mount = mount), "pose");
    let cases = [
        time(f64::NAN),
        time(f64::INFINITY),
        time(f64::NEG_INFINITY),
        time(1.8),
        time(-1.0),
        pose(at(f64::NAN, 0.0)),
        pose(at(0.0, f64::INFINITY)),
        pose(at(1e300, 0.0)),
        pose(at(0.0, -1e308)),
        pose(Isometry2::from_parts(Translation2::new(1.0, 1.0), turned)),
        pose(Isometry2::from_parts(Translation2::new(1.0, 1.0), not_unit)),
        mount(at(f64::NAN, 0.0)),
        mount(at(1e300, 0.0)),
        mount(Isometry2::from_parts(Translation2::new(1.0, 1.0), turned)),
        (edited(|r| r.scan.angle_min_rad = f64::NAN), "angle"),
        (edited(|r| r.scan.angle_increment_rad = f64::INFINITY), "angle"),
        (edited(|r| r.scan.angle_increment_rad = 0.0), "sweep"),
        (edited(|r| r.scan.ranges_m.resize(2 * BEAMS, 1.0)), "sweep"),
        (edited(|r| r.scan.range_max_m = f64::INFINITY), "limits"),
        (edited(|r| r.scan.range_max_m = 0.05), "limits"),
        (edited(|r| r.scan.range_min_m = -1.0), "limits"),
        (edited(|r| r.scan.range_min_m = f64::NAN), "limits"),
        (edited(|r| r.scan.sweep_s = -0.1), "duration"),
    ];
    for occupancy in [OccupancyChoice::steady(), OccupancyChoice::naive()] {
        let mut mapper = learned(occupancy);
        let before = inside(&mapper);
        for (number, (reading, why)) in cases.iter().enumerate() {
            let found = match mapper.update(reading) {
                Err(ReadingError::Time { .. }) => "time",
                Err(ReadingError::Pose { .. }) => "pose",
                Err(ReadingError::Scan(ScanError::Angle { .. })) => "angle",
                Err(ReadingError::Scan(ScanError::Sweep { .. })) => "sweep",
                Err(ReadingError::Scan(ScanError::Limits { .. })) => "limits",
                Err(ReadingError::Scan(ScanError::Duration { .. })) => "duration",
                Ok(()) => "taken",
            };
            assert_eq!(found, *why, "case {number}");
            assert!(inside(&mapper) == before, "case {number} left a trace");
        }
    }
}

/// The cells that a beam along +x from (2, 2) changes, drawn from the sensor to the border.
fn along_first_beam(range_m: f32) -> String {
    let mut mapper = mapper(OccupancyChoice::steady());
    for scan in 0..30 {
        let mut reading = reading(f64::from(scan) * 0.1);
        reading.pose = interfaces::pose(2.05, 2.05, 0.0);
        reading.scan.angle_min_rad = 0.0;
        reading.scan.range_max_m = 1.22;
        reading.scan.ranges_m = vec![range_m; BEAMS];
        mapper.update(&reading).unwrap();
    }
    (20..40)
        .map(|x| match mapper.states().cells()[20 * 40 + x] {
            CellState::Unknown => ' ',
            CellState::Free => '.',
            CellState::Blocked => '#',
        })
        .collect()
}

#[test]
fn ranges_mean_what_rep_117_says() {
    assert_eq!(along_first_beam(1.0), "..........#         ");
    assert_eq!(along_first_beam(f32::INFINITY), ".............       ", "clear up to range_max");
    for nothing in [f32::NAN, f32::NEG_INFINITY, 0.05, -1.0, 1.3] {
        assert_eq!(along_first_beam(nothing), " ".repeat(20), "{nothing}");
    }
}

#[test]
fn a_reading_may_repeat_the_last_time() {
    let mut mapper = learned(OccupancyChoice::steady());
    mapper.update(&reading(mapper.time())).unwrap();
    assert_sound(&mapper);
}

/// Scans that are unusual but valid.
#[test]
fn odd_scans_are_taken() {
    const FAR_M: f64 = 1e5;
    type Case = (&'static str, fn(&mut LaserReading));
    let cases: [Case; 12] = [
        ("no beams", |r| r.scan.ranges_m.clear()),
        ("one beam", |r| r.scan.ranges_m.truncate(1)),
        ("one beam, no increment", |r| {
            r.scan.ranges_m.truncate(1);
            r.scan.angle_increment_rad = 0.0;
        }),
        ("two beams", |r| r.scan.ranges_m.truncate(2)),
        ("beams that all but coincide", |r| r.scan.angle_increment_rad = f64::MIN_POSITIVE),
        ("beams very near to each other", |r| r.scan.angle_increment_rad = 1e-9),
        ("clockwise", |r| r.scan.angle_increment_rad *= -1.0),
        ("many turns before the first beam", |r| r.scan.angle_min_rad = 1e12),
        ("a range of 0", |r| {
            r.scan.range_min_m = 0.0;
            r.scan.ranges_m.fill(0.0);
        }),
        ("endless range", |r| {
            r.scan.range_max_m = f64::MAX;
            r.scan.ranges_m.fill(f32::INFINITY);
        }),
        ("far away", |r| r.pose = interfaces::pose(FAR_M, -FAR_M, 1.0)),
        ("far away, with a mount that leads back", |r| {
            r.pose = interfaces::pose(FAR_M, 0.0, 0.0);
            r.mount = interfaces::pose(2.0 - FAR_M, 2.0, 0.0);
        }),
    ];
    for occupancy in [OccupancyChoice::steady(), OccupancyChoice::naive()] {
        for (name, edit) in &cases {
            let mut mapper = learned(occupancy.clone());
            for scan in 0..30 {
                let mut reading = reading(3.0 + f64::from(scan) * 0.1);
                edit(&mut reading);
                assert_eq!(mapper.update(&reading), Ok(()), "{name}");
            }
            assert_sound(&mapper);
        }
    }
}

/// With the sensor outside of the grid, the map is filled as if the grid were larger.
#[test]
fn a_laser_outside_of_the_grid_sees_into_it() {
    let mut house = House::new(0.1, 0.0, 0.0, 360, 1);
    let whole = house.frame;
    let part = GridFrame::new(Point2::new(4.0, 1.0), 0.05, 40, 40).unwrap(); // inside of the lower left room
    let settings = MapperSettings::default();
    let (mut outside, mut inside) =
        (Mapper::new(&settings, part).unwrap(), Mapper::new(&settings, whole).unwrap());
    for scan in 0..100 {
        let time_s = f64::from(scan) * 0.1;
        let reading = house.reading(time_s, interfaces::pose(1.5, 2.0 + 0.1 * time_s, 0.0), &[]);
        outside.update(&reading).unwrap();
        inside.update(&reading).unwrap();
    }
    let mut free = 0;
    for index in 0..part.len() {
        let cell = whole.cell_at(&part.center(part.cell(index)));
        assert_eq!(Some(&outside.states().cells()[index]), inside.states().get(cell), "{cell:?}");
        free += usize::from(outside.states().cells()[index] == CellState::Free);
    }
    assert!(free > 1500, "{free} cells of the room are seen");
}

#[test]
fn settings_that_contradict_are_refused() {
    let with = |edit: fn(&mut SurfaceGridSettings)| {
        let mut settings = MapperSettings::default();
        edit(&mut settings.steady);
        let frame = GridFrame::new(Point2::origin(), 0.1, 4, 4).unwrap();
        Mapper::new(&settings, frame).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(with(|_| {}), Ok(()));
    let refused = |what: &str| Err(format!("mapper setting `steady.{what}"));
    assert_eq!(with(|s| s.misses_to_free = 0), refused("misses_to_free` must be from 1 to 100, not 0"));
    assert_eq!(
        with(|s| s.range_noise_std_m = f64::NAN),
        refused("range_noise_std_m` must be from 0 to 0.5 m, not NaN")
    );
    assert_eq!(
        with(|s| s.misses_to_free_fresh = 50),
        refused("misses_to_free_fresh` must be from 1 to steady.misses_to_free, not 50")
    );
}

#[test]
fn a_prior_map_that_needs_too_much_memory_is_refused_before_it_is_allocated() {
    let frame = |side| GridFrame::new(Point2::origin(), 0.05, side, side).unwrap();
    // A frame alone needs little: 1 km².
    let mapper = Mapper::new(&MapperSettings::default(), frame(20_000)).unwrap();
    assert!(mapper.bytes() < 70 << 20, "{} bytes", mapper.bytes());
    let prior = Grid::filled(frame(100), CellState::Free);
    let settings = |max_bytes| MapperSettings { max_bytes, ..MapperSettings::default() };
    assert!(Mapper::with_prior(&settings(1 << 20), prior.clone()).is_ok());
    let error = Mapper::with_prior(&settings(1 << 18), prior).unwrap_err().to_string();
    let expected = "mapper setting `prior` must be a map that fits into the memory that the mapper may take (max_bytes), not 10000 known \
                    cells, which need 0.0003 GiB of 0.0002 GiB";
    assert_eq!(error, expected);
}

/// Every setting at its limits, in a house where a box appears and disappears.
#[test]
fn lawful_settings_are_lived_with() {
    let edits: [fn(&mut SurfaceGridSettings); 8] = [
        |s| s.range_noise_std_m = 0.0,
        |s| s.range_noise_std_m = 0.5,
        |s| (s.hits_to_block_in_open, s.misses_to_free, s.misses_to_free_fresh) = (1, 1, 1),
        |s| (s.hits_to_block_in_open, s.misses_to_free, s.misses_to_free_fresh) = (100, 100, 100),
        |s| (s.range_noise_std_m, s.misses_to_free, s.misses_to_free_fresh) = (0.5, 1, 1),
        |s| (s.range_noise_std_m, s.misses_to_free, s.misses_to_free_fresh) = (0.0, 100, 100),
        |s| (s.misses_to_free, s.misses_to_free_fresh) = (100, 1),
        |s| s.hits_to_block_in_open = 100,
    ];
    for (number, edit) in edits.into_iter().enumerate() {
        let mut house = House::new(0.1, 10.0, 0.01, 90, 1);
        house.add(Thing { corners: rectangle(4.0, 3.0, 4.4, 3.4), from_s: 3.0, until_s: 6.0 });
        let mut settings = MapperSettings::default();
        edit(&mut settings.steady);
        let mut mapper = Mapper::new(&settings, house.frame).unwrap();
        for scan in 0..100 {
            let time_s = f64::from(scan) * 0.1;
            let taken = mapper.update(&house.reading(time_s, house.tour(time_s), &[]));
            assert_eq!(taken, Ok(()), "case {number}");
        }
        assert_sound(&mapper);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Any bits as ranges, from any pose: accepted, with the same result twice.
    #[test]
    fn any_ranges_are_taken(
        scans in prop::collection::vec(
            (prop::collection::vec(prop_oneof![any::<u32>().prop_map(f32::from_bits), 0.0..6.0f32], 0..=BEAMS),
             -1.0..5.0f64, -1.0..5.0f64, -PI..PI, any::<bool>()),
            1..12),
        occupancy in prop::sample::select(vec![OccupancyChoice::steady(), OccupancyChoice::naive()]),
    ) {
        let mut mappers = [mapper(occupancy.clone()), mapper(occupancy)];
        for (number, (ranges_m, x_m, y_m, heading_rad, repeated)) in scans.into_iter().enumerate() {
            let mut reading = reading(number as f64 * 0.1);
            reading.scan.range_min_m = 0.0;
            reading.scan.ranges_m = ranges_m;
            reading.pose = interfaces::pose(x_m, y_m, heading_rad);
            for _ in 0..if repeated { 15 } else { 1 } {
                for mapper in &mut mappers {
                    prop_assert_eq!(mapper.update(&reading), Ok(()));
                }
            }
            assert_sound(&mappers[0]);
            prop_assert!(Observed::of(&mappers[0]) == Observed::of(&mappers[1]));
        }
    }
}

/// An angle that a driver may send.
fn any_angle() -> impl Strategy<Value = f64> {
    let special =
        [0.0, TAU, -TAU, PI, -PI, TAU / 3.0, TAU / 4.0, 1e-300, 1e-9, f64::MIN_POSITIVE, 1e300, f64::NAN];
    prop_oneof![prop::sample::select(special.to_vec()), -10.0..10.0]
}

fn any_range() -> impl Strategy<Value = f32> {
    let special =
        [0.0, -0.0, -1.0, 0.1, 5.0, 1e-30, 1e30, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    prop_oneof![prop::sample::select(special.to_vec()), 0.0f32..6.0]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn few_beams_at_any_angle_never_make_it_panic(
        occupancy in prop::sample::select(vec![OccupancyChoice::steady(), OccupancyChoice::naive()]),
        angle_min_rad in any_angle(),
        angle_increment_rad in any_angle(),
        limits_m in prop::sample::select(vec![[0.0, 5.0], [0.1, 1e6], [0.0, 1e300], [4.9, 5.0]]),
        scans in prop::collection::vec(prop::collection::vec(any_range(), 0..=5), 1..4),
    ) {
        let mut mapper = learned(occupancy);
        for (number, ranges_m) in scans.into_iter().enumerate() {
            let mut reading = reading(10.0 + number as f64);
            let [range_min_m, range_max_m] = limits_m;
            reading.scan = Scan {
                angle_min_rad,
                angle_increment_rad,
                range_min_m,
                range_max_m,
                sweep_s: 0.0,
                ranges_m,
            };
            let before = mapper.readings();
            let is_taken = mapper.update(&reading).is_ok();
            prop_assert_eq!(mapper.readings(), before + usize::from(is_taken));
        }
    }
}
