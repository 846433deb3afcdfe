//! Readings that must not enter the map, because their pose is not certain.

use crate::cells;
use interfaces::{Cell, CellReading, CellState, GridFrame};
use mapper::{Mapper, MapperSettings};
use nalgebra::Point2;

fn reading(time: f64, is_blocked: bool) -> CellReading {
    cells(time, [(Cell::new(0, 0), is_blocked)])
}

/// A mapper for which a body can hide a cell for 8 s without interrupting its view.
fn mapper() -> Mapper {
    let frame = GridFrame::new(Point2::origin(), 1.0, 2, 2).unwrap();
    let mut mapper =
        Mapper::new(&MapperSettings { max_gap: 8.0, ..MapperSettings::default() }, frame).unwrap();
    for time in [1.0, 2.0] {
        mapper.update(&reading(time, false)).unwrap();
    }
    mapper
}

#[test]
fn nothing_is_learned_from_a_skipped_reading_and_its_time_is_not_observed() {
    let mut mapper = mapper();
    mapper.skip(&reading(3.0, true));
    assert_eq!((mapper.time(), mapper.states().cells()[0]), (3.0, CellState::Free));
    assert!(mapper.transitions().is_empty() && !mapper.is_in_view(0));
    mapper.update(&reading(4.0, false)).unwrap();
    assert_eq!((mapper.statistics(0).unobserved, mapper.statistics(0).watched_free), (2.0, 1.0));

    let mut hidden = self::mapper();
    hidden.update(&cells(3.0, [])).unwrap();
    hidden.update(&reading(4.0, false)).unwrap();
    assert_eq!((hidden.statistics(0).unobserved, hidden.statistics(0).watched_free), (0.0, 3.0));
}

#[test]
fn a_change_across_a_skipped_reading_is_a_change_after_a_gap() {
    let mut mapper = mapper();
    mapper.skip(&reading(3.0, true));
    mapper.update(&reading(4.0, true)).unwrap();
    let cell = mapper.statistics(0);
    assert_eq!((cell.block_events, cell.block_events_after_gap), (0, 1));
}

#[test]
fn a_skipped_reading_may_have_any_time() {
    let mut mapper = mapper();
    for time in [f64::NAN, f64::INFINITY, -5.0] {
        mapper.skip(&reading(time, true));
        assert_eq!(mapper.time(), 2.0);
    }
    mapper.update(&reading(2.5, false)).unwrap();
    assert_eq!(mapper.statistics(0).watched_free, 1.0);
}
