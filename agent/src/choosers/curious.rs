use super::tile_coder::TileCoder;
use super::{Chooser, Trajectory};
use crate::goal_sampler::proportional;
use crate::situation::{Features, Situation};
use interfaces::{RandomStream, Values, value};

/// λ: the share of a tile's weight that one visit replaces by the reward (section 4).
const LEARNING_RATE: f64 = 0.9;

/// The paper's learner (section 4): every strategy has a value function over (p, r) that is learned from rewards,
/// and is chosen with a probability ∝ exp(V/τ). All values start at 0, so that the first choice is uniform.
#[derive(Clone, Debug)]
pub struct Curious {
    temperature: f64,
    /// One value function per strategy.
    values: Vec<TileCoder>,
}

impl Curious {
    /// A learner that has learned nothing. The offsets of the tilings are drawn at random.
    pub fn new(temperature: f64, strategies: usize, rng: &mut RandomStream) -> Self {
        Self { temperature, values: (0..strategies).map(|_| TileCoder::new(rng)).collect() }
    }

    /// The probability with which each strategy is chosen at `features`.
    pub fn probabilities(&self, features: Features) -> Vec<f64> {
        let values: Vec<f64> = self.values.iter().map(|coder| coder.value(features)).collect();
        softmax(&values, self.temperature)
    }
}

impl Chooser for Curious {
    fn choose(&mut self, situation: &Situation, rng: &mut RandomStream) -> usize {
        let probabilities = self.probabilities(situation.features);
        proportional(probabilities.into_iter(), rng).unwrap_or(0)
    }

    fn learn(&mut self, trajectory: &Trajectory) {
        let coder = &mut self.values[trajectory.strategy];
        coder.learn(trajectory.features, trajectory.reward, LEARNING_RATE);
    }

    fn value(&self, strategy: usize, features: Features) -> Option<f64> {
        Some(self.values.get(strategy)?.value(features))
    }

    fn values(&mut self) -> Values<'_> {
        vec![value(&mut self.values)]
    }
}

/// Probabilities ∝ exp(value/temperature). The largest value is subtracted first. This does not change the result;
/// it prevents overflow, and at least one exponential is 1.
fn softmax(values: &[f64], temperature: f64) -> Vec<f64> {
    let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let odds: Vec<f64> = values.iter().map(|value| libm::exp((value - max) / temperature)).collect();
    let sum: f64 = odds.iter().sum();
    odds.into_iter().map(|odds| odds / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{GridFrame, Purpose};
    use mapper::{Mapper, MapperSettings};
    use nalgebra::{Isometry2, Point2};

    /// Runs `rounds` rounds of a bandit in which each strategy always earns `rewards[strategy]`. Returns how often
    /// each strategy was chosen.
    fn bandit(curious: &mut Curious, features: Features, rewards: &[f64], rounds: usize) -> Vec<f64> {
        let frame = GridFrame::new(Point2::origin(), 1.0, 1, 1).unwrap();
        let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let (pose, mut rng) = (Isometry2::identity(), RandomStream::new(8, Purpose::Agent));
        let situation = Situation::new(&mapper, &pose, features);
        let mut counts = vec![0.0; rewards.len()];
        for _ in 0..rounds {
            let strategy = curious.choose(&situation, &mut rng);
            counts[strategy] += 1.0;
            curious.learn(&Trajectory { strategy, features: &[features; 3], reward: rewards[strategy] });
        }
        counts
    }

    fn curious(strategies: usize) -> Curious {
        Curious::new(2.0, strategies, &mut RandomStream::new(4, Purpose::Agent))
    }

    #[test]
    fn a_bandit_is_played_with_the_odds_of_its_rewards() {
        let (features, rewards, rounds) = (Features { p: 1.0, r: 30.0 }, [1.0, 5.0, 2.0], 40_000);
        let mut curious = curious(rewards.len());
        bandit(&mut curious, features, &rewards, 100);
        let counts = bandit(&mut curious, features, &rewards, rounds);
        let odds = rewards.map(|reward: f64| (reward / 2.0).exp());
        for (count, odds) in counts.iter().zip(odds.map(|o| o / odds.iter().sum::<f64>())) {
            let sigma = (rounds as f64 * odds * (1.0 - odds)).sqrt();
            assert!((count - rounds as f64 * odds).abs() < 4.0 * sigma, "{counts:?}");
        }
    }

    #[test]
    fn the_better_strategy_depends_on_the_features() {
        let (calm, busy) = (Features { p: 0.0, r: 500.0 }, Features { p: 20.0, r: 500.0 });
        let mut curious = curious(2);
        bandit(&mut curious, calm, &[12.0, 0.0], 500);
        bandit(&mut curious, busy, &[0.0, 12.0], 500);
        assert!(curious.probabilities(calm)[0] > 0.99, "{:?}", curious.probabilities(calm));
        assert!(curious.probabilities(busy)[1] > 0.99, "{:?}", curious.probabilities(busy));
    }

    #[test]
    fn softmax_takes_any_values() {
        assert_eq!(softmax(&[1e300, -1e300], 2.0), [1.0, 0.0]);
        assert_eq!(softmax(&[1e9, 1e9], 1e-6), [0.5, 0.5]);
        let [low, high] = softmax(&[0.0, 2.0], 2.0)[..] else { panic!("two values") };
        assert!((high / low - std::f64::consts::E).abs() < 1e-12);
    }
}
