use super::*;

/// A hash of all readings over 2000 steps, and of the ground truth at the end.
fn hash(spec: &GridSpec) -> String {
    let mut world = GridWorld::new(spec, 1);
    let mut numbers = Vec::new();
    let mut blocked_steps = vec![0; spec.frame().len()];
    for step in way(7).take(2000) {
        let reading = world.sense();
        let at = [reading.time, reading.pose.translation.x, reading.pose.translation.y];
        numbers.extend(at.map(f64::to_bits));
        let bits = |(cell, is_blocked): (Cell, bool)| {
            cell.x as u64 | (cell.y as u64) << 24 | u64::from(is_blocked) << 48
        };
        numbers.extend(reading.cells.into_iter().map(bits));
        for (index, steps) in blocked_steps.iter_mut().enumerate() {
            *steps += u64::from(world.truth().is_blocked(index));
        }
        world.act(&step);
    }
    for (index, steps) in blocked_steps.into_iter().enumerate() {
        numbers.extend([u64::from(world.truth().block_events(index)), steps]);
    }
    let bytes = numbers.into_iter().flat_map(u64::to_le_bytes).map(u64::from);
    format!("{:016x}", crate::fnv(bytes))
}

/// The same on every machine, until it is changed on purpose.
#[test]
fn shipped_worlds_run_as_they_always_did() {
    let mut hashes = String::new();
    for (name, text) in SHIPPED {
        let spec = worldfile::grid::parse(name, text).unwrap();
        let by_the_clock = hash(&spec);
        hashes +=
            &format!("{name}: {by_the_clock}, by chance {}\n", hash(&spec.with_probabilities(0.7, 0.9)));
    }
    insta::assert_snapshot!(hashes, @r"
    two_blocks: e970a69e6c41a6cd, by chance 4ac944466eb1f7bd
    open_hall: 709769880b71381a, by chance 9e2a62150fbedf0a
    corridor_with_doors: 4b4b061f25e80618, by chance a7a2cec6d99ad113
    many_slow_blocks: 5ff515c6f02080be, by chance c5e6b52655a6e689
    one_fast_block: 306ccf1da4c3478f, by chance 7885e3cea4be8365
    ");
}

#[test]
fn generated_worlds_are_what_they_always_were() {
    let worlds =
        (0..3).map(|seed| worldfile::grid::to_toml(&GridSpec::generate(&GenerateSettings::default(), seed)));
    insta::assert_snapshot!(worlds.collect::<Vec<_>>().join("\n"));
}
