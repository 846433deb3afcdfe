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
fn worlds_read_the_same_when_written() {
    let made = (0..100).map(|seed| GridSpec::generate(&GenerateSettings::default(), seed));
    let kinds = ["grid-rooms", "grid-rooms-day", "calendar-office"];
    let named = kinds.iter().flat_map(|kind| (0..60).map(move |seed| format!("{kind}-{seed}")));
    let named =
        named.map(|name| worldfile::shipped::load_grid(&name).unwrap_or_else(|error| panic!("{error}")));
    for spec in shipped().chain(made).chain(named) {
        assert_eq!(spec.warnings(), [""; 0], "{}", spec.name);
        assert_eq!(worldfile::grid::parse("again.toml", &worldfile::grid::to_toml(&spec)), Ok(spec));
    }
}

#[test]
fn the_seed_matters_only_with_chance() {
    for spec in shipped() {
        assert_eq!(run(&spec, 1, 500), run(&spec, 2, 500));
        let spec = spec.with_probabilities(0.8, 0.8);
        assert_ne!(run(&spec, 1, 500), run(&spec, 2, 500));
    }
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
