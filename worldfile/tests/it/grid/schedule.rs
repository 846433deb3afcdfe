use super::*;

/// The positions of the blocks from the start on, while the robot stays: the columns, one digit per step.
fn columns(spec: &GridSpec, steps: usize) -> Vec<String> {
    let mut world = GridWorld::new(spec, 0);
    let mut columns = vec![String::new(); spec.blocks.len()];
    for _ in 0..steps {
        for (column, (_, cell)) in columns.iter_mut().zip(world.blocks()) {
            *column += &cell.x.to_string();
        }
        world.act(&Step::Stay);
    }
    columns
}

/// A corridor of nine cells below the robot's.
fn corridor(blocks: &[String]) -> GridSpec {
    spec("#########\n####R####\n.........", &blocks.concat())
}

#[test]
fn a_block_stands_for_its_dwell_and_turns_round() {
    let line = "[[2, 0], [5, 0]]";
    let spec = |dwell| corridor(&[block("b", dwell, "back-and-forth", line)]);
    assert_eq!(columns(&spec(1), 14), ["23454323454323"]);
    assert_eq!(columns(&spec(2), 26), ["22334455443322334455443322"]);
    assert_eq!(columns(&spec(5), 31), ["2222233333444445555544444333332"]);
}

#[test]
fn two_cells_are_a_path() {
    for course in ["back-and-forth", "loop"] {
        let spec = corridor(&[block("b", 3, course, "[[7, 0], [6, 0]]")]);
        assert_eq!(columns(&spec, 13), ["7776667776667"], "{course}");
    }
}

#[test]
fn a_loop_goes_round() {
    // Both notations: the path ends beside the first cell, or on it.
    for path in ["[[1, 0], [3, 0], [3, 1], [1, 1]]", "[[1, 0], [3, 0], [3, 1], [1, 1], [1, 0]]"] {
        let spec = spec("....R\n.....\n.....", &block("b", 2, "loop", path));
        let mut world = GridWorld::new(&spec, 0);
        let mut cells = Vec::new();
        for _ in 0..14 {
            cells.extend(world.blocks().map(|(_, cell)| (cell.x, cell.y)));
            world.act(&Step::Stay);
        }
        let round = [(1, 0), (2, 0), (3, 0), (3, 1), (2, 1), (1, 1), (1, 0)];
        assert_eq!(cells, round.map(|cell| [cell; 2]).concat());
    }
}

#[test]
fn the_first_stay_is_shorter_by_what_has_passed() {
    let stood =
        |steps: u32| block("b", 4, "back-and-forth", "[[0, 0], [2, 0]]") + &format!("stood = {steps}\n");
    assert_eq!(columns(&corridor(&[stood(0)]), 13), ["0000111122221"]);
    assert_eq!(columns(&corridor(&[stood(1)]), 12), ["000111122221"]);
    assert_eq!(columns(&corridor(&[stood(3)]), 10), ["0111122221"]);
}

#[test]
fn a_block_waits_for_the_robot_and_then_stands_for_its_dwell_again() {
    let spec = spec("###\n...\n.R.", &block("b", 2, "back-and-forth", "[[0, 1], [2, 1]]"));
    let mut world = GridWorld::new(&spec, 0);
    let mut columns = String::new();
    // The robot is in the way from the first step to the fifth; the block is due from the second step on.
    let steps = [Step::Up, Step::Stay, Step::Stay, Step::Stay, Step::Stay, Step::Down];
    for step in steps.into_iter().chain([Step::Stay; 4]) {
        world.act(&step);
        columns += &world.blocks().next().unwrap().1.x.to_string();
    }
    // The robot acts first: the block enters at the step in which the robot leaves.
    assert_eq!(columns, "0000011221");
}

#[test]
fn blocks_wait_for_each_other() {
    let blocks = [
        block("right", 1, "back-and-forth", "[[0, 0], [5, 0]]"),
        block("left", 1, "back-and-forth", "[[5, 0], [2, 0]]"),
    ];
    // The blocks face each other forever: neither turns before the end of its path. They meet at 2 and 3: in the
    // third step the block that comes first in the file moves first, and finds 3 occupied.
    assert_eq!(columns(&corridor(&blocks), 8), ["01222222", "54333333"]);
    let odd = [
        block("right", 1, "back-and-forth", "[[0, 0], [5, 0]]"),
        block("left", 1, "back-and-forth", "[[4, 0], [2, 0]]"),
    ];
    // Both blocks move to 2: the one that comes first in the file gets there. The other one waits at 3.
    assert_eq!(columns(&corridor(&odd), 8), ["01222222", "43333333"]);
}

#[test]
fn a_block_may_enter_what_an_earlier_one_leaves() {
    let ahead = block("ahead", 2, "back-and-forth", "[[1, 0], [8, 0]]");
    let behind = block("behind", 2, "back-and-forth", "[[0, 0], [7, 0]]");
    let first_moves_first = corridor(&[ahead.clone(), behind.clone()]);
    assert_eq!(columns(&first_moves_first, 7), ["1122334", "0011223"]);
    // In the other order, the block behind finds the cell occupied at first, and follows one step later.
    assert_eq!(columns(&corridor(&[behind, ahead]), 7), ["0001122", "1122334"]);
}

#[test]
fn the_paper_s_blocks_take_42_and_40_steps_for_a_round() {
    let spec = worldfile::grid::parse("two_blocks.toml", SHIPPED[0].1).unwrap();
    let mut world = GridWorld::new(&spec, 0);
    let start: Vec<Cell> = world.blocks().map(|(_, cell)| cell).collect();
    let mut back = [Vec::new(), Vec::new()];
    let mut before = start.clone();
    for step in 1..=84 {
        world.act(&Step::Stay);
        for (index, (_, cell)) in world.blocks().enumerate() {
            if cell == start[index] && cell != before[index] {
                back[index].push(step);
            }
            before[index] = cell;
        }
    }
    assert_eq!(back, [vec![42, 84], vec![40, 80]]);
}
