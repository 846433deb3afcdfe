use super::snapshot::{Played, Tape};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::ops::Range;

/// What a stream of chance is for. One more draw in one stream never changes another.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    /// The noise of ranges.
    Laser = 0,
    /// The drift of odometry.
    Odometry = 1,
    /// What a robot does by itself.
    Behaviour = 2,
    /// When a door opens and closes.
    Door = 3,
    /// Which ranges are missing.
    Dropout = 4,
    /// The noise of sonars.
    Sonar = 5,
}

/// The stream of a robot or door (by its place in the world) for one purpose.
fn stream(seed: u64, purpose: Purpose, robot: usize) -> ChaCha8Rng {
    let mut stream = ChaCha8Rng::seed_from_u64(seed);
    stream.set_stream((purpose as u64) << 32 | robot as u64);
    stream
}

fn play_stream(stream: &mut ChaCha8Rng, tape: &mut Tape<'_>) -> Played {
    let mut place = stream.get_word_pos();
    tape.u128(&mut place)?;
    stream.set_word_pos(place);
    Ok(())
}

/// Uniform numbers from a stream of their own, the same on every machine.
#[derive(Clone, Debug)]
pub(super) struct Uniform {
    stream: ChaCha8Rng,
}

impl Uniform {
    /// The stream of a robot or door (by its place in the world) for one purpose.
    pub(super) fn new(seed: u64, purpose: Purpose, robot: usize) -> Self {
        Self { stream: stream(seed, purpose, robot) }
    }

    /// Writes or reads how far the stream has come.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        play_stream(&mut self.stream, tape)
    }

    /// The next number, in `range`.
    pub(super) fn between(&mut self, range: Range<f64>) -> f64 {
        let share = (self.stream.next_u64() >> 11) as f64 * 2.0_f64.powi(-53);
        range.start + (range.end - range.start) * share
    }
}

/// Standard normal numbers from a stream of their own, the same on every machine.
#[derive(Clone, Debug)]
pub(super) struct Gaussian {
    stream: ChaCha8Rng,
    /// The polar method makes numbers in pairs.
    spare: Option<f64>,
}

impl Gaussian {
    /// The stream of a robot (by its place in the world) for one purpose.
    pub(super) fn new(seed: u64, purpose: Purpose, robot: usize) -> Self {
        Self { stream: stream(seed, purpose, robot), spare: None }
    }

    /// Writes or reads how far the stream has come.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        play_stream(&mut self.stream, tape)?;
        tape.option(&mut self.spare, || 0.0, Tape::f64)
    }

    /// The next number, by Marsaglia's polar method (1964).
    pub(super) fn draw(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (u, v) = (self.uniform(), self.uniform());
            let square = u * u + v * v;
            if square > 0.0 && square < 1.0 {
                let scale = (-2.0 * libm::log(square) / square).sqrt();
                self.spare = Some(v * scale);
                return u * scale;
            }
        }
    }

    /// Uniform in [−1, 1), on a grid of 2⁻⁵².
    fn uniform(&mut self) -> f64 {
        (self.stream.next_u64() >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_standard_normal() {
        let mut gaussian = Gaussian::new(1, Purpose::Laser, 0);
        let draws: Vec<f64> = (0..100_000).map(|_| gaussian.draw()).collect();
        let moment = |power: i32| draws.iter().map(|draw| draw.powi(power)).sum::<f64>() / draws.len() as f64;
        // Four standard errors of each moment.
        assert!(moment(1).abs() < 4.0 * 0.0032);
        assert!((moment(2) - 1.0).abs() < 4.0 * 0.0045);
        assert!((moment(4) - 3.0).abs() < 4.0 * 0.031);
    }

    #[test]
    fn streams_differ_by_seed_purpose_and_robot() {
        let first = |seed, purpose, robot| Gaussian::new(seed, purpose, robot).draw();
        let draws = [
            first(1, Purpose::Laser, 0),
            first(2, Purpose::Laser, 0),
            first(1, Purpose::Odometry, 0),
            first(1, Purpose::Laser, 1),
        ];
        assert!((0..4).all(|a| (0..a).all(|b| draws[a] != draws[b])));
        assert_eq!(draws[0], first(1, Purpose::Laser, 0));
    }
}
