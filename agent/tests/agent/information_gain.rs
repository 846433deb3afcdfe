//! The strategy that goes where an observation is worth most, on maps drawn by hand.

use crate::drawing::{map, reading, seeing, weigh, weigh_from};
use agent::{InformationGain, Situation, Stay, Strategy};
use interfaces::{Cell, CellReading, GridFrame};
use mapper::{Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2};

/// Two rooms, each with a cell that changes at every other reading. The cell in the left room is observed in `left`
/// readings, the cell in the right room in `right` readings.
fn rooms(left: u32, right: u32) -> Mapper {
    let (still, moved) = (["...#...", "...#...", "...#..."], ["...#...", ".#.#.#.", "...#..."]);
    let cut = |rows: [&'static str; 3], is_left: bool, is_right: bool| -> Vec<String> {
        let cell = |(x, letter): (usize, char)| {
            let is_seen = if x <= 3 { x == 3 || is_left } else { is_right };
            if is_seen { letter } else { ' ' }
        };
        rows.iter().map(|row| row.chars().enumerate().map(cell).collect()).collect()
    };
    let mut mapper = map(&[(0.0, &still)]);
    for look in 1..=left.max(right) {
        let rows = if look % 2 == 0 { still } else { moved };
        let rows = cut(rows, look <= left, look <= right);
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        mapper.update(&reading(f64::from(look), &rows)).unwrap();
    }
    mapper
}

fn best(weights: &[f64], columns: std::ops::Range<usize>) -> f64 {
    let inside = |index: &usize| columns.contains(&(index % 7));
    (0..weights.len()).filter(inside).map(|index| weights[index]).fold(0.0, f64::max)
}

#[test]
fn what_changes_and_is_little_known_is_preferred_to_what_is_well_known() {
    for (left, right, is_left) in [(4, 80, true), (80, 4, false)] {
        let weights = weigh(&mut InformationGain::new(&seeing(2.0)), &rooms(left, right), &[10.0; 21]);
        let (in_left, in_right) = (best(&weights, 0..3), best(&weights, 4..7));
        assert_eq!(in_left > 1.2 * in_right, is_left, "{in_left} and {in_right}");
        assert_eq!(in_right > 1.2 * in_left, !is_left, "{in_left} and {in_right}");
    }
}

#[test]
fn what_was_watched_for_long_and_never_changed_is_worth_next_to_nothing() {
    let best_after = |time: f64| {
        let mapper = map(&[(0.0, &["....", "....", "...."]), (time, &["....", "....", "...."])]);
        weigh(&mut InformationGain::new(&seeing(3.0)), &mapper, &[1.0; 12]).into_iter().fold(0.0, f64::max)
    };
    let worth: Vec<f64> = [1.0, 30.0, 300.0, 3000.0].map(best_after).into();
    assert!(worth.is_sorted_by(|one, next| one > next), "{worth:?}");
    assert!(worth[3] < worth[0] / 100.0, "{worth:?}");
}

#[test]
fn the_same_view_is_worth_less_the_farther_it_is_and_nothing_where_no_way_leads() {
    let mapper = map(&[(0.0, &["....."])]);
    let weights =
        weigh(&mut InformationGain::new(&seeing(9.0)), &mapper, &[0.0, 5.0, 20.0, f64::INFINITY, 80.0]);
    assert!(weights[0] > weights[1] && weights[1] > weights[2] && weights[2] > weights[4]);
    assert!(weights[4] > 0.0);
    assert_eq!(weights[3], 0.0);
}

#[test]
fn the_robot_does_not_stand_where_things_pass() {
    let mapper = map(&[(0.0, &["....."]), (1.0, &["..#.."]), (2.0, &["....."])]);
    let weights = weigh(&mut InformationGain::new(&seeing(9.0)), &mapper, &[1.0; 5]);
    assert_eq!(weights[2], 0.0);
    assert!(weights[0] > weights[1], "beside the way it might be in it");
}

#[test]
fn a_door_that_was_closed_when_last_seen_is_tried_again() {
    let mapper = map(&[(0.0, &["....."]), (1.0, &["..#.."]), (2.0, &["..   "])]);
    let travel = [0.0, 1.0, f64::INFINITY, f64::INFINITY, f64::INFINITY];
    let weights = weigh(&mut InformationGain::new(&seeing(1.0)), &mapper, &travel);
    assert!(weights[3] > 0.0 && weights[4] > 0.0, "{weights:?}");
    let in_view = map(&[(0.0, &["....."]), (1.0, &["..#.."])]);
    let weights = weigh(&mut InformationGain::new(&seeing(1.0)), &in_view, &travel);
    assert_eq!(weights[3..], [0.0, 0.0]);
}

#[test]
fn what_a_visit_did_not_show_is_worth_less_from_there() {
    // The last cell is never seen, although the map says that it can be seen.
    let mut mapper = map(&[(0.0, &["..... "])]);
    let mut strategy = InformationGain::new(&seeing(9.0));
    let travel = [0.0, 3.0, 3.0, 3.0, 3.0, 3.0];
    let first = weigh(&mut strategy, &mapper, &travel)[0];
    for visit in 0..100 {
        let Stay::Watch(watch) = strategy.stay(Cell::new(0, 0)) else { panic!("it watches") };
        assert!((0.0..=5.0).contains(&watch));
        let pose = interfaces::pose(0.5, 0.5, 0.0);
        mapper.update(&CellReading { pose, ..reading(f64::from(visit), &[".     "]) }).unwrap();
        weigh_from(&pose, &mut strategy, &mapper, &travel);
    }
    let last = weigh(&mut strategy, &mapper, &travel)[0];
    assert!(last < 0.1 * first, "{last} after {first}");
}

/// The worth of a region of 5 × 5 cells after three complete views, by a robot that stopped at some cells to the left of its
/// goal, or did not go there. The goal is the lower left cell of the region.
fn worth_after_visits(cells_before: i32, goes_there: bool) -> f64 {
    let frame = GridFrame::new(Point2::origin(), 0.05, 60, 20).unwrap();
    let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
    let mut strategy = InformationGain::new(&seeing(10.0));
    let (goal, travel) = (Cell::new(40, 10), vec![1.0; frame.len()]);
    let robot = frame.center(Cell::new(goal.x - cells_before, goal.y));
    let pose = Isometry2::translation(robot.x, robot.y);
    let mut weights = Vec::new();
    for step in 0..=20 {
        let cells = (0..frame.len()).map(|index| (frame.cell(index), false)).collect();
        mapper.update(&CellReading { time: f64::from(step), pose, cells }).unwrap();
        // A view lasts five units of time at most.
        if step % 6 == 2 {
            weights = weigh_from(&pose, &mut strategy, &mapper, &travel);
            strategy.stay(goal);
            if !goes_there {
                strategy.end(&Situation::new(&mapper, &pose, Default::default()));
            }
        }
    }
    weights[frame.index(goal).unwrap()]
}

#[test]
fn a_robot_that_stops_beside_its_goal_has_the_view_of_its_goal() {
    let complete = worth_after_visits(0, true);
    assert!(complete > 0.0);
    for cells in [2, 4] {
        assert_eq!(worth_after_visits(cells, true), complete, "{cells} cells");
    }
    assert!(worth_after_visits(5, true) < complete, "the goal was not reached");
}

#[test]
fn a_robot_that_is_called_away_has_made_no_visit() {
    assert_eq!(worth_after_visits(30, false), worth_after_visits(0, true));
}
