use super::*;
use interfaces::TrueChange;
use proptest::prelude::*;

/// The ground truth, computed independently: walls, and the present positions of the blocks.
fn blocked(world: &GridWorld) -> Vec<bool> {
    let mut blocked = world.spec().walls.clone();
    for (_, cell) in world.blocks() {
        *blocked.get_mut(cell).unwrap() = true;
    }
    blocked.cells().to_vec()
}

/// The indices of the cells that changed in the last step.
fn changed(world: &GridWorld) -> Vec<usize> {
    let truth = world.truth();
    let index = |change: &TrueChange| {
        let (cell, state) = (change.cell, truth.frame().index(change.cell).map(|index| truth.state(index)));
        assert_eq!((Some(change.after), change.time), (state, truth.elapsed()));
        assert_ne!(change.before, change.after);
        truth.frame().index(cell).unwrap()
    };
    truth.changes().iter().map(index).collect()
}

fn can_be_seen(world: &GridWorld) -> String {
    let frame = world.truth().frame();
    let row = |y: usize| {
        let cells = y * frame.width()..(y + 1) * frame.width();
        cells.map(|index| if world.truth().can_be_seen(index) { 'o' } else { '-' }).collect::<String>()
    };
    (0..frame.height()).rev().map(|y| row(y) + "\n").collect()
}

#[test]
fn free_cells_and_the_sides_of_blocked_ones_can_be_seen() {
    let drawing = "########\n#R....##\n#....###\n########\n#..#...#\n########";
    let mut world = GridWorld::new(&spec(drawing, &block("b", 1, "back-and-forth", "[[3, 3], [4, 3]]")), 0);
    insta::assert_snapshot!(can_be_seen(&world), @r"
    -ooooo--
    ooooooo-
    oooooo--
    -oo-o---
    --------
    --------
    ");
    // The wall on the right of the block has lost its last free neighbor, and the block's old cell
    // is free.
    world.act(&Step::Stay);
    insta::assert_snapshot!(can_be_seen(&world), @r"
    -ooooo--
    ooooooo-
    oooooo--
    -ooo----
    --------
    --------
    ");
}

#[test]
fn what_a_block_shuts_in_can_still_be_seen() {
    let drawing = "#####\n#R.##\n#.###\n#.###\n#####";
    let spec = spec(drawing, &block("b", 5, "back-and-forth", "[[1, 2], [1, 1]]"));
    let world = GridWorld::new(&spec, 0);
    insta::assert_snapshot!(can_be_seen(&world), @r"
    -oo--
    oooo-
    -oo--
    ooo--
    -o---
    ");
}

#[test]
fn things_are_the_cells_of_paths() {
    let blocks = block("a", 1, "back-and-forth", "[[2, 2], [0, 2]]")
        + &block("b", 1, "loop", "[[0, 1], [0, 2], [1, 2], [1, 1]]");
    let world = GridWorld::new(&spec("...\n...\n..R", &blocks), 0);
    let truth = world.truth();
    assert_eq!(*truth.moving_things(), [vec![6, 7, 8], vec![3, 4, 6, 7]]);
    assert_eq!(*truth.swept(), [3, 4, 6, 7, 8]);
    assert_eq!((0..9).filter(|&index| truth.is_swept(index)).collect::<Vec<_>>(), *truth.swept());
    assert_eq!((truth.elapsed(), truth.cycle_rate(6)), (0.0, 0.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Every value equals the one that is counted by observing the world after every step.
    #[test]
    fn counts_are_those_of_a_recount(seed in 0..10_000_u64, chance in 0.2..1.3_f64, narrow: bool) {
        // In a narrow map, blocks and robot block each other.
        let side = if narrow { [9, 10] } else { [15, 25] };
        let settings = GenerateSettings { width: side, height: side, dwell: [1, 8], ..GenerateSettings::default() };
        let mut spec = GridSpec::generate(&settings, seed).with_probabilities(chance, chance);
        if narrow {
            // Every block a second time in the opposite direction: they meet.
            let mut more = spec.blocks.to_vec();
            more.iter_mut().for_each(|block| {
                block.path.reverse();
                block.name += " again";
            });
            spec.blocks.extend(more);
        }
        let mut world = GridWorld::new(&spec, seed);
        let cells = spec.frame().len();
        let (mut before, mut time) = (blocked(&world), 0);
        let mut block_events = vec![0; cells];
        for step in way(seed).take(300) {
            world.act(&step);
            let now = blocked(&world);
            time += 1;
            let mut changes = Vec::new();
            for index in 0..cells {
                if before[index] != now[index] {
                    block_events[index] += u32::from(now[index]);
                    changes.push(index);
                }
            }
            let truth = world.truth();
            let mut reported = changed(&world);
            reported.sort_unstable();
            prop_assert_eq!(reported, changes);
            prop_assert!((0..cells).all(|index| truth.is_blocked(index) == now[index]));
            prop_assert!(!now[spec.frame().index(world.robot()).unwrap()]);
            before = now;
        }
        let truth = world.truth();
        for (index, events) in block_events.into_iter().enumerate() {
            prop_assert_eq!(truth.block_events(index), events);
            prop_assert_eq!(truth.cycle_rate(index), f64::from(events) / f64::from(time));
            prop_assert!(events == 0 || truth.is_swept(index));
        }
    }
}
