use super::parts::{FASTEST_S, PARTS, PRIOR, Parts, fading};
use super::simplex;

/// Octaves of lags, from a minute to 45 days; for each octave this many earlier looks; bins of lags, two per octave.
const OCTAVES: usize = 17;
const ANCHORS: usize = 4;
const BINS: usize = 2 * OCTAVES - 1;

/// The number of independent pairs of looks that the prior of the shares counts.
const PRIOR_PAIRS: f64 = 8.0;

/// Sums are halved at this value, so that single precision stays exact and the present counts.
const MAX_SQUARES: f32 = 1024.0;

/// Earlier looks in reach of one octave of lags, the latest first.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
struct Anchors {
    times_s: [f64; ANCHORS],
    residuals: [f32; ANCHORS],
}

/// The pairs of looks with about one lag.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Bin {
    /// The sum of the products of both residuals, and of the mean of their squares.
    products: f32,
    squares: f32,
    pairs: f32,
}

/// The correlations of residuals by lag, in bounded memory and time. Pairs with the lag L that follow each other within L/4
/// say nearly the same, so that each octave of lags needs only four earlier looks, which each new look that is far enough
/// from them is compared with. The online form of correlations over all pairs.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Correlations {
    bins: Vec<Bin>,
    octaves: [Anchors; OCTAVES],
    first_s: f64,
    last_s: f64,
    pairs: f64,
}

impl Default for Correlations {
    fn default() -> Self {
        let none = Anchors { times_s: [f64::NEG_INFINITY; ANCHORS], residuals: [0.0; ANCHORS] };
        Self {
            bins: vec![Bin::default(); BINS],
            octaves: [none; OCTAVES],
            first_s: f64::NAN,
            last_s: f64::NAN,
            pairs: 0.0,
        }
    }
}

impl Correlations {
    #[cfg(test)]
    pub(super) fn heap_bytes(&self) -> usize {
        size_of_val(&*self.bins)
    }

    /// The number of pairs of looks so far.
    pub(super) fn pairs(&self) -> f64 {
        self.pairs
    }

    /// Adds a look that differs from the schedule by `residual`.
    pub(super) fn add(&mut self, time_s: f64, residual: f64) {
        let residual = residual as f32;
        self.first_s = self.first_s.min(time_s);
        self.last_s = time_s;
        for octave in 0..OCTAVES {
            let anchors = &mut self.octaves[octave];
            let spacing_s = FASTEST_S * libm::exp2(octave as f64) / ANCHORS as f64;
            if time_s - anchors.times_s[0] < spacing_s {
                return;
            }
            for (anchor_s, earlier) in anchors.times_s.iter().zip(anchors.residuals) {
                let bin = libm::round(2.0 * libm::log2((time_s - anchor_s) / FASTEST_S));
                let last = 2 * octave;
                // Two bins belong to an octave; other lags are left to other octaves.
                if bin >= 0.0 && (bin == last as f64 || bin + 1.0 == last as f64) {
                    self.bins[bin as usize].add(residual, earlier);
                    self.pairs += 1.0;
                }
            }
            anchors.times_s.rotate_right(1);
            anchors.residuals.rotate_right(1);
            (anchors.times_s[0], anchors.residuals[0]) = (time_s, residual);
        }
    }

    /// Lag (s), correlation, and number of independent pairs.
    fn iter(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        let span_s = self.last_s - self.first_s;
        let known = self.bins.iter().enumerate().filter(|(_, bin)| bin.squares > 0.0);
        known.map(move |(index, bin)| {
            let lag_s = FASTEST_S * libm::exp2(0.5 * index as f64);
            (lag_s, f64::from(bin.products / bin.squares), f64::from(bin.pairs).min(span_s / lag_s))
        })
    }

    /// The number of independent pairs of looks that are about this time apart, s, or the least longer time of which there are any.
    pub(super) fn pairs_at(&self, lag_s: f64) -> f64 {
        let quarter_octave = libm::exp2(0.25);
        let mut longer = self.iter().filter(|(of_bin_s, ..)| of_bin_s * quarter_octave >= lag_s);
        longer.next().map_or(0.0, |(_, _, pairs)| pairs)
    }

    /// The shares of the parts that explain the correlations, by least squares; `shares` are the start of the search.
    pub(super) fn fit(&self, shares: &mut Parts) {
        let mut gram: [Parts; PARTS] = Default::default();
        let mut right = PRIOR.map(|share| PRIOR_PAIRS * share);
        for (row, gram) in gram.iter_mut().enumerate() {
            gram[row] = PRIOR_PAIRS;
        }
        for (lag_s, correlation, pairs) in self.iter() {
            let basis = fading(lag_s);
            for row in 0..PARTS {
                right[row] += pairs * correlation * basis[row];
                for column in 0..PARTS {
                    gram[row][column] += pairs * basis[row] * basis[column];
                }
            }
        }
        simplex::minimize(&gram, &right, shares);
    }

    /// The rate of the one exponential that explains the correlations best, 1/s: four rates per octave are tried.
    pub(super) fn chain_rate(&self) -> f64 {
        let rates = (0..4 * OCTAVES).map(|step| libm::exp2(-0.25 * step as f64) / FASTEST_S);
        let error = |rate: f64| -> f64 {
            let errors = self.iter().map(|(lag_s, found, pairs)| {
                let apart = found - libm::exp(-rate * lag_s);
                pairs * apart * apart
            });
            errors.sum()
        };
        rates.map(|rate| (error(rate), rate)).min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, rate)| rate)
    }
}

impl Bin {
    fn add(&mut self, a: f32, b: f32) {
        self.products += a * b;
        self.squares += 0.5 * (a * a + b * b);
        self.pairs += 1.0;
        if self.squares > MAX_SQUARES {
            self.products *= 0.5;
            self.squares *= 0.5;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// The sum of two processes with the time constants of two parts, a look per minute.
    fn residuals(steps: usize, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut values = [0.0; 2];
        let keep = [2, 4].map(|part| fading(60.0)[part]);
        (0..steps)
            .map(|_| {
                for (value, keep) in values.iter_mut().zip(keep) {
                    let normal: f64 = StandardNormal.sample(&mut rng);
                    *value = keep * *value + libm::sqrt(1.0 - keep * keep) * normal;
                }
                libm::sqrt(0.7) * values[0] + libm::sqrt(0.3) * values[1]
            })
            .collect()
    }

    #[test]
    fn correlations_are_those_over_all_pairs() {
        let residuals = residuals(40_000, 1);
        let mut correlations = Correlations::default();
        for (step, residual) in residuals.iter().enumerate() {
            correlations.add(60.0 * step as f64, *residual);
        }
        for (lag_s, found, pairs) in correlations.iter().filter(|(_, _, pairs)| *pairs > 100.0) {
            let lag = libm::round(lag_s / 60.0) as usize;
            let products = residuals.iter().zip(&residuals[lag..]).map(|(a, b)| a * b).sum::<f64>();
            let all = products / residuals.iter().map(|a| a * a).sum::<f64>();
            // The lags of a bin differ by up to a quarter octave.
            let spread = 4.0 / pairs.sqrt() + 0.08;
            assert!((found - all).abs() < spread, "lag {lag}: {found}, over all pairs {all}");
        }
    }

    #[test]
    fn shares_of_known_processes_are_found() {
        let mut correlations = Correlations::default();
        for (step, residual) in residuals(200_000, 2).into_iter().enumerate() {
            correlations.add(60.0 * step as f64, residual);
        }
        let mut shares = PRIOR;
        correlations.fit(&mut shares);
        // Neighboring time constants cannot be told apart well.
        let [fast, slow] = [1..4, 3..6].map(|parts| parts.map(|part| shares[part]).sum::<f64>());
        assert!(fast > 0.6 && slow > 0.2 && shares[6..].iter().sum::<f64>() < 0.1, "{shares:?}");
    }
}
