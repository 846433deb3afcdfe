//! Seeded random streams: one seed, and one independent ChaCha stream per purpose.
//!
//! A stream is chosen by its number ([`Purpose::stream_number`]), never by drawing from another stream. One
//! more draw for one purpose therefore changes no other purpose: adding a sonar does not change the noise
//! of a laser. The numbers are part of the promise that the same seed gives the same bits. Never change
//! one; append new purposes.

use rand::{Rng, TryRng};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::convert::Infallible;
use std::ops::Range;

/// The purpose of a [`RandomStream`]. Indices count robots, doors and blocks in the order of the world file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// Physics world: range noise of the lasers of a robot. Stream `index`.
    LaserNoise(usize),
    /// Physics world: odometry noise of a robot. Stream `1 << 32 | index`.
    OdometryNoise(usize),
    /// Physics world: decisions of a robot that drives by itself. Stream `2 << 32 | index`.
    Behavior(usize),
    /// Physics world: opening times of a door. Stream `3 << 32 | index`.
    Door(usize),
    /// Physics world: missing ranges of the lasers of a robot. Stream `4 << 32 | index`.
    LaserDropout(usize),
    /// Physics world: range noise of the sonars of a robot. Stream `5 << 32 | index`.
    SonarNoise(usize),
    /// Physics world: times and sizes of the jumps of the odometry of a robot. Stream `6 << 32 | index`.
    OdometryJump(usize),
    /// Physics world: times at which a robot is carried away, and where to. Stream `7 << 32 | index`.
    Carried(usize),
    /// Grid world: whether an action of the robot succeeds. Stream `1 << 60`.
    RobotTransition,
    /// Grid world: whether a due move of a block happens. Stream `(1 << 60) + 1 + index`.
    BlockTransition(usize),
    /// Agent in a physics world: choice of strategies and goals. Stream `1 << 48`.
    Agent,
    /// Controller in a physics world: random steps of local exploration. Stream `2 << 48`.
    Controller,
    /// Agent in a grid world. Stream `1 << 32`.
    GridAgent,
    /// Controller in a grid world. Stream `2 << 32`.
    GridController,
    /// Generator of random grid worlds. Stream 0.
    WorldGenerator,
    /// Generator of random houses. Stream `3 << 48`.
    HouseGenerator,
    /// Learning tasks: start poses and goals. Stream `4 << 48`.
    Task,
    /// The heading at the start of a robot whose map has a frame of its own. Stream `5 << 48`.
    MapFrame,
    /// Generator of buildings with a calendar. Stream `6 << 48`.
    DayGenerator,
    /// The strategy of a robot in a building with a calendar. Stream `7 << 48`.
    Patrol,
    /// What a thing in a building with a calendar does. Stream `8 << 48 | index`.
    Thing(usize),
    /// At which of its places a thing is. Stream `9 << 48 | index`.
    Place(usize),
}

impl Purpose {
    /// The number of the ChaCha stream of this purpose.
    pub fn stream_number(self) -> u64 {
        match self {
            Self::LaserNoise(index) => index as u64,
            Self::OdometryNoise(index) => 1 << 32 | index as u64,
            Self::Behavior(index) => 2 << 32 | index as u64,
            Self::Door(index) => 3 << 32 | index as u64,
            Self::LaserDropout(index) => 4 << 32 | index as u64,
            Self::SonarNoise(index) => 5 << 32 | index as u64,
            Self::OdometryJump(index) => 6 << 32 | index as u64,
            Self::Carried(index) => 7 << 32 | index as u64,
            Self::RobotTransition => 1 << 60,
            Self::BlockTransition(index) => (1 << 60) + 1 + index as u64,
            Self::Agent => 1 << 48,
            Self::Controller => 2 << 48,
            Self::GridAgent => 1 << 32,
            Self::GridController => 2 << 32,
            Self::WorldGenerator => 0,
            Self::HouseGenerator => 3 << 48,
            Self::Task => 4 << 48,
            Self::MapFrame => 5 << 48,
            Self::DayGenerator => 6 << 48,
            Self::Patrol => 7 << 48,
            Self::Thing(index) => 8 << 48 | index as u64,
            Self::Place(index) => 9 << 48 | index as u64,
        }
    }
}

/// A reproducible stream of random numbers: the same seed and purpose give the same numbers on every
/// machine. It implements [`rand::Rng`], so every distribution of `rand` can draw from it.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct RandomStream {
    rng: ChaCha8Rng,
    /// The polar method makes normal numbers in pairs: the second number of the last pair, until it is used.
    spare_normal: Option<f64>,
}

impl RandomStream {
    /// The stream of `seed` for `purpose`, at its beginning.
    pub fn new(seed: u64, purpose: Purpose) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(purpose.stream_number());
        Self { rng, spare_normal: None }
    }

    /// A uniformly distributed number in `range`.
    #[inline]
    pub fn uniform(&mut self, range: Range<f64>) -> f64 {
        range.start + (range.end - range.start) * self.unit()
    }

    /// A number of the standard normal distribution, by Marsaglia's polar method (1964).
    #[inline]
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare_normal.take() {
            return spare;
        }
        loop {
            let (u, v) = (self.symmetric_unit(), self.symmetric_unit());
            let square = u * u + v * v;
            if square > 0.0 && square < 1.0 {
                let scale = (-2.0 * libm::log(square) / square).sqrt();
                self.spare_normal = Some(v * scale);
                return u * scale;
            }
        }
    }

    /// A number of the exponential distribution with the mean `mean`, by inversion.
    #[inline]
    pub fn exponential(&mut self, mean: f64) -> f64 {
        -mean * libm::log(1.0 - self.unit())
    }

    /// A Bernoulli draw: true with `probability`. If `probability` is 1 or more, the result is true and no number
    /// is drawn.
    #[inline]
    pub fn bernoulli(&mut self, probability: f64) -> bool {
        probability >= 1.0 || self.unit() < probability
    }

    /// Uniform in [0, 1), in steps of 2⁻⁵³.
    #[inline]
    fn unit(&mut self) -> f64 {
        (self.rng.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// Uniform in [−1, 1), in steps of 2⁻⁵².
    #[inline]
    fn symmetric_unit(&mut self) -> f64 {
        (self.rng.next_u64() >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
    }
}

impl TryRng for RandomStream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.rng.next_u32())
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.rng.next_u64())
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        self.rng.fill_bytes(bytes);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_are_standard_normal() {
        let mut stream = RandomStream::new(1, Purpose::LaserNoise(0));
        let draws: Vec<f64> = (0..100_000).map(|_| stream.normal()).collect();
        let moment = |power: i32| draws.iter().map(|draw| draw.powi(power)).sum::<f64>() / draws.len() as f64;
        // Four standard errors of each moment.
        assert!(moment(1).abs() < 4.0 * 0.0032);
        assert!((moment(2) - 1.0).abs() < 4.0 * 0.0045);
        assert!((moment(4) - 3.0).abs() < 4.0 * 0.031);
    }

    #[test]
    fn streams_differ_by_seed_purpose_and_index() {
        let first = |seed, purpose| RandomStream::new(seed, purpose).normal();
        let draws = [
            first(1, Purpose::LaserNoise(0)),
            first(2, Purpose::LaserNoise(0)),
            first(1, Purpose::OdometryNoise(0)),
            first(1, Purpose::LaserNoise(1)),
        ];
        assert!((0..4).all(|a| (0..a).all(|b| draws[a] != draws[b])));
        assert_eq!(draws[0], first(1, Purpose::LaserNoise(0)));
    }

    #[test]
    fn purposes_of_one_world_share_no_stream() {
        let per_index = |index| {
            [
                Purpose::LaserNoise(index),
                Purpose::OdometryNoise(index),
                Purpose::Behavior(index),
                Purpose::Door(index),
                Purpose::LaserDropout(index),
                Purpose::SonarNoise(index),
                Purpose::OdometryJump(index),
                Purpose::Carried(index),
            ]
        };
        let once =
            [Purpose::Agent, Purpose::Controller, Purpose::HouseGenerator, Purpose::Task, Purpose::MapFrame];
        let physics = (0..1000).flat_map(per_index).chain(once);
        let blocks = (0..1000).map(Purpose::BlockTransition);
        let grid = blocks.chain([Purpose::RobotTransition, Purpose::GridAgent, Purpose::GridController]);
        for purposes in [physics.collect::<Vec<_>>(), grid.collect()] {
            let mut numbers: Vec<u64> = purposes.iter().map(|purpose| purpose.stream_number()).collect();
            numbers.sort_unstable();
            numbers.dedup();
            assert_eq!(numbers.len(), purposes.len());
        }
    }

    #[test]
    fn a_certain_event_draws_nothing() {
        let (mut drawn, untouched) =
            (RandomStream::new(3, Purpose::Agent), RandomStream::new(3, Purpose::Agent));
        assert!(drawn.bernoulli(1.0));
        assert_eq!(drawn, untouched);
        let successes = (0..10_000).filter(|_| drawn.bernoulli(0.3)).count();
        assert!((2800..3200).contains(&successes), "{successes}");
    }
}
