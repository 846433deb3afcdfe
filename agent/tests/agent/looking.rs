//! Strategies that go where many cells come into view, on maps drawn by hand.

use crate::drawing::{map, reading, seeing};
use agent::{Frontier, OptimalRevisiting, Situation, Stay, Strategy};
use interfaces::{Cell, CellReading};
use mapper::Mapper;
use nalgebra::Isometry2;
use proptest::prelude::*;

/// The weights for a robot with these travel times to the cells.
fn weigh(strategy: &mut impl Strategy, mapper: &Mapper, travel: &[f64]) -> Vec<f64> {
    let mut weights = vec![0.0; mapper.frame().len()];
    let pose = Isometry2::identity();
    let situation = Situation::new(mapper, &pose, Default::default()).with_travel(travel);
    strategy.weigh(&situation, &mut weights);
    weights
}

#[track_caller]
fn assert_near(weights: &[f64], expected: &[f64]) {
    assert_eq!(weights.len(), expected.len());
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
    assert!(weights.iter().zip(expected).all(is_near), "{weights:?} are not {expected:?}");
}

/// ∫ of P(changed since) from 0 to t, in small steps: the expected time for which the map was wrong in a cell that
/// was last seen a time t ago.
fn time_wrong(leave: f64, back: f64, t: f64) -> f64 {
    let steps = 20_000;
    let chance = |tau: f64| leave / (leave + back) * (1.0 - f64::exp(-(leave + back) * tau));
    (0..steps).map(|step| chance((f64::from(step) + 0.5) * t / f64::from(steps))).sum::<f64>() * t
        / f64::from(steps)
}

/// By how much the wrong time per observation falls short of continuing at the present rate: t p(t) − ∫ p.
fn due(leave: f64, back: f64, t: f64) -> f64 {
    let chance = leave / (leave + back) * (1.0 - f64::exp(-(leave + back) * t));
    t * chance - time_wrong(leave, back, t)
}

#[test]
fn a_frontier_is_worth_the_unknown_cells_in_view_per_time() {
    let mapper = map(&[(0.0, &["...    "])]);
    let weights = weigh(&mut Frontier::new(&seeing(2.0)), &mapper, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    // From x, cells up to x + 2 are in view; 3 to 6 are unknown, of which only 3 touches a known one.
    assert_near(&weights, &[0.0, 1.0 / 2.0, 2.0 / 3.0, 3.0 / 4.0, 0.0, 0.0, 0.0]);
}

#[test]
fn walls_hide_what_is_behind_from_the_frontier() {
    let mapper = map(&[(0.0, &["..#  ", "....."])]);
    let travel = [0.0, 1.0, 2.0, 3.0, 4.0, 1.0, 2.0, f64::INFINITY, 4.0, 5.0];
    let weights = weigh(&mut Frontier::new(&seeing(9.0)), &mapper, &travel);
    let [.., here, beside, wall, behind, corner] = weights[..] else { panic!("ten cells") };
    assert_eq!((here, beside, wall), (0.0, 0.0, 0.0));
    assert_near(&[behind, corner], &[2.0 / 5.0, 2.0 / 6.0]);
}

#[test]
fn where_all_is_known_a_frontier_is_what_was_seen_longest_ago() {
    let mapper = map(&[(2.0, &["...."]), (10.0, &["..  "])]);
    let weights = weigh(&mut Frontier::new(&seeing(9.0)), &mapper, &[0.0, 1.0, 2.0, 3.0]);
    assert_near(&weights, &[0.0, 0.0, 8.0 / 3.0, 8.0 / 4.0]);
}

#[test]
fn what_no_way_leads_to_is_no_frontier() {
    let mapper = map(&[(0.0, &["..# "]), (6.0, &["... "]), (7.0, &[".   "])]);
    let weights = weigh(&mut Frontier::new(&seeing(1.0)), &mapper, &[0.0, 1.0, f64::INFINITY, f64::INFINITY]);
    assert_near(&weights, &[0.0, 1.0 / 2.0, 0.0, 0.0]);
}

#[test]
fn what_three_visits_did_not_show_is_given_up() {
    let mapper = map(&[(0.0, &["...  "]), (4.0, &[".... "]), (9.0, &[".    "])]);
    let mut frontier = Frontier::new(&seeing(1.0));
    let travel = [0.0, 1.0, 2.0, 3.0, 4.0];
    let unknown = [0.0, 0.0, 0.0, 1.0 / 4.0, 1.0 / 5.0];
    for visit in 0..3 {
        assert_near(&weigh(&mut frontier, &mapper, &travel), &unknown);
        assert_eq!(frontier.stay(Cell::new(3 + visit % 2, 0)), Stay::Watch(1.0));
    }
    // The known cells that were not seen for longest, instead.
    assert_near(&weigh(&mut frontier, &mapper, &travel), &[0.0, 5.0 / 2.0, 5.0 / 3.0, 5.0 / 4.0, 0.0]);
}

/// Three cells; the middle one is watched for 8 s: free until 2 s, blocked until 6 s, and free again.
/// All but the left one were last seen 3 s ago.
fn middle_changes() -> Mapper {
    map(&[(0.0, &["..."]), (2.0, &[".#."]), (6.0, &["..."]), (8.0, &["..."]), (11.0, &[".  "])])
}

#[test]
fn revisiting_is_worth_how_far_a_look_is_due_per_time() {
    let mapper = middle_changes();
    let (block, free) = mapper.transition_rates(1).unwrap();
    // One of three cells changed: one and a half of four, by the rule of the half event.
    let share = 1.5 / 4.0;
    let never = 0.5 / (8.0 + 1.0);
    let worth = [0.0, due(block, free, 3.0), share * due(never, never, 3.0)];
    // A robot that sees only its own cell.
    let weights = weigh(&mut OptimalRevisiting::new(&seeing(0.5)), &mapper, &[0.0, 1.0, 2.0]);
    assert_near(&weights, &[0.0, worth[1] / 9.0, worth[2] / 10.0]);
    // A robot that sees all cells; the middle cell is no wall.
    let all = worth[1] + worth[2];
    let weights = weigh(&mut OptimalRevisiting::new(&seeing(9.0)), &mapper, &[0.0, 1.0, f64::INFINITY]);
    assert_near(&weights, &[all / 8.0, all / 9.0, 0.0]);
}

#[test]
fn a_blocked_cell_is_left_at_its_own_rate() {
    let mut mapper = middle_changes();
    mapper.update(&reading(12.0, &[".#."])).unwrap();
    mapper.update(&reading(17.0, &["  ."])).unwrap();
    let (block, free) = mapper.transition_rates(1).unwrap();
    assert_ne!(block, free);
    let weights = weigh(&mut OptimalRevisiting::new(&seeing(0.5)), &mapper, &[0.0, 1.0, 2.0]);
    assert_near(&weights[1..2], &[due(free, block, 5.0) / 9.0]);
}

#[test]
fn the_unknown_is_wrong_for_certain() {
    let mapper = map(&[(0.0, &["..  "]), (7.0, &[".   "])]);
    let weights = weigh(&mut OptimalRevisiting::new(&seeing(0.5)), &mapper, &[0.0, 1.0, 2.0, 3.0]);
    // Not seen for 7 s; the last cell shares no side with a known free cell.
    assert_near(&weights[2..], &[7.0 / 10.0, 0.0]);
}

#[test]
fn a_look_in_vain_is_a_look() {
    let mut mapper = middle_changes();
    let (mut revisiting, travel) = (OptimalRevisiting::new(&seeing(9.0)), [0.0, 1.0, 2.0]);
    assert!(weigh(&mut revisiting, &mapper, &travel)[0] > 0.0);
    assert_eq!(revisiting.stay(Cell::new(0, 0)), Stay::Watch(8.0));
    // Something hid the other cells all the time.
    assert_eq!(weigh(&mut revisiting, &mapper, &travel), [0.0; 3]);
    mapper.update(&reading(15.0, &[".  "])).unwrap();
    let (block, free) = mapper.transition_rates(1).unwrap();
    let worth = due(block, free, 4.0) + 1.5 / 4.0 * due(0.5 / 9.0, 0.5 / 9.0, 4.0);
    assert_near(&weigh(&mut revisiting, &mapper, &travel)[..1], &[worth / 8.0]);
}

#[test]
fn a_goal_outside_of_the_map_is_no_look() {
    let mapper = middle_changes();
    let mut revisiting = OptimalRevisiting::new(&seeing(9.0));
    let before = weigh(&mut revisiting, &mapper, &[0.0; 3]);
    for goal in [Cell::new(-1, 0), Cell::new(0, 7), Cell::new(i32::MAX, i32::MIN)] {
        revisiting.stay(goal);
        assert_eq!(weigh(&mut revisiting, &mapper, &[0.0; 3]), before);
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
        let mut mapper = crate::drawing::empty(6, 4);
        let mut strategies: [Box<dyn Strategy>; 2] =
            [Box::new(Frontier::new(&seeing(radius))), Box::new(OptimalRevisiting::new(&seeing(radius)))];
        let (count, mut time) = (sightings.len(), 0.0);
        for (number, (cells, passed)) in sightings.into_iter().enumerate() {
            time += if number + 1 == count { last + passed } else { passed };
            let seen = (0..24).filter(|&cell| cells[cell] > 1);
            let cells = seen.map(|cell| (mapper.frame().cell(cell), cells[cell] == 3)).collect();
            mapper.update(&CellReading { time, pose: Isometry2::identity(), cells }).unwrap();
            for strategy in &mut strategies {
                let mut weights = vec![0.0; 24];
                let pose = Isometry2::identity();
                let situation = Situation::new(&mapper, &pose, Default::default()).with_travel(&travel);
                strategy.weigh(&situation, &mut weights);
                for (cell, weight) in weights.iter().enumerate() {
                    prop_assert!(weight.is_finite() && *weight >= 0.0, "{} {weight}", strategy.name());
                    prop_assert!(*weight == 0.0 || travel[cell].is_finite());
                }
                strategy.stay(Cell::new(goals[number].0, goals[number].1));
            }
        }
    }
}
