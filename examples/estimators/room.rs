//! The physics world: the dummy robot drives back and forth in its room, and a laser at rest in the same room
//! observes it in visits.

use crate::score::{MASS, Mean, log_error};
use interfaces::{GroundTruth, TrueState};
use interfaces::{Twist, World};
use mapper::{EstimatorChoice, Mapper, MapperSettings};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use sim::physics::PhysicsWorld;

const HOUSE: &str = include_str!("../../worlds/four_rooms.toml");
/// The start of the curious robot in the world file; the laser stands there.
const START: &str = "pose_m = [2.0, 2.0]";
const PLACE: &str = "pose_m = [9.2, 9.3]";
/// As in `four_rooms`: the time for which a passing body may hide a cell, s.
const HIDING_S: f64 = 8.0;
const SCANS: u32 = 18_000;

/// The number of scans of a visit, and the mean number of scans from one visit to the next. The times between
/// visits are random: regular visits would observe the dummy robot at the same few places again and again.
pub(crate) const VISITS: [(u32, u32); 4] = [(1, 1), (300, 1200), (100, 1000), (30, 300)];

/// The scores of one estimator.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Score {
    pub(crate) log_error: Mean,
    pub(crate) bias: Mean,
    pub(crate) false_rate: Mean,
    pub(crate) covered: Mean,
}

/// Scores in the order of [`EstimatorChoice::all`], for every row of [`VISITS`].
pub(crate) fn judge() -> anyhow::Result<Vec<Vec<Score>>> {
    let spec = worldfile::physics::parse_world("four_rooms.toml", &HOUSE.replace(START, PLACE))?;
    let mut scores = Vec::new();
    for (seen, of) in VISITS {
        eprintln!("The dummy robot, {seen} of {of} scans");
        let mut world = PhysicsWorld::new(&spec, 0);
        let mapper = |estimator| {
            let settings = MapperSettings { estimator, max_gap: HIDING_S, ..MapperSettings::default() };
            Mapper::new(&settings, spec.frame)
        };
        let mut mappers: Vec<Mapper> =
            EstimatorChoice::all().into_iter().map(mapper).collect::<Result<_, _>>()?;
        let (mut rng, mut next) = (ChaCha8Rng::seed_from_u64(1), 0);
        for scan in 0..SCANS {
            let mut reading = world.sense();
            if scan == next + seen {
                next = scan + if of > seen { rng.random_range(0..=2 * (of - seen)) } else { 0 };
            }
            if scan < next {
                reading.scan.ranges_m.fill(f32::NAN); // The laser does not observe in this scan.
            }
            for mapper in &mut mappers {
                mapper.update(&reading)?;
            }
            world.act(&Twist::default());
        }
        scores.push(mappers.iter().map(|mapper| score(mapper, &world)).collect());
    }
    Ok(scores)
}

fn score(mapper: &Mapper, world: &PhysicsWorld) -> Score {
    let (truth, mut score) = (world.truth(), Score::default());
    for index in 0..mapper.frame().len() {
        let (rate, true_rate) = (mapper.rate(index), truth.cycle_rate(index));
        if true_rate > 0.0 {
            score.log_error.add(log_error(rate, true_rate));
            score.bias.add(rate / true_rate - 1.0);
            let (low, high) = mapper.credible_interval(index, MASS);
            score.covered.add_if((low..=high).contains(&true_rate));
        } else if !truth.is_swept(index) && truth.state(index) == TrueState::Free {
            score.false_rate.add(mapper.rate(index));
        }
    }
    score
}
