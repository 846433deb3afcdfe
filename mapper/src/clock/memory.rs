use super::simplex;

/// The number of parts.
const PARTS: usize = 9;
/// The time constant of the first part, s; each further part is slower by `RATIO`: one minute to 45 days.
const FIRST_S: f64 = 60.0;
const RATIO: f64 = 4.0;
/// The variance of the error of a look, as a share of the variance of the thing.
const NOISE: f64 = 1e-4;

/// The shares of the parts before anything is known, and the number of independent pairs of looks that this counts.
const PRIOR: [f64; PARTS] = [0.10, 0.10, 0.12, 0.15, 0.12, 0.08, 0.08, 0.10, 0.15];
const PRIOR_PAIRS: f64 = 8.0;

/// Correlations are kept for lags from one minute on, two bins per octave.
const BINS: usize = 33;
/// For each octave of lags, this many earlier looks.
const LEVELS: usize = 17;
const ANCHORS: usize = 4;

/// The time constant of a part, s.
fn constant_s(part: usize) -> f64 {
    FIRST_S * RATIO.powi(part as i32)
}

/// How the state of a thing depends on its past states, beyond its schedule. The difference between state and
/// schedule is the sum of parts that fade exponentially (Ornstein–Uhlenbeck processes) with time constants from a minute
/// to a month. Their shares come from the correlations of looks; a Kalman filter over all looks gives each part's present
/// value.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Memory {
    shares: [f64; PARTS],
    state: Parts,
    covariance: [[f64; PARTS]; PARTS],
    time_s: f64,
    correlations: Correlations,
    /// The number of pairs at which the shares are fitted again.
    due: f64,
    /// The rate at which the memory of a chain fades, 1/s.
    pub(super) chain_rate: f64,
}

/// The present values of the parts.
pub(super) type Parts = [f64; PARTS];

impl Default for Memory {
    fn default() -> Self {
        Self {
            shares: PRIOR,
            state: [0.0; PARTS],
            covariance: diagonal(PRIOR),
            time_s: f64::NEG_INFINITY,
            correlations: Correlations::default(),
            due: 4.0,
            chain_rate: 1.0 / 3600.0,
        }
    }
}

fn diagonal(values: Parts) -> [[f64; PARTS]; PARTS] {
    std::array::from_fn(|row| std::array::from_fn(|column| if row == column { values[row] } else { 0.0 }))
}

/// The factors by which the parts fade in a time.
fn fading(elapsed_s: f64) -> Parts {
    std::array::from_fn(|part| libm::exp(-elapsed_s / constant_s(part)))
}

/// The sum of the parts, `elapsed_s` later.
pub(super) fn predicted(parts: &Parts, elapsed_s: f64) -> f64 {
    parts.iter().zip(fading(elapsed_s)).map(|(part, fading)| part * fading).sum()
}

impl Memory {
    /// The present values of the parts.
    pub(super) fn parts(&self) -> &Parts {
        &self.state
    }

    /// The filter's step to a look with this difference between state and schedule.
    pub(super) fn filter(&mut self, time_s: f64, residual: f64) {
        let fading = fading(time_s - self.time_s);
        self.time_s = time_s;
        let mut gain = [0.0; PARTS];
        for row in 0..PARTS {
            self.state[row] *= fading[row];
            for column in 0..PARTS {
                self.covariance[row][column] *= fading[row] * fading[column];
            }
            self.covariance[row][row] += self.shares[row] * (1.0 - fading[row] * fading[row]);
            gain[row] = self.covariance[row].iter().sum();
        }
        let total = gain.iter().sum::<f64>() + NOISE;
        let innovation = (residual - self.state.iter().sum::<f64>()) / total;
        for row in 0..PARTS {
            self.state[row] += gain[row] * innovation;
            for column in 0..PARTS {
                self.covariance[row][column] -= gain[row] * gain[column] / total;
            }
        }
    }

    /// Learns from a look how the memory fades.
    pub(super) fn learn(&mut self, time_s: f64, residual: f64) {
        self.correlations.add(time_s, residual);
        if self.correlations.pairs >= self.due {
            self.due = 1.15 * self.correlations.pairs;
            self.correlations.fit(&mut self.shares);
            self.chain_rate = self.correlations.chain_rate();
        }
    }
}

/// An earlier look, in reach of later ones.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
struct Anchor {
    time_s: f64,
    residual: f32,
}

/// The correlation of looks in one bin of lags.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Bin {
    product: f32,
    square: f32,
    pairs: f32,
}

/// The correlations of looks by lag, in bounded memory: pairs whose lag is L need to be taken only every L/4, since those in
/// between say nearly the same. So that for each octave of lags four earlier looks are enough.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
struct Correlations {
    bins: Vec<Bin>,
    anchors: Vec<[Anchor; ANCHORS]>,
    first_s: f64,
    last_s: f64,
    pairs: f64,
}

impl Default for Correlations {
    fn default() -> Self {
        let none = Anchor { time_s: f64::NEG_INFINITY, residual: 0.0 };
        Self {
            bins: vec![Bin::default(); BINS],
            anchors: vec![[none; ANCHORS]; LEVELS],
            first_s: f64::INFINITY,
            last_s: f64::NEG_INFINITY,
            pairs: 0.0,
        }
    }
}

/// The lag of a bin, s.
fn lag_s(bin: usize) -> f64 {
    FIRST_S * libm::exp2(bin as f64 / 2.0)
}

impl Correlations {
    fn add(&mut self, time_s: f64, residual: f64) {
        self.first_s = self.first_s.min(time_s);
        self.last_s = time_s;
        let look = Anchor { time_s, residual: residual as f32 };
        for level in 0..LEVELS {
            let spacing_s = FIRST_S * libm::exp2(level as f64) / ANCHORS as f64;
            let anchors = &mut self.anchors[level];
            if time_s - anchors[0].time_s < spacing_s {
                break;
            }
            for anchor in anchors.iter() {
                let lag = libm::log2((time_s - anchor.time_s) / FIRST_S) * 2.0;
                let bin = libm::round(lag);
                // One octave of lags is that of this level.
                if bin >= 0.0 && (bin - 2.0 * level as f64 + 1.0).abs() < 1.5 && bin < BINS as f64 {
                    let bin = &mut self.bins[bin as usize];
                    bin.product += look.residual * anchor.residual;
                    bin.square += 0.5 * (look.residual * look.residual + anchor.residual * anchor.residual);
                    bin.pairs += 1.0;
                    self.pairs += 1.0;
                }
            }
            anchors.rotate_right(1);
            anchors[0] = look;
        }
    }

    /// The correlations by lag: lag (s), correlation, number of independent pairs.
    fn iter(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        let span_s = self.last_s - self.first_s;
        let known = self.bins.iter().enumerate().filter(|(_, bin)| bin.pairs > 0.0 && bin.square > 0.0);
        known.map(move |(index, bin)| {
            let lag_s = lag_s(index);
            (lag_s, f64::from(bin.product / bin.square), f64::from(bin.pairs).min(span_s / lag_s))
        })
    }

    /// The shares of the parts that explain the correlations, by least squares.
    fn fit(&self, shares: &mut Parts) {
        let mut gram = diagonal([PRIOR_PAIRS; PARTS]);
        let mut right = PRIOR.map(|share| PRIOR_PAIRS * share);
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

    /// The rate at which one exponential fits best, 1/s.
    fn chain_rate(&self) -> f64 {
        let error = |rate: f64| -> f64 {
            self.iter().map(|(lag_s, found, pairs)| pairs * (found - libm::exp(-rate * lag_s)).powi(2)).sum()
        };
        let rates = (0..=64).map(|step| 1.0 / (FIRST_S * libm::exp2(f64::from(step) / 4.0)));
        rates.min_by(|a, b| error(*a).total_cmp(&error(*b))).unwrap_or(1.0 / 3600.0)
    }
}
