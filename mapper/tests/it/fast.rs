//! Things that come and go every second, from the first scan on.

use crate::house::{House, Thing, rectangle};
use interfaces::{Cell, CellState};
use mapper::{Mapper, MapperSettings};
use proptest::prelude::*;

const PERIOD_S: f64 = 0.1;
const RUN_S: f64 = 40.0;

/// A box that comes and goes every `dwell_s`: a square wave.
#[derive(Clone, Copy)]
struct SquareWave {
    dwell_s: f64,
    phase_s: f64,
    /// The box is away before.
    from_s: f64,
}

impl SquareWave {
    /// The times at which the box comes.
    fn starts_s(self) -> impl Iterator<Item = f64> {
        let start_s = move |cycle: i32| self.from_s - self.phase_s + 2.0 * self.dwell_s * f64::from(cycle);
        (0..).map(start_s).take_while(move |start_s| *start_s < self.from_s + RUN_S)
    }

    fn cycle_rate(self) -> f64 {
        0.5 / self.dwell_s
    }

    /// The mapper after `RUN_S` of the wave, and the number of times that the state of each cell changed.
    fn watch(self) -> (Mapper, Vec<u32>) {
        let mut house = House::new(0.1, 0.0, 0.01, 720, 2);
        for start_s in self.starts_s() {
            let corners = rectangle(1.5, 3.0, 1.9, 3.4);
            house.add(Thing { corners, from_s: start_s.max(self.from_s), until_s: start_s + self.dwell_s });
        }
        let mut mapper = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
        let mut changes = vec![0; house.frame.len()];
        for scan in 0..((self.from_s + RUN_S) / PERIOD_S) as u32 {
            let time_s = f64::from(scan) * PERIOD_S;
            mapper.update(&house.reading(time_s, interfaces::pose(3.0, 2.0, 0.0), &[])).unwrap();
            changed(&mapper).for_each(|index| changes[index] += 1);
        }
        (mapper, changes)
    }

    /// The mean rate over the cells on the two sides of the box that the laser sees.
    fn rate(self) -> f64 {
        let (mapper, _) = self.watch();
        let cell = |x, y| mapper.frame().index(Cell::new(x, y)).unwrap();
        let sides = (30..38).map(|x| cell(x, 60)).chain((61..68).map(|y| cell(37, y)));
        let rates: Vec<f64> = sides.map(|index| mapper.rate(index)).collect();
        rates.iter().sum::<f64>() / rates.len() as f64
    }
}

/// The index of the cell of each known state that the last update changed. A correction goes by way of unknown.
fn changed(mapper: &Mapper) -> impl Iterator<Item = usize> {
    let known = mapper.transitions().iter().filter(|transition| transition.before != CellState::Unknown);
    known.filter_map(|transition| mapper.frame().index(transition.cell))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// 8 scans pass a cell until the cell is free: a dwell of 0.8 s at 10 Hz is the shortest that the mapper can see.
    #[test]
    fn the_rates_of_fast_cells_are_right_from_the_first_scan_on(
        dwell_s in 0.82f64..1.2, phase in 0.0f64..2.0, still_s in prop_oneof![Just(0.0), 0.0f64..3.0],
    ) {
        let wave = SquareWave { dwell_s, phase_s: phase * dwell_s, from_s: still_s };
        let (found, expected) = (wave.rate(), wave.cycle_rate() * RUN_S / (still_s + RUN_S));
        prop_assert!((found / expected - 1.0).abs() < 0.1, "{found} Hz, not {expected}");
    }
}

#[test]
fn a_wrong_first_sighting_is_corrected_without_being_counted() {
    let mut house = House::new(0.1, 0.0, 0.0, 720, 2);
    house.add(Thing { corners: rectangle(1.5, 3.0, 1.9, 3.4), from_s: -1.0, until_s: 0.25 });
    let mut mapper = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
    let mut corrected = 0;
    for scan in 0..100 {
        let time_s = f64::from(scan) * PERIOD_S;
        mapper.update(&house.reading(time_s, interfaces::pose(3.0, 2.0, 0.0), &[])).unwrap();
        corrected += changed(&mapper).count();
    }
    assert!(corrected >= 10, "the ghost was on the map: {corrected} cells");
    assert_eq!(mapper.changed().count(), 0);
    let map_changes = (0..house.frame.len()).map(|index| mapper.map_changes(index) as usize);
    assert_eq!(map_changes.sum::<usize>(), corrected);
}

#[test]
fn the_changes_of_the_map_are_counted_with_their_corrections() {
    let wave = SquareWave { dwell_s: 0.9, phase_s: 0.2, from_s: 0.0 };
    let (mapper, changes) = wave.watch();
    let counted: Vec<u32> = (0..changes.len()).map(|index| mapper.map_changes(index)).collect();
    assert_eq!(counted, changes);
    let events: u32 = (0..changes.len()).map(|index| mapper.statistics(index).events()).sum();
    let corrections = changes.iter().sum::<u32>() - events;
    assert!((1..100).contains(&corrections), "{corrections} corrections");
}
