use super::correlations::Correlations;
use super::parts::{PARTS, PRIOR, Parts, fading};

/// The variance of the error of a look, as a share of the variance of the thing.
const NOISE: f64 = 1e-4;

/// The rate at which the memory of the chain fades before any look, 1/s.
const PRIOR_RATE: f64 = 1.0 / 3600.0;

/// Shares are fitted again whenever the number of pairs of looks has grown by this factor.
const GROWTH: f64 = 1.15;
const FIRST_PAIRS: f64 = 4.0;

/// The memory of a thing beyond its schedule. The difference between state and schedule is the sum of parts that
/// fade exponentially (Ornstein–Uhlenbeck processes) with time constants from a minute to weeks. The correlations of
/// looks tell which share of the variance each part has, and a Kalman filter over all looks what its present value is. With
/// one part this would be a Markov chain.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Memory {
    correlations: Correlations,
    /// The number of pairs of looks at which shares and rate are fitted again.
    due: f64,
    /// The shares of the variance.
    shares: Parts,
    /// The rate at which the memory of a chain fades that has the same correlations, 1/s.
    chain_rate: f64,
    /// The state of the filter at `time_s`.
    values: Parts,
    covariance: [Parts; PARTS],
    time_s: f64,
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            correlations: Correlations::default(),
            due: FIRST_PAIRS,
            shares: PRIOR,
            chain_rate: PRIOR_RATE,
            values: Parts::default(),
            covariance: std::array::from_fn(|row| {
                std::array::from_fn(|column| if row == column { PRIOR[row] } else { 0.0 })
            }),
            time_s: 0.0,
        }
    }
}

impl Memory {
    #[cfg(test)]
    pub(super) fn heap_bytes(&self) -> usize {
        self.correlations.heap_bytes()
    }

    /// The values of the parts at the last look.
    pub(super) fn values(&self) -> &Parts {
        &self.values
    }

    /// The correlation of differences from the schedule that are a time apart.
    pub(super) fn correlation(&self, lag_s: f64) -> f64 {
        self.shares.iter().zip(fading(lag_s)).map(|(share, fading)| share * fading).sum()
    }

    /// The number of independent pairs of looks that are about this time apart, s.
    pub(super) fn pairs(&self, lag_s: f64) -> f64 {
        self.correlations.pairs_at(lag_s)
    }

    /// The part of a chain's memory that is left after a time.
    pub(super) fn chain_memory(&self, elapsed_s: f64) -> f64 {
        libm::exp(-self.chain_rate * elapsed_s)
    }

    /// Updates the values with a look that differs from the schedule by `residual`.
    pub(super) fn filter(&mut self, time_s: f64, residual: f64) {
        let fading = fading(time_s - self.time_s);
        self.time_s = time_s;
        let mut gain = Parts::default();
        for row in 0..PARTS {
            self.values[row] *= fading[row];
            for column in 0..PARTS {
                self.covariance[row][column] *= fading[row] * fading[column];
            }
            self.covariance[row][row] += self.shares[row] * (1.0 - fading[row] * fading[row]);
            gain[row] = self.covariance[row].iter().sum();
        }
        let precision = 1.0 / (gain.iter().sum::<f64>() + NOISE);
        let innovation = residual - self.values.iter().sum::<f64>();
        for row in 0..PARTS {
            let scaled = precision * gain[row];
            self.values[row] += scaled * innovation;
            for (covariance, gain) in self.covariance[row].iter_mut().zip(gain) {
                *covariance -= scaled * gain;
            }
        }
    }

    /// Learns from a look how fast the memory fades.
    pub(super) fn learn(&mut self, time_s: f64, residual: f64) {
        self.correlations.add(time_s, residual);
        if self.correlations.pairs() >= self.due {
            self.due = GROWTH * self.correlations.pairs();
            self.correlations.fit(&mut self.shares);
            self.chain_rate = self.correlations.chain_rate();
        }
    }
}
