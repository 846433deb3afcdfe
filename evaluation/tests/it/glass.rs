//! Beams without a return: in a world whose walls swallow beams they say nothing, in a long hall they say that it is free.

use interfaces::{CellState, GroundTruth, LaserReading, Twist, World};
use mapper::{Mapper, MapperSettings, NoReturn, NoReturns};
use sim::physics::{PhysicsWorld, WorldSpec};

/// A hall of 24 × 6 m, longer than the range of the laser, with this last key of its upper wall.
fn hall(upper_wall: &str) -> WorldSpec {
    let text = include_str!("../../../ros2/src/node/tests/hall.toml").replace("beams = 360", "beams = 720");
    let text = text.replace("# the last key of the upper wall", upper_wall);
    worldfile::physics::parse_world("hall.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// What a run in the hall has learned.
struct Run {
    is_trusted: bool,
    swallowed: f64,
    /// The number of times that a cell of a wall was cleared.
    cleared: usize,
    /// The number of free cells on the map.
    free: usize,
}

/// Two minutes of rounds in the hall, as the live node maps them.
fn run(spec: &WorldSpec, meaning: NoReturn) -> Run {
    let mut world = PhysicsWorld::new(spec, 1);
    let mut mapper = Mapper::new(&MapperSettings::default(), *world.truth().frame()).unwrap();
    let mut no_returns = NoReturns::new(meaning);
    let (mut cleared, mut last) = (0, None::<LaserReading>);
    for _ in 0..1200 {
        let reading = world.sense();
        let mut filtered = reading.clone();
        no_returns.apply(&mut filtered);
        no_returns.protect(&mut filtered);
        mapper.update(&filtered).unwrap();
        no_returns.learn(&reading);
        let is_wall = |y: i32| y >= 118;
        let gone = mapper.transitions().iter().filter(|transition| transition.before == CellState::Blocked);
        cleared += gone.filter(|transition| is_wall(transition.cell.y)).count();
        last = Some(reading);
        world.act(&Twist { linear_mps: 0.4, angular_radps: 0.2 });
    }
    let is_trusted = no_returns.is_trusted(&last.unwrap());
    let free = mapper.states().cells().iter().filter(|state| **state == CellState::Free).count();
    let swallowed = no_returns.evidence().map(|scanner| scanner.swallowed()).fold(0.0, f64::max);
    Run { is_trusted, swallowed, cleared, free }
}

fn runs(spec: &WorldSpec) -> [Run; 3] {
    [NoReturn::Learn, NoReturn::Free, NoReturn::Ignore].map(|meaning| run(spec, meaning))
}

#[test]
fn nothing_is_cleared_through_glass() {
    for within_deg in [15.0, 30.0] {
        let [learned, free, ignored] = runs(&hall(&format!("returns_within_deg = {within_deg}")));
        assert!(free.cleared > 500, "without care, glass is cleared: {} cells", free.cleared);
        assert!(!learned.is_trusted && learned.swallowed > 0.1, "{}", learned.swallowed);
        assert_eq!((learned.cleared, learned.free), (0, ignored.free));
    }
}

#[test]
fn a_long_hall_is_free_to_the_maximum_range() {
    let [learned, free, ignored] = runs(&hall(""));
    assert!(learned.is_trusted && learned.swallowed < 0.01, "{}", learned.swallowed);
    assert!(ignored.free + 5000 < free.free, "{} {}", ignored.free, free.free);
    let missing = free.free - learned.free;
    assert!(missing * 100 < free.free && learned.cleared == 0, "{missing} of {} cells", free.free);
}
