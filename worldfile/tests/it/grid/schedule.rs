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

#[test]
fn blocks_stand_for_their_dwell_turn_round_and_wait_for_each_other() {
    let there = |name: &str, dwell: u32, path: &str| block(name, dwell, "back-and-forth", path);
    let line = |dwell| there("b", dwell, "[[2, 0], [5, 0]]");
    // Two cells are a path.
    let pair = |course| block("b", 3, course, "[[7, 0], [6, 0]]");
    // The first stay is shorter by what has passed.
    let stood = |steps: u32| there("b", 4, "[[0, 0], [2, 0]]") + &format!("stood = {steps}\n");
    let right = there("right", 1, "[[0, 0], [5, 0]]");
    let [ahead, behind] = [there("ahead", 2, "[[1, 0], [8, 0]]"), there("behind", 2, "[[0, 0], [7, 0]]")];
    let cases: [(&[String], &[&str]); 12] = [
        (&[line(1)], &["23454323454323"]),
        (&[line(2)], &["22334455443322334455443322"]),
        (&[line(5)], &["2222233333444445555544444333332"]),
        (&[pair("back-and-forth")], &["7776667776667"]),
        (&[pair("loop")], &["7776667776667"]),
        (&[stood(0)], &["0000111122221"]),
        (&[stood(1)], &["000111122221"]),
        (&[stood(3)], &["0111122221"]),
        // The blocks face each other forever: neither turns before the end of its path. They meet at 2 and 3: in the
        // third step the block that comes first in the file moves first, and finds 3 occupied.
        (&[right.clone(), there("left", 1, "[[5, 0], [2, 0]]")], &["01222222", "54333333"]),
        // Both blocks move to 2: the one that comes first in the file gets there. The other one waits at 3.
        (&[right, there("left", 1, "[[4, 0], [2, 0]]")], &["01222222", "43333333"]),
        // A block may enter what an earlier one leaves. In the other order, the block behind finds the cell occupied at first, and
        // follows one step later.
        (&[ahead.clone(), behind.clone()], &["1122334", "0011223"]),
        (&[behind, ahead], &["0001122", "1122334"]),
    ];
    for (blocks, expected) in cases {
        let spec = spec("#########\n####R####\n.........", &blocks.concat());
        assert_eq!(columns(&spec, expected[0].len()), expected, "{blocks:?}");
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
