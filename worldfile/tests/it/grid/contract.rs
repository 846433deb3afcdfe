use super::*;
use interfaces::CellReading;

fn run(spec: &GridSpec, seed: u64, steps: usize) -> Vec<CellReading> {
    let mut world = GridWorld::new(spec, seed);
    let mut readings = vec![world.sense()];
    for step in way(4).take(steps) {
        world.act(&step);
        readings.push(world.sense());
    }
    readings
}

fn shipped() -> impl Iterator<Item = GridSpec> {
    SHIPPED
        .into_iter()
        .map(|(name, text)| worldfile::grid::parse(name, text).unwrap_or_else(|error| panic!("{error}")))
}

#[test]
fn shipped_worlds_are_without_warnings_and_read_the_same_when_written() {
    for spec in shipped() {
        assert!(spec.warnings().is_empty(), "{}: {:?}", spec.name, spec.warnings());
        assert_eq!(worldfile::grid::parse("again.toml", &worldfile::grid::to_toml(&spec)), Ok(spec));
    }
    for seed in 0..100 {
        let spec = GridSpec::generate(&GenerateSettings::default(), seed);
        assert_eq!(worldfile::grid::parse("again.toml", &worldfile::grid::to_toml(&spec)), Ok(spec));
    }
}

#[test]
fn time_goes_forward_by_one() {
    for (step, reading) in run(&GridSpec::generate(&GenerateSettings::default(), 1), 0, 50).iter().enumerate()
    {
        assert_eq!(reading.time, step as f64);
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    for spec in shipped() {
        let spec = spec.with_probabilities(0.8, 0.8);
        let first = run(&spec, 1, 500);
        assert_eq!(first, run(&spec, 1, 500));
        assert_ne!(first, run(&spec, 2, 500));
    }
}

#[test]
fn looking_changes_nothing() {
    let spec = shipped().next().unwrap().with_probabilities(0.5, 0.5);
    let (mut one, mut two) = (GridWorld::new(&spec, 5), GridWorld::new(&spec, 5));
    for step in way(2).take(200) {
        let first = one.sense();
        assert_eq!(first, one.sense());
        one.act(&step);
        two.act(&step);
    }
    assert_eq!(one.sense(), two.sense());
}

/// The robot observes the true states of cells in the map and within range, each cell once.
#[test]
fn readings_are_true() {
    for spec in shipped().chain([GridSpec::generate(&GenerateSettings::default(), 9).with_sensor_radius(12)])
    {
        let mut world = GridWorld::new(&spec, 0);
        let radius = spec.sensor_radius as i32;
        for step in way(3).take(400) {
            world.act(&step);
            let (robot, mut seen) = (world.robot(), std::collections::BTreeSet::new());
            for (cell, is_blocked) in world.sense().cells {
                let index = spec.frame().index(cell).unwrap();
                assert_eq!(world.truth().is_blocked(index), is_blocked);
                assert!((cell.x - robot.x).pow(2) + (cell.y - robot.y).pow(2) <= radius.pow(2));
                assert!(seen.insert(cell));
            }
        }
    }
}
