//! A prior of the rate that all traversable cells share, learned from all of them (empirical Bayes).
//!
//! The rates of the cells of a place have a gamma distribution. Given its rate, the number of cycles of a cell in view has a
//! Poisson distribution, so that the numbers of all cells have negative binomial distributions. The gamma distribution
//! that makes them most probable is the prior of every cell: it is narrow where people walk everywhere (one event says
//! little about a cell), and wide where a few doors move and the rest stands still.

use std::collections::BTreeMap;

/// A gamma distribution of a cycle rate: what is known after `events` cycles in the time `time`. Its shape is `events`, its
/// mean `events / time`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct RateDistribution {
    /// The number of cycles.
    pub events: f64,
    /// The time in view, in the time unit of the readings.
    pub time: f64,
}

impl RateDistribution {
    /// The mean rate.
    pub fn mean(self) -> f64 {
        self.events / self.time
    }

    /// The distribution after `cycles` more cycles in the time `observed`.
    #[must_use]
    pub fn after(self, cycles: u32, observed: f64) -> Self {
        Self { events: self.events + f64::from(cycles), time: self.time + observed }
    }

    /// The prior that cells share, from the number of cycles and the time in view of every cell; `None` without any time.
    pub fn shared(cells: impl IntoIterator<Item = (u32, f64)>) -> Option<Self> {
        let mut counts = CycleCounts::default();
        cells.into_iter().for_each(|(cycles, observed)| counts.add(cycles, observed));
        counts.fit()
    }
}

/// The number of cycles of all cells together, before any observation: the mean of Jeffreys' posterior of a rate.
const FIRST_CYCLES: f64 = 0.5;
/// Without observations, the shape of the prior is this, with an uncertainty of a factor of e: the mean of the shapes in
/// generated houses.
const USUAL_SHAPE: f64 = 0.3;
/// The bounds of the shape.
const SHAPES: [f64; 2] = [0.02, 50.0];
/// The number of steps of each search: each divides the remaining range by 2, or by 1.6.
const SEARCH_STEPS: usize = 40;
/// The position of the exponent and of the first two binary digits of a number, which are the key of a class.
const CLASS_BITS: u32 = 50;

/// The cycles and the times in view of cells, in classes: four classes of time per octave.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(super) struct CycleCounts {
    /// The number of cells with each number of cycles.
    by_cycles: BTreeMap<u32, u32>,
    by_time: BTreeMap<u64, TimeClass>,
}

/// The cells with a similar time in view.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct TimeClass {
    cells: f64,
    cycles: f64,
    time: f64,
}

impl CycleCounts {
    /// Adds a cell. A cell that was in view for no time says nothing.
    pub(super) fn add(&mut self, cycles: u32, observed: f64) {
        if observed <= 0.0 {
            return;
        }
        *self.by_cycles.entry(cycles).or_default() += 1;
        let class = self.by_time.entry(observed.to_bits() >> CLASS_BITS).or_default();
        class.cells += 1.0;
        class.cycles += f64::from(cycles);
        class.time += observed;
    }

    /// The prior with the largest likelihood.
    pub(super) fn fit(&self) -> Option<RateDistribution> {
        let classes: Vec<TimeClass> = self.by_time.values().copied().collect();
        let (cycles, time) = classes
            .iter()
            .fold((FIRST_CYCLES, 0.0), |(cycles, time), class| (cycles + class.cycles, time + class.time));
        let mean = cycles / time;
        if !(mean.is_finite() && mean > 0.0) {
            return None;
        }
        let height = |log_shape: f64| self.log_likelihood(&classes, mean, libm::exp(log_shape));
        let events = libm::exp(maximum(SHAPES.map(libm::log), height));
        let time = prior_time(&classes, mean, events);
        (time > 0.0 && time.is_finite()).then_some(RateDistribution { events, time })
    }

    /// The logarithm of the posterior of a shape, with the best time for it.
    fn log_likelihood(&self, classes: &[TimeClass], mean: f64, shape: f64) -> f64 {
        let (time, of_shape) = (prior_time(classes, mean, shape), libm::lgamma(shape));
        let of_cycles =
            self.by_cycles.iter().filter(|&(&cycles, _)| cycles > 0).map(|(&cycles, &cells)| {
                f64::from(cells) * (libm::lgamma(shape + f64::from(cycles)) - of_shape)
            });
        let of_times = classes.iter().map(|class| {
            let seen = class.time / class.cells;
            let stays = -shape * class.cells * libm::log1p(seen / time);
            stays - class.cycles * libm::log(time + seen)
        });
        let usual = libm::log(shape / USUAL_SHAPE);
        of_cycles.sum::<f64>() + of_times.sum::<f64>() - 0.5 * usual * usual
    }
}

/// The time of the prior with a shape that makes the observations most probable: the root of the derivative, in which the
/// terms of all classes grow with the time. `mean` is the mean rate over all cells.
fn prior_time(classes: &[TimeClass], mean: f64, shape: f64) -> f64 {
    let cells: f64 = classes.iter().map(|class| class.cells).sum();
    let excess = |time: f64| {
        let share = |class: &TimeClass| time / (time + class.time / class.cells);
        let sum: f64 = classes.iter().map(|class| (shape * class.cells + class.cycles) * share(class)).sum();
        sum - shape * cells
    };
    // The mean rate of the prior is within a factor of 20 of the mean rate of the observations.
    let [mut low, mut high] = [0.05, 20.0].map(|factor| libm::log(factor * shape / mean));
    for _ in 0..SEARCH_STEPS {
        let middle = 0.5 * (low + high);
        if excess(libm::exp(middle)) < 0.0 { low = middle } else { high = middle }
    }
    libm::exp(0.5 * (low + high))
}

/// The place of the maximum of a function with one maximum, by the golden section.
fn maximum([mut low, mut high]: [f64; 2], height: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let at = |low: f64, high: f64, share: f64| low + share * (high - low);
    let mut inner = [1.0 - GOLDEN, GOLDEN].map(|share| at(low, high, share));
    let mut heights = inner.map(&height);
    for _ in 0..SEARCH_STEPS {
        if heights[0] < heights[1] {
            low = inner[0];
            inner = [inner[1], at(low, high, GOLDEN)];
            heights = [heights[1], height(inner[1])];
        } else {
            high = inner[1];
            inner = [at(low, high, 1.0 - GOLDEN), inner[0]];
            heights = [height(inner[0]), heights[0]];
        }
    }
    0.5 * (low + high)
}
