//! A mapper that goes on from a snapshot, and a pause between two sessions.

use crate::cells;
use interfaces::{Cell, CellReading, GridFrame};
use mapper::{EstimatorChoice, Mapper, MapperSettings, OccupancyChoice};
use nalgebra::Point2;

/// Two cells that change now and then; the second one is seen in two of three readings.
fn reading(step: u32) -> CellReading {
    let seldom = (step % 12 < 8).then(|| (Cell::new(1, 1), (step / 7).is_multiple_of(3)));
    let always = (Cell::new(0, 0), (step / 5).is_multiple_of(2));
    cells(0.1 * f64::from(step), [always].into_iter().chain(seldom))
}

fn mapper(settings: &MapperSettings, steps: u32) -> Mapper {
    let frame = GridFrame::new(Point2::origin(), 0.1, 3, 2).unwrap();
    let mut mapper = Mapper::new(settings, frame).unwrap();
    (0..steps).for_each(|step| mapper.update(&reading(step)).unwrap());
    mapper
}

#[test]
fn every_model_and_estimator_goes_on_from_a_snapshot() {
    for (estimator, occupancy) in EstimatorChoice::all()
        .into_iter()
        .flat_map(|estimator| OccupancyChoice::all().into_iter().map(move |model| (estimator.clone(), model)))
    {
        let settings = MapperSettings { estimator, occupancy, ..MapperSettings::default() };
        let mut whole = mapper(&settings, 400);
        let mut restored = mapper(&settings, 3);
        restored.restore(&mapper(&settings, 200).snapshot()).unwrap();
        for step in 200..400 {
            restored.update(&reading(step)).unwrap();
            assert!(restored.sum_change_probability() >= 0.0);
        }
        (0..400).for_each(|_| assert!(whole.sum_change_probability() >= 0.0));
        for index in 0..6 {
            assert_eq!(restored.statistics(index), whole.statistics(index), "{settings:?}");
            assert_eq!(restored.credible_interval(index, 0.9), whole.credible_interval(index, 0.9));
            assert_eq!(restored.is_candidate(index), whole.is_candidate(index));
        }
        assert_eq!((restored.max_recency(), restored.readings()), (whole.max_recency(), whole.readings()));
    }
}

#[test]
fn a_snapshot_that_is_cut_or_of_another_frame_is_refused() {
    let settings = MapperSettings::default();
    let snapshot = mapper(&settings, 100).snapshot();
    let read = |length: &usize| mapper(&settings, 0).restore(&snapshot[..*length]).is_ok();
    assert_eq!((0..snapshot.len()).filter(read).count(), 0);
    let larger = GridFrame::new(Point2::origin(), 0.1, 4, 2).unwrap();
    assert!(Mapper::new(&settings, larger).unwrap().restore(&snapshot).is_err());
}

#[test]
fn a_pause_is_a_gap_and_no_time_between_readings() {
    let mut mapper = mapper(&MapperSettings::default(), 100);
    let before = mapper.statistics(0);
    mapper.pause(1000.0);
    for step in 0..100 {
        let mut later = reading(step);
        later.time += 1000.0;
        mapper.update(&later).unwrap();
    }
    let seen = mapper.statistics(0);
    assert!((seen.period - 0.1).abs() < 1e-9, "{seen:?}");
    assert!((seen.unobserved - (1000.0 - before.last_seen)).abs() < 1e-9, "{seen:?}");
    assert!((seen.observed() - 2.0 * before.observed()).abs() < 1e-9, "{seen:?}");
    // A time that makes no sense does not go back.
    mapper.pause(f64::NAN);
    mapper.pause(-5.0);
    assert!(mapper.time() >= 1009.9);
}

#[test]
fn an_emptied_mapper_is_a_new_one() {
    let settings = MapperSettings { max_gap: 0.3, ..MapperSettings::default() };
    let mut emptied = mapper(&settings, 100).emptied()();
    assert!(emptied.snapshot() == mapper(&settings, 0).snapshot());
    (0..100).for_each(|step| emptied.update(&reading(step)).unwrap());
    assert!(emptied.snapshot() == mapper(&settings, 100).snapshot());
}
