use super::*;
use crate::FREE;
use crate::tests::costmap;
use nalgebra::Point2;
use proptest::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Dijkstra's algorithm without optimizations, as the reference.
fn dijkstra(map: &Costmap, source: Cell, moves: Moves) -> Vec<Option<u32>> {
    let frame = map.frame();
    let mut costs = vec![None; frame.len()];
    let mut heap = BinaryHeap::from([Reverse((0, source))]);
    while let Some(Reverse((cost, cell))) = heap.pop() {
        let Some(index) = frame.index(cell).filter(|_| map.is_traversable(cell)) else { continue };
        if costs[index].is_some() {
            continue;
        }
        costs[index] = Some(cost);
        for next in cell.neighbours8() {
            let straight = next.x == cell.x || next.y == cell.y;
            let past_corners = map.is_traversable(Cell::new(next.x, cell.y))
                && map.is_traversable(Cell::new(cell.x, next.y));
            if straight || moves == Moves::Eight && past_corners {
                let length = if straight { STRAIGHT } else { DIAGONAL };
                heap.push(Reverse((cost + length * u32::from(map.cost(cell)), next)));
            }
        }
    }
    costs
}

fn all_costs(wave: &Wavefront, frame: &GridFrame) -> Vec<Option<u32>> {
    (0..frame.len()).map(|index| wave.path_cost(frame.cell(index))).collect()
}

/// A map of random rectangles of random costs: halls, walls, and rings of higher cost.
fn random_map() -> impl Strategy<Value = (Costmap, Cell, Cell)> {
    (3..30_i32, 3..30_i32).prop_flat_map(|(width, height)| {
        let cell = move || (0..width, 0..height);
        let cell_cost = prop_oneof![3 => Just(LETHAL), 2 => Just(FREE), 1 => 2..=MAX_COST];
        let blocks = prop::collection::vec((cell(), (1..8_i32, 1..8_i32), cell_cost), 0..30);
        (blocks, cell(), cell()).prop_map(move |(blocks, source, target)| {
            let frame = GridFrame::new(Point2::origin(), 1.0, width as usize, height as usize).unwrap();
            let mut map = Costmap::lethal(frame);
            (0..frame.len()).for_each(|index| map.set_cost(frame.cell(index), FREE));
            for ((left, bottom), (across, up), cell_cost) in blocks {
                for y in bottom..bottom + up {
                    (left..left + across).for_each(|x| map.set_cost(Cell::new(x, y), cell_cost));
                }
            }
            (map, Cell::new(source.0, source.1), Cell::new(target.0, target.1))
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn every_cost_is_dijkstras((map, source, _) in random_map(), four in any::<bool>()) {
        let moves = if four { Moves::Four } else { Moves::Eight };
        let mut wave = Wavefront::new(*map.frame(), moves);
        wave.spread(&map, source, None);
        let costs = all_costs(&wave, map.frame());
        prop_assert!(wave.path_costs().eq(costs.iter().copied()));
        prop_assert_eq!(costs, dijkstra(&map, source, moves));
    }

    #[test]
    fn a_wave_that_stops_early_is_exact_up_to_its_target((map, source, target) in random_map()) {
        let mut wave = Wavefront::new(*map.frame(), Moves::Eight);
        // The data of an earlier wave must not affect the result.
        wave.spread(&map, target, Some(source));
        wave.clear();
        prop_assert!(all_costs(&wave, map.frame()).iter().all(Option::is_none));
        let found = wave.spread(&map, source, Some(target));
        let oracle = dijkstra(&map, source, Moves::Eight);
        let cost = oracle[map.frame().index(target).unwrap()];
        prop_assert_eq!(found, cost.is_some());
        for (index, mine) in all_costs(&wave, map.frame()).into_iter().enumerate() {
            if oracle[index].is_some_and(|theirs| cost.is_none_or(|cost| theirs <= cost)) {
                prop_assert_eq!(mine, oracle[index]);
            }
        }
    }

    #[test]
    fn the_descent_costs_what_the_field_states((map, source, target) in random_map(), four in any::<bool>()) {
        let moves = if four { Moves::Four } else { Moves::Eight };
        let mut wave = Wavefront::new(*map.frame(), moves);
        if wave.spread(&map, source, Some(target)) {
            let path = wave.descend(&map, target);
            prop_assert_eq!((path[0], path[path.len() - 1]), (target, source));
            let paid: Option<u32> = path.windows(2).map(|step| map.line_cost(step[0], step[1])).sum();
            prop_assert_eq!(paid, wave.path_cost(target));
            let diagonal = |step: &[Cell]| step[0].x != step[1].x && step[0].y != step[1].y;
            prop_assert!(moves == Moves::Eight || !path.windows(2).any(diagonal));
        }
    }
}

#[test]
fn a_wave_from_a_wall_or_from_outside_goes_nowhere() {
    let map = costmap(&["#.", ".."]);
    let mut wave = Wavefront::new(*map.frame(), Moves::Eight);
    for source in [Cell::new(0, 1), Cell::new(-1, 0), Cell::new(2, 0), Cell::new(0, 9)] {
        assert!(!wave.spread(&map, source, Some(Cell::new(1, 1))));
        assert_eq!(wave.path_cost(Cell::new(1, 1)), None);
    }
}
