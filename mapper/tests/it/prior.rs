//! Starting from a known map.

use crate::house::{House, Thing, rectangle};
use crate::observed::{assert_sound, changes};
use interfaces::{CellState, Event, Grid};
use mapper::{Mapper, MapperSettings, OccupancyChoice};

/// A prior map of a house: with a box that has been removed since, and without a box that has appeared since.
fn prior(house: &House) -> Grid<CellState> {
    let cells = (0..house.frame.len()).map(|index| house.truth(index, 0.0)).collect();
    Grid::from_cells(house.frame, cells).unwrap()
}

fn house() -> House {
    let mut house = House::new(0.1, 0.0, 0.0, 360, 3);
    house.add(Thing { corners: rectangle(1.5, 3.0, 1.9, 3.4), from_s: -1.0, until_s: 0.05 });
    house.add(Thing { corners: rectangle(4.0, 3.0, 4.4, 3.4), from_s: 0.05, until_s: 1e9 });
    house
}

#[test]
fn the_map_starts_as_given() {
    let house = house();
    for occupancy in [OccupancyChoice::steady(), OccupancyChoice::naive()] {
        let settings = MapperSettings { occupancy, ..MapperSettings::default() };
        let mapper = Mapper::with_prior(&settings, prior(&house)).unwrap();
        assert_eq!(mapper.states(), &prior(&house));
        assert!((0..house.frame.len()).all(|index| !mapper.was_ever_seen(index)));
        assert_sound(&mapper);
    }
}

#[test]
fn changes_are_found_against_it_and_nothing_else() {
    let mut house = house();
    let mut mapper = Mapper::with_prior(&MapperSettings::default(), prior(&house)).unwrap();
    let (mut went, mut came) = (0, 0);
    for scan in 1..=50 {
        let reading = house.reading(f64::from(scan) * 0.1, interfaces::pose(3.0, 2.0, 0.0), &[]);
        mapper.update(&reading).unwrap();
        for transition in mapper.transitions() {
            let place = house.frame.center(transition.cell);
            let (left_m, count) = match transition.event() {
                Some(Event::Free) => (1.5, &mut went),
                Some(Event::Block) => (4.0, &mut came),
                None => continue,
            };
            let is_box = (left_m..left_m + 0.4).contains(&place.x) && (3.0..3.4).contains(&place.y);
            assert!(is_box, "{place} changed");
            *count += 1;
        }
    }
    assert_eq!(went, 64, "all of the box that went");
    assert!(came >= 8, "the near sides of the box that came: {came}");
    // These changes were not in view.
    for index in mapper.changed() {
        let seen = mapper.statistics(index);
        assert_eq!((seen.block_events + seen.free_events, seen.events()), (0, 1), "{seen:?}");
    }
    assert_sound(&mapper);
}

#[test]
fn a_wall_of_the_prior_does_not_flicker() {
    let mut house = House::new(0.1, 0.0, 0.01, 360, 5);
    let mut mapper = Mapper::with_prior(&MapperSettings::default(), prior(&house)).unwrap();
    for scan in 0..300 {
        let time_s = f64::from(scan) * 0.1;
        mapper.update(&house.reading(time_s, house.tour(time_s), &[])).unwrap();
        assert_eq!(changes(&mapper).next(), None, "at {time_s} s");
    }
}
