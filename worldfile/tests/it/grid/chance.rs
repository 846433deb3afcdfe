use super::*;

/// Pearson's statistic of observed against expected counts.
fn chi_square(counts: &[(f64, f64)]) -> f64 {
    counts.iter().map(|(found, expected)| (found - expected).powi(2) / expected).sum()
}

#[test]
fn a_block_that_is_due_moves_with_its_chance() {
    let spec = spec("####\n#R##\n....", &block("b", 3, "back-and-forth", "[[0, 0], [3, 0]]"))
        .with_probabilities(0.3, 1.0);
    let mut world = GridWorld::new(&spec, 11);
    let (mut waits, mut since, mut before) = (vec![0.0; 8], 0, world.blocks().next().unwrap().1);
    let mut moves = 0.0;
    for step in 1..=200_000 {
        world.act(&Step::Stay);
        let cell = world.blocks().next().unwrap().1;
        if cell != before {
            // The dwell, and the number of failed attempts.
            let wait: usize = step - since - 3;
            waits[wait.min(7)] += 1.0;
            moves += 1.0;
            (before, since) = (cell, step);
        }
    }
    let share = |wait: usize| if wait < 7 { 0.3 * 0.7_f64.powi(wait as i32) } else { 0.7_f64.powi(7) };
    let counts: Vec<(f64, f64)> = (0..8).map(|wait| (waits[wait], moves * share(wait))).collect();
    // 7 degrees of freedom: 1 in 1000 is above 24.3.
    assert!(chi_square(&counts) < 24.3, "{counts:?}");
    assert!(moves > 30_000.0);
}

#[test]
fn an_action_happens_with_its_chance() {
    let spec = spec("....\nR...\n....", "").with_probabilities(1.0, 0.6);
    let mut world = GridWorld::new(&spec, 12);
    let (mut moves, mut pairs) = (0.0, 0.0);
    let mut moved_before = false;
    for _ in 0..100_000 {
        let before = world.robot();
        world.act(&if before.x == 0 { Step::Right } else { Step::Left });
        let moved = world.robot() != before;
        moves += f64::from(u8::from(moved));
        pairs += f64::from(u8::from(moved && moved_before));
        moved_before = moved;
    }
    // 1 in 1000 is above 10.8. Whether one move happens must not depend on the one before.
    assert!(chi_square(&[(moves, 60_000.0), (100_000.0 - moves, 40_000.0)]) < 10.8, "{moves}");
    assert!((pairs / 100_000.0 - 0.36).abs() < 4.0 * 0.0021, "{pairs}");
}

#[test]
fn what_the_robot_does_is_no_chance_of_a_block() {
    let chance = |spec: GridSpec| spec.with_probabilities(0.5, 0.5);
    let blocks = block("a", 2, "loop", "[[0, 0], [5, 0], [5, 1], [0, 1]]")
        + &block("b", 1, "loop", "[[0, 3], [1, 3], [1, 2], [0, 2]]");
    let spec = chance(spec(
        "......\n......\n......\n......\n######\n...R..\n......\n######\n......\n......\n......\n......",
        &blocks,
    ));
    let (mut still, mut busy) = (GridWorld::new(&spec, 3), GridWorld::new(&spec, 3));
    for step in way(1).take(300) {
        still.act(&Step::Stay);
        busy.act(&step);
        assert!(still.blocks().eq(busy.blocks()));
    }
    assert_ne!(still.robot(), busy.robot());
}

#[test]
fn blocks_have_chances_of_their_own() {
    let line = |name: &str, y: u32| block(name, 1, "back-and-forth", &format!("[[0, {y}], [3, {y}]]"));
    let spec =
        |blocks: &[String]| spec("....\n....\n....\nR...", &blocks.concat()).with_probabilities(0.5, 1.0);
    let run = |spec: &GridSpec| {
        let mut world = GridWorld::new(spec, 5);
        let step = |_| {
            world.act(&Step::Stay);
            world.blocks().map(|(_, cell)| cell.x).collect::<Vec<_>>()
        };
        (0..100).map(step).collect::<Vec<_>>()
    };
    let both = run(&spec(&[line("one", 1), line("two", 3)]));
    assert!(both.iter().any(|columns| columns[0] != columns[1]));
    // Another block uses another random stream.
    let one = run(&spec(&[line("one", 1)]));
    assert!(both.iter().zip(&one).all(|(both, one)| both[0] == one[0]));
}
