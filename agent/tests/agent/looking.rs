//! Strategies that go where many cells come into view, on maps drawn by hand.

use crate::drawing::{empty, map, reading, seeing, weigh};
use agent::{AgentSettings, BestTrip, Brier, InformationGain, Stay, Strategy};
use interfaces::{Cell, CellReading};
use mapper::Mapper;
use nalgebra::Isometry2;
use proptest::prelude::*;

fn fresh_map(settings: &AgentSettings) -> BestTrip<Brier> {
    BestTrip::new(Brier, settings)
}

/// Three cells; the middle one is watched for 8 s: free until 2 s, blocked until 6 s, and free again.
/// All but the left one were last seen 3 s ago.
fn middle_changes() -> Mapper {
    map(&[(0.0, &["..."]), (2.0, &[".#."]), (6.0, &["..."]), (8.0, &["..."]), (11.0, &[".  "])])
}

#[test]
fn a_look_in_vain_is_a_look() {
    let mut mapper = middle_changes();
    let (mut fresh, travel) = (fresh_map(&seeing(9.0)), [0.0, 1.0, 2.0]);
    let before = weigh(&mut fresh, &mapper, &travel);
    assert!(before[0] > 0.0);
    assert!(matches!(fresh.stay(Cell::new(0, 0)), Stay::Watch(_)));
    // Something hid the other cells all the time: what a look is worth begins again.
    mapper.update(&reading(12.0, &[".  "])).unwrap();
    let after = weigh(&mut fresh, &mapper, &travel);
    assert!(after[0] < before[0], "{after:?} {before:?}");
}

/// A robot that sees a moving thing all the time has nothing to look at there.
#[test]
fn what_is_in_view_is_worth_no_look() {
    let mut mapper = map(&[(0.0, &[".........."])]);
    for step in 1..60 {
        let row = if step % 7 < 4 { "...#..    " } else { "......    " };
        mapper.update(&reading(f64::from(step), &[row])).unwrap();
    }
    let travel: Vec<f64> = (0..10).map(f64::from).collect();
    let weights = weigh(&mut fresh_map(&seeing(2.0)), &mapper, &travel);
    assert!(weights[..4] == [0.0; 4] && weights[9] > 0.0, "{weights:?}");
}

#[test]
fn a_goal_outside_of_the_map_is_no_look() {
    let mapper = middle_changes();
    let mut fresh = fresh_map(&seeing(9.0));
    let before = weigh(&mut fresh, &mapper, &[0.0; 3]);
    for goal in [Cell::new(-1, 0), Cell::new(0, 7), Cell::new(i32::MAX, i32::MIN)] {
        fresh.stay(goal);
        assert_eq!(weigh(&mut fresh, &mapper, &[0.0; 3]), before);
    }
}

fn any_time() -> impl proptest::strategy::Strategy<Value = f64> {
    prop_oneof![6 => 0.0..50.0, 1 => Just(f64::INFINITY), 1 => Just(0.0), 1 => 0.0..1e300]
}

proptest! {
    #[test]
    fn weights_are_numbers_whatever_was_seen(
        sightings in prop::collection::vec((prop::collection::vec(0..4, 24), 0.0..1e3), 1..12),
        last in prop_oneof![4 => Just(0.0), 1 => 0.0..1e300],
        travel in prop::collection::vec(any_time(), 24),
        radius in 1e-3..20.0,
        goals in prop::collection::vec((-2..8, -2..6), 12),
    ) {
        let mut mapper = empty(6, 4);
        let mut strategies: [Box<dyn Strategy>; 2] =
            [Box::new(fresh_map(&seeing(radius))), Box::new(InformationGain::new(&seeing(radius)))];
        let (count, mut time) = (sightings.len(), 0.0_f64);
        for (number, (cells, passed)) in sightings.into_iter().enumerate() {
            time += if number + 1 == count { last + passed } else { passed };
            let seen = (0..24).filter(|&cell| cells[cell] > 1);
            let cells = seen.map(|cell| (mapper.frame().cell(cell), cells[cell] == 3)).collect();
            mapper.update(&CellReading { time, pose: Isometry2::identity(), cells }).unwrap();
            for strategy in &mut strategies {
                let weights = weigh(&mut **strategy, &mapper, &travel);
                for weight in &weights {
                    prop_assert!(weight.is_finite() && *weight >= 0.0, "{} {weight}", strategy.name());
                }
                strategy.stay(Cell::new(goals[number].0, goals[number].1));
                let best = (0..24).max_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap();
                if strategy.name() == "information-gain" && number % 2 == 0 {
                    prop_assert!(matches!(strategy.stay(mapper.frame().cell(best)), Stay::Watch(0.0..=5.0)));
                }
            }
        }
    }
}
