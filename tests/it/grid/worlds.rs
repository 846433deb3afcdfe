//! The worlds of trials: shipped worlds, files, and generated worlds.

use super::{hash, ran, results};
use crate::run::{Run, names};
use std::collections::BTreeSet;

const ONE: &str = "--steps 600 --trials 1 --estimator paper --strategy recency";

#[test]
fn a_file_runs_as_the_shipped_world_does() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/open_hall.toml");
    assert_eq!(hash(&format!("{ONE} --world open_hall")), hash(&format!("{ONE} --world {file}")));
}

#[test]
fn worlds_can_be_repeated_and_come_in_their_order() {
    let run =
        ran(&format!("{ONE} --world open_hall --world two_blocks --generate 2 --seed 5 --world open_hall"));
    let worlds: Vec<String> = results(&run).into_iter().map(|result| result.world).collect();
    assert_eq!(worlds, ["open hall", "two blocks", "generated-5", "generated-6"]);
}

#[test]
fn a_saved_world_is_the_one_that_was_made() {
    let run = ran(&format!("{ONE} --generate 3 --seed 11 --save-worlds --sensor-radius 5 --stochastic 0.9"));
    let mut hashes = BTreeSet::new();
    for (number, result) in results(&run).iter().enumerate() {
        let name = format!("generated-{}", 11 + number);
        assert_eq!(result.world, name);
        let file = run.out(&format!("{name}.toml"));
        let again = hash(&format!("{ONE} --seed 11 --world {}", file.display()));
        assert_eq!(result.hashes[0].1, again, "{name}");
        hashes.insert(again);
    }
    assert_eq!(hashes.len(), 3);
    assert_eq!(names(&run.path("out")).iter().filter(|name| name.ends_with(".toml")).count(), 3);
    // Nothing asked for them.
    assert!(
        names(&ran(&format!("{ONE} --generate 2")).path("out")).iter().all(|name| !name.ends_with(".toml"))
    );
}

#[test]
fn the_sensor_radius_and_chance_of_the_world_can_be_changed() {
    let mut hashes = BTreeSet::new();
    for change in ["", "--sensor-radius 3", "--sensor-radius 8", "--stochastic", "--stochastic 0.5"] {
        hashes.insert(hash(&format!("{ONE} {change}")));
    }
    assert_eq!(hashes.len(), 5);
    // The probability in the world file, and the default.
    assert!(hashes.contains(&hash(&format!("{ONE} --sensor-radius 4"))));
    assert!(hashes.contains(&hash(&format!("{ONE} --stochastic 0.8"))));
    assert_eq!(super::report(&ran(&format!("{ONE} --sensor-radius 7")))["sensor_radius"], 7);
}

#[test]
fn a_part_that_cannot_be_reached_is_a_warning() {
    let world = include_str!("../../../worlds/two_blocks.toml");
    let closet = world.replacen(
        "\n#.......#...............#\n#.......#...............#\n",
        "\n#.......#...............#\n#.......#...........#####\n",
        1,
    );
    let closet = closet.replacen(
        "\n#.......................#\n#.......................#\n",
        "\n#...................#...#\n#...................#####\n",
        1,
    );
    assert_ne!(closet, world);
    let run = Run::of("grid_world");
    run.write("closet.toml", &closet);
    let ended = run.goes_well(&format!("{ONE} --world closet.toml"));
    insta::assert_snapshot!(ended.stderr, @"warning: two blocks: the robot cannot reach the 3 cells around [21, 21]");
    assert_eq!(results(&run).len(), 1);
    assert_eq!(run.goes_well(&format!("{ONE} --quiet --world closet.toml")).stderr, "");
}
