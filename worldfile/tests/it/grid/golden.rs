use super::*;

/// FNV-1a with 64 bits: a fixed hash function.
struct Hash(u64);

impl Hash {
    fn add(&mut self, number: u64) {
        for byte in number.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
}

/// A hash of all readings over 2000 steps, and of the ground truth at the end.
fn hash(spec: &GridSpec) -> String {
    let mut world = GridWorld::new(spec, 1);
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    let mut blocked_steps = vec![0; spec.frame().len()];
    for step in way(7).take(2000) {
        let reading = world.sense();
        for value in [reading.time, reading.pose.translation.x, reading.pose.translation.y] {
            hash.add(value.to_bits());
        }
        for (cell, is_blocked) in reading.cells {
            hash.add(cell.x as u64 | (cell.y as u64) << 24 | u64::from(is_blocked) << 48);
        }
        for (index, steps) in blocked_steps.iter_mut().enumerate() {
            *steps += u64::from(world.truth().is_blocked(index));
        }
        world.act(&step);
    }
    for (index, steps) in blocked_steps.into_iter().enumerate() {
        hash.add(u64::from(world.truth().block_events(index)));
        hash.add(steps);
    }
    format!("{:016x}", hash.0)
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
