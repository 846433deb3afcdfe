use super::*;
use crate::grid::{Course, GridWorld};
use interfaces::{GroundTruth, Step, World};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Properties of every generated world, for all settings.
fn check(spec: &GridSpec, seed: u64) {
    let (frame, walls) = (spec.frame(), &spec.walls);
    assert_eq!(spec.name, format!("generated-{seed}"));
    assert_eq!(spec.start, Cell::new(frame.width() as i32 / 2, frame.height() as i32 / 2));
    assert!(spec.warnings().is_empty(), "{seed}: {:?}", spec.warnings());
    for index in 0..frame.len() {
        let cell = frame.cell(index);
        let is_border = !(1..frame.width() as i32 - 1).contains(&cell.x)
            || !(1..frame.height() as i32 - 1).contains(&cell.y);
        assert!(walls.cells()[index] || !is_border);
    }
    // What is written reads as the same world, which means that no rule of files is broken.
    let mut taken = BTreeSet::from([spec.start]);
    for block in &spec.blocks {
        assert!(block.stood < block.dwell);
        assert_eq!(block.path.iter().collect::<BTreeSet<_>>().len(), block.path.len());
        for &cell in &block.path {
            assert!(!cell.neighbours8().iter().chain([&cell]).any(|near| taken.contains(near)), "{seed}");
        }
        taken.extend(&block.path);
    }
}

#[test]
fn two_hundred_generated_worlds_are_valid() {
    let settings = GenerateSettings::default();
    let (mut kinds, mut worlds) = (BTreeSet::new(), BTreeSet::new());
    for seed in 0..200 {
        let spec = GridSpec::generate(&settings, seed);
        check(&spec, seed);
        assert_eq!(spec, GridSpec::generate(&settings, seed));
        assert!((21..=31).contains(&spec.frame().width()) && (21..=27).contains(&spec.frame().height()));
        assert!((2..=6).contains(&spec.blocks.len()), "{seed}");
        for block in &spec.blocks {
            assert!((3..=20).contains(&block.path.len()) && (1..=60).contains(&block.dwell));
            let is_straight = block.path.iter().all(|c| c.x == block.path[0].x)
                || block.path.iter().all(|c| c.y == block.path[0].y);
            kinds.insert((block.course == Course::Loop, is_straight));
        }
        worlds.insert(spec.drawing());
        // Every block really moves over its whole path, if nothing is in its way.
        let longest = spec.blocks.iter().map(|block| block.dwell as usize * block.path.len()).max();
        let mut world = GridWorld::new(&spec, seed);
        for _ in 0..longest.unwrap() {
            world.act(&Step::Stay);
        }
        let truth = world.truth();
        for thing in truth.moving_things().iter() {
            // The block has left its first cell, and may not have returned.
            let never_entered = thing.iter().filter(|&&index| truth.block_events(index) == 0);
            assert!(never_entered.count() <= 1, "{seed}");
        }
    }
    assert_eq!(worlds.len(), 200);
    assert_eq!(Vec::from_iter(kinds), [(false, false), (false, true), (true, false)]);
}

#[test]
fn dwells_are_spread_over_orders_of_magnitude() {
    let settings = GenerateSettings { dwell: [1, 99], ..GenerateSettings::default() };
    let dwells: Vec<u32> = (0..300)
        .flat_map(|seed| {
            GridSpec::generate(&settings, seed).blocks.iter().map(|block| block.dwell).collect::<Vec<_>>()
        })
        .collect();
    // From 1 up to, but not at, 10 is half of the way to 100.
    let share = dwells.iter().filter(|dwell| **dwell < 10).count() as f64 / dwells.len() as f64;
    let error = (0.25 / dwells.len() as f64).sqrt();
    assert!((share - 0.5).abs() < 4.0 * error, "{share}");
    assert_eq!((dwells.iter().min(), dwells.iter().max()), (Some(&1), Some(&99)));
}

#[test]
fn settings_are_followed() {
    let settings = GenerateSettings {
        width: [41, 41],
        height: [15, 15],
        walls: [0, 0],
        pillars: [0, 0],
        blocks: [8, 8],
        path_cells: [6, 6],
        dwell: [5, 5],
        sensor_radius: 7,
        ..GenerateSettings::default()
    };
    let spec = GridSpec::generate(&settings, 3);
    check(&spec, 3);
    assert_eq!((spec.frame().width(), spec.frame().height(), spec.sensor_radius), (41, 15, 7));
    assert_eq!(spec.walls.cells().iter().filter(|wall| !**wall).count(), 39 * 13);
    assert_eq!(spec.blocks.len(), 8);
    for block in &spec.blocks {
        assert_eq!((block.path.len(), block.dwell), (6, 5));
    }
}

/// A pair of a setting within these limits.
fn pair(low: u32, high: u32) -> impl Strategy<Value = [u32; 2]> {
    [low..=high, low..=high].prop_map(|[a, b]| [a.min(b), a.max(b)])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Whatever the settings, there is a world, and it is one. Huge maps are left out for their
    /// time.
    #[test]
    fn any_settings_make_a_world(
        seed: u64, width in pair(9, 60), height in pair(9, 60), walls in pair(0, 90), opening in pair(1, 100),
        pillars in pair(0, 90), blocks in pair(0, 60), path_cells in pair(2, 1000), dwell in pair(1, 1_000_000),
        sensor_radius in 1..=100_u32,
    ) {
        let settings = GenerateSettings {
            width, height, walls, opening, pillars, blocks, path_cells, dwell, sensor_radius,
        };
        check(&GridSpec::generate(&settings, seed), seed);
    }
}
