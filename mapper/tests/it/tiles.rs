//! Tiles in which something changes, with their clocks: a map predicted by the hour.

use crate::cells;
use interfaces::{Cell, CellState, GridFrame};
use mapper::{Calendar, DAY_S, Mapper, MapperSettings};
use nalgebra::Point2;

const HOUR_S: f64 = 3600.0;
/// Monday, 2024-01-01, 0:00 in Berlin.
const MONDAY_S: f64 = 1_704_063_600.0;
/// A door of 10 cells, and a cell beside it that is always free.
const DOOR: std::ops::Range<i32> = 0..10;
const FLOOR: Cell = Cell { x: 12, y: 3 };

fn settings(clocks: bool, time_zone: Option<&str>) -> MapperSettings {
    MapperSettings { clocks, time_zone: time_zone.map(str::to_owned), ..MapperSettings::default() }
}

fn frame() -> GridFrame {
    GridFrame::new(Point2::new(-1.0, 0.0), 0.05, 20, 20).unwrap()
}

/// The door is closed at night, from 18:00 to 8:00.
fn is_closed(time_s: f64) -> bool {
    !(8.0..18.0).contains(&(time_s.rem_euclid(DAY_S) / HOUR_S))
}

/// Half a minute of looks at this time, one per second.
fn look(mapper: &mut Mapper, time_s: f64) {
    for second in 0..30 {
        let time = time_s + f64::from(second);
        let door = DOOR.map(|x| (Cell::new(x, 3), is_closed(time)));
        mapper.update(&cells(time, door.chain([(FLOOR, false)]))).unwrap();
    }
}

/// A robot that looks at the door every two hours for this number of days, from a Monday on.
fn patrol(mapper: &mut Mapper, days: std::ops::Range<u32>) {
    for round in 12 * days.start..12 * days.end {
        look(mapper, 2.0 * HOUR_S * f64::from(round) + 600.0);
    }
}

fn mapper(settings: &MapperSettings) -> Mapper {
    let mut mapper = Mapper::new(settings, frame()).unwrap();
    mapper.set_epoch(MONDAY_S, true);
    mapper
}

/// P(blocked) of a cell of the door on day 12 at an hour.
fn predicted(mapper: &Mapper, hour: f64) -> f64 {
    let index = frame().index(Cell::new(4, 3)).unwrap();
    mapper.blocked_probability_later(index, 12.0 * DAY_S + hour * HOUR_S - mapper.time())
}

#[test]
fn a_door_is_predicted_by_its_hours() {
    let mut by_clock = mapper(&settings(true, Some("Europe/Berlin")));
    let mut by_chain = mapper(&settings(false, None));
    [&mut by_clock, &mut by_chain].into_iter().for_each(|mapper| patrol(mapper, 0..10));
    let [noon, night] = [13.0, 2.0].map(|hour| predicted(&by_clock, hour));
    assert!(noon < 0.25 && night > 0.75, "at noon {noon}, at night {night}");
    let [noon, night] = [13.0, 2.0].map(|hour| predicted(&by_chain, hour));
    assert!((noon - night).abs() < 0.1, "a chain knows no hours: {noon}, {night}");
    // Nothing changed on the floor.
    let floor = frame().index(FLOOR).unwrap();
    assert_eq!(by_clock.blocked_probability_later(floor, DAY_S), 0.0);
}

#[test]
fn without_a_zone_or_a_date_there_are_no_hours() {
    let mut without_zone = mapper(&settings(true, None));
    let mut without_date = mapper(&settings(true, Some("Europe/Berlin")));
    without_date.set_epoch(MONDAY_S, false);
    for mapper in [&mut without_zone, &mut without_date] {
        patrol(mapper, 0..10);
        assert_eq!(mapper.calendar(), &Calendar::Relative);
        let [noon, night] = [13.0, 2.0].map(|hour| predicted(mapper, hour));
        assert!((noon - night).abs() < 0.1, "{noon}, {night}");
    }
    let error = Mapper::new(&settings(true, Some("Europe/Berlim")), frame()).unwrap_err().to_string();
    let expected = "mapper setting `time_zone` must be the IANA name of a time zone, such as Europe/Berlin, not Europe/Berlim";
    assert_eq!(error, expected);
}

#[test]
fn tiles_go_on_from_a_snapshot_and_one_without_tiles_is_read() {
    let settings = settings(true, Some("Europe/Berlin"));
    let (mut whole, mut before, mut restored) = (mapper(&settings), mapper(&settings), mapper(&settings));
    patrol(&mut whole, 0..6);
    patrol(&mut before, 0..3);
    restored.restore(&before.snapshot()).unwrap();
    patrol(&mut restored, 3..6);
    assert!(restored.snapshot() == whole.snapshot());
    let mut earlier = mapper(&self::settings(false, None));
    patrol(&mut earlier, 0..3);
    restored.restore(&earlier.snapshot()).unwrap();
    assert_eq!(restored.tiles().count(), 0);
    // The clocks begin with the next change.
    patrol(&mut restored, 3..6);
    assert!(restored.tiles().count() > 0 && restored.states() == whole.states());
}

#[test]
fn tiles_stay_at_their_places_when_the_map_grows() {
    let settings = settings(true, Some("Europe/Berlin"));
    let mut grown = mapper(&settings);
    patrol(&mut grown, 0..3);
    let tile = |mapper: &Mapper, x: f64| {
        let at = mapper.frame().cell_at(&Point2::new(x, 0.18));
        mapper.tile(mapper.frame().index(at).unwrap()).cloned()
    };
    let before = [-0.98, -0.6, -0.48].map(|x| tile(&grown, x));
    assert!(before[0].is_some() && before[0] == before[1] && before[2].is_none());
    // By 7 and 3 cells, no multiple of a tile.
    let larger = GridFrame::new(Point2::new(-1.35, -0.15), 0.05, 40, 40).unwrap();
    grown.grow(&settings, larger).unwrap().unwrap();
    assert_eq!([-0.98, -0.6, -0.48].map(|x| tile(&grown, x)), before);
    assert_eq!(grown.states().cells().iter().filter(|state| **state == CellState::Free).count(), 1);
}
