use super::{Chooser, Trajectory};
use crate::sampling::gamma;
use crate::situation::{Features, Situation};
use interfaces::{RandomStream, Values, value};

/// The number of readings after which the weight of an observation of a strategy is one half.
const MEMORY: f64 = 5000.0;

/// The number of readings after which the weight of an observation of the mean progress is one half.
const MEAN_MEMORY: f64 = 500.0;

/// The pseudocount of every strategy: a number of readings with the mean progress.
const PRIOR_READINGS: f64 = 100.0;

/// The number of readings that hold as much information about a strategy as one event of a Poisson process about
/// its rate. Progress comes in bursts: the result of one trajectory is mostly random.
const READINGS_PER_EVENT: f64 = 5.0;

/// Learns which strategy makes most progress in learning, by Thompson sampling.
///
/// The reward is [`Trajectory::progress`]. All strategies make less progress when more is known, so that a strategy
/// that was used early would seem better than a strategy that is used now. The progress of each trajectory is
/// therefore divided by the *mean progress*, the recent progress per reading of all strategies; the quotient is the
/// efficiency of the strategy. Efficiencies change slowly and can be estimated. The chooser draws an efficiency for
/// each strategy from its posterior (a gamma distribution, as for the rate of a Poisson process) and chooses the
/// strategy with the largest draw.
///
/// Without the division, the chooser found the better strategies less often. With map updates as the reward, the
/// chooser preferred the strategies that follow a block longest, although they learn no more. `docs/strategies.md`
/// names other choosers that were tried.
#[derive(Clone, Debug)]
pub struct Progress {
    mean: Account,
    /// One account per strategy; the gain is in multiples of the mean progress.
    strategies: Vec<Account>,
}

/// The gain and the number of its readings, discounted.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct Account {
    gained: f64,
    readings: f64,
}

impl Account {
    fn fade(&mut self, readings: f64, half_life: f64) {
        let share = libm::exp2(-readings / half_life);
        self.gained *= share;
        self.readings *= share;
    }

    fn add(&mut self, gained: f64, readings: f64) {
        self.gained += gained;
        self.readings += readings;
    }

    fn per_reading(&self) -> f64 {
        if self.readings > 0.0 { self.gained / self.readings } else { 0.0 }
    }
}

impl Progress {
    /// A learner that has learned nothing.
    pub fn new(strategies: usize) -> Self {
        Self { mean: Account::default(), strategies: vec![Account::default(); strategies] }
    }

    /// The expected progress of each strategy, in multiples of the mean progress.
    pub fn efficiencies(&self) -> impl ExactSizeIterator<Item = f64> {
        self.strategies.iter().map(|of| (of.gained + PRIOR_READINGS) / (of.readings + PRIOR_READINGS))
    }
}

impl Chooser for Progress {
    fn choose(&mut self, _: &Situation, rng: &mut RandomStream) -> usize {
        let (mut best, mut largest) = (0, f64::NEG_INFINITY);
        for (index, of) in self.strategies.iter().enumerate() {
            let draw = gamma((of.gained + PRIOR_READINGS) / READINGS_PER_EVENT, rng) * READINGS_PER_EVENT
                / (of.readings + PRIOR_READINGS);
            if draw > largest {
                (best, largest) = (index, draw);
            }
        }
        best
    }

    fn learn(&mut self, trajectory: &Trajectory) {
        let readings = trajectory.features.len() as f64;
        let gained = trajectory.progress * readings;
        self.mean.fade(readings, MEAN_MEMORY);
        self.mean.add(gained, readings);
        let mean = self.mean.per_reading();
        // Without any progress, no strategy is better than the others.
        if mean < f64::MIN_POSITIVE {
            return;
        }
        for strategy in &mut self.strategies {
            strategy.fade(readings, MEMORY);
        }
        self.strategies[trajectory.strategy].add(gained / mean, readings);
    }

    fn value(&self, strategy: usize, _: Features) -> Option<f64> {
        Some(self.efficiencies().nth(strategy)? * self.mean.per_reading())
    }

    fn values(&mut self) -> Values<'_> {
        vec![value(&mut self.mean), value(&mut self.strategies)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{GridFrame, Purpose};
    use mapper::{Mapper, MapperSettings};
    use nalgebra::{Isometry2, Point2};
    use proptest::prelude::*;
    use rand::RngExt;

    /// Runs `rounds` rounds of ten readings; a strategy earns a random value up to twice its mean of `progress`.
    /// Returns how often each strategy was chosen.
    fn bandit(
        chooser: &mut Progress,
        progress: impl Fn(usize) -> Vec<f64>,
        rounds: usize,
        seed: u64,
    ) -> Vec<usize> {
        let frame = GridFrame::new(Point2::origin(), 1.0, 1, 1).unwrap();
        let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let (pose, mut rng) = (Isometry2::identity(), RandomStream::new(seed, Purpose::Agent));
        let situation = Situation::new(&mapper, &pose, Features::default());
        let mut counts = vec![0; chooser.strategies.len()];
        for round in 0..rounds {
            let strategy = chooser.choose(&situation, &mut rng);
            counts[strategy] += 1;
            let progress = progress(round)[strategy] * 2.0 * rng.random::<f64>();
            let features = &[Features::default(); 10];
            chooser.learn(&Trajectory { strategy, features, reward: 0.0, progress });
        }
        counts
    }

    #[test]
    fn the_better_strategy_is_used_most() {
        for seed in 0..10 {
            let counts = bandit(&mut Progress::new(3), |_| vec![0.1, 0.3, 0.1], 1000, seed);
            assert!(counts[1] > 800, "{counts:?}");
        }
    }

    #[test]
    fn it_follows_a_change_of_which_is_better() {
        for seed in 0..10 {
            let mut chooser = Progress::new(2);
            let before = bandit(&mut chooser, |_| vec![0.3, 0.1], 1000, seed);
            bandit(&mut chooser, |_| vec![0.1, 0.3], 3000, seed);
            let after = bandit(&mut chooser, |_| vec![0.1, 0.3], 1000, seed);
            assert!(before[0] > 800 && after[1] > 700, "{before:?} {after:?}");
        }
    }

    #[test]
    fn the_better_strategy_is_found_while_progress_declines() {
        for seed in 0..10 {
            let declining = |round: usize| vec![1.0 / (10.0 + round as f64), 2.0 / (10.0 + round as f64)];
            let mut chooser = Progress::new(2);
            bandit(&mut chooser, declining, 300, seed);
            let later = |round: usize| declining(round + 300);
            let counts = bandit(&mut chooser, later, 1000, seed);
            assert!(counts[1] > 750, "{counts:?}");
        }
    }

    #[test]
    fn equal_strategies_share_and_the_first_choice_is_fair() {
        let firsts =
            (0..1000).filter(|&seed| bandit(&mut Progress::new(2), |_| vec![1.0; 2], 1, seed)[0] == 1);
        assert!((436..=564).contains(&firsts.count()), "four standard deviations");
        let mut counts = [0; 2];
        for seed in 0..20 {
            let one = bandit(&mut Progress::new(2), |_| vec![0.2, 0.2], 300, seed);
            (0..2).for_each(|index| counts[index] += one[index]);
        }
        assert!(counts.iter().all(|&count| count > 1500), "{counts:?}");
    }

    #[test]
    fn without_progress_no_strategy_is_better() {
        let mut chooser = Progress::new(3);
        bandit(&mut chooser, |_| vec![0.0; 3], 500, 1);
        assert!(chooser.efficiencies().all(|efficiency| efficiency == 1.0));
        assert_eq!(chooser.value(0, Features::default()), Some(0.0));
        assert_eq!(chooser.value(3, Features::default()), None);
    }

    proptest! {
        #[test]
        fn beliefs_stay_numbers(
            lessons in prop::collection::vec((0usize..3, 1usize..400, prop_oneof![Just(0.0), 0.0..1e-300, 0.0..1e6]), 0..60),
        ) {
            let mut chooser = Progress::new(3);
            for (strategy, readings, progress) in lessons {
                let features = vec![Features::default(); readings];
                chooser.learn(&Trajectory { strategy, features: &features, reward: 0.0, progress });
                for index in 0..3 {
                    let value = chooser.value(index, Features::default()).unwrap();
                    prop_assert!(value.is_finite() && value >= 0.0);
                }
            }
            let counts = bandit(&mut chooser, |_| vec![0.1; 3], 5, 0);
            prop_assert_eq!(counts.iter().sum::<usize>(), 5);
        }
    }
}
