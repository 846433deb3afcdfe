//! Properties of every world that a robot can run in.

use curious::worlds;
use interfaces::{Reading, Step, Twist, World};
use sim::grid::{GenerateSettings, GridSpec, GridWorld};
use sim::physics::PhysicsWorld;
use std::fmt::Debug;

/// How commands are given to a world.
struct Words<C> {
    /// Valid commands; they are repeated.
    sane: Vec<C>,
    /// Invalid commands, each with the valid command that replaces it.
    absurd: Vec<(C, C)>,
}

/// Ticks of a trial.
const TICKS: usize = 200;

/// Tests a world; `make` makes a world from a seed.
fn keeps_the_contract<W>(make: impl Fn(u64) -> W, words: &Words<W::Command>)
where
    W: World<Reading: Reading + Debug + PartialEq>,
{
    let sane = |tick: usize| &words.sane[tick % words.sane.len()];
    let life = |seed: u64, looks: usize| -> Vec<W::Reading> {
        let mut world = make(seed);
        let tick = |tick: usize| {
            let reading = world.sense();
            for _ in 1..looks {
                assert_eq!(world.sense(), reading, "a second look shows something else");
            }
            world.act(sane(tick));
            reading
        };
        (0..TICKS).map(tick).collect()
    };
    let readings = life(1, 1);

    // Time begins at zero and increases in equal steps.
    let times: Vec<f64> = readings.iter().map(Reading::time).collect();
    assert_eq!(times[0], 0.0);
    let period = times[1];
    assert!(period > 0.0);
    assert!(times.windows(2).all(|pair| (pair[1] - pair[0] - period).abs() < 1e-9), "{times:?}");
    assert!(readings.iter().all(is_finite));
    assert!(readings.iter().any(|reading| reading.pose() != readings[0].pose()), "nothing moves");

    // The same seed and commands give the same readings, however often the robot senses.
    assert_eq!(life(1, 1), readings);
    assert_eq!(life(1, 3), readings, "looking changes what comes");

    // An invalid command has the same effect as the valid command that replaces it, repeatedly.
    for (absurd, taken_for) in &words.absurd {
        let (mut world, mut twin) = (make(1), make(1));
        for tick in 0..TICKS {
            let reading = world.sense();
            assert!(is_finite(&reading), "{reading:?}");
            assert_eq!(reading, twin.sense());
            let is_absurd = tick % 20 < 10;
            world.act(if is_absurd { absurd } else { sane(tick) });
            twin.act(if is_absurd { taken_for } else { sane(tick) });
        }
    }
}

fn is_finite(reading: &impl Reading) -> bool {
    let pose = reading.pose();
    let figures =
        [reading.time(), pose.translation.x, pose.translation.y, pose.rotation.re, pose.rotation.im];
    figures.iter().all(|figure| figure.is_finite())
}

/// Twists, for a robot with limits of 100 m/s and 100 rad/s.
fn twists() -> Words<Twist> {
    let twist = |linear_mps, angular_radps| Twist { linear_mps, angular_radps };
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    Words {
        sane: vec![twist(0.5, 0.0), twist(0.3, 1.0), twist(-0.1, -0.5), Twist::STOP],
        absurd: vec![
            (twist(nan, 0.0), Twist::STOP),
            (twist(0.5, nan), Twist::STOP),
            (twist(nan, inf), Twist::STOP),
            (twist(inf, 0.0), twist(100.0, 0.0)),
            (twist(-inf, inf), twist(-100.0, 100.0)),
            (twist(1e300, -1e300), twist(100.0, -100.0)),
            (twist(-1e300, f64::MIN_POSITIVE), twist(-100.0, f64::MIN_POSITIVE)),
        ],
    }
}

#[test]
fn physics_worlds() {
    for (name, _) in worlds::SHIPPED {
        let spec = worlds::load(name).unwrap().spec;
        keeps_the_contract(|seed| PhysicsWorld::new(&spec, seed), &twists());
    }
}

/// Steps, long enough in one direction to meet a wall. All of them are valid.
fn steps() -> Words<Step> {
    let sane = Step::ALL.into_iter().flat_map(|step| std::iter::repeat_n(step, 7)).collect();
    Words { sane, absurd: Vec::new() }
}

#[test]
fn grid_worlds() {
    let shipped = worlds::SHIPPED_GRID.map(|(name, _)| worlds::load_grid(name).unwrap());
    let made = (0..5).map(|seed| GridSpec::generate(&GenerateSettings::default(), seed));
    for spec in shipped.into_iter().chain(made) {
        for spec in [spec.clone(), spec.with_probabilities(0.7, 0.9)] {
            keeps_the_contract(|seed| GridWorld::new(&spec, seed), &steps());
        }
    }
}
