use super::Look;
use super::calendar::DAY_S;

/// Bins of the age of a stay: the first begins after a day, each ends at 1.5 times its begin; the last at 58 days.
const BINS: usize = 10;
const RATIO: f64 = 1.5;
/// The prior: a stay of age a ends before r·a with the probability 1 − r^−0.5, whatever its age, as is known of one stay.
const PRIOR_HAZARD: f64 = 0.5;
const PRIOR_STAYS: f64 = 1.0;

/// How long stays last that have lasted for a day: a door that is never used, a sensor that hangs. The memory of a
/// thing that is used every hour would forget them.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct LongStays {
    /// The first look of the present stay.
    begin: Option<Look>,
    last_s: f64,
    /// Stays that ended in a bin, and the parts of a bin that were spent in it.
    ended: [f32; BINS],
    spent: [f32; BINS],
}

/// The age in bins: 0 at a day, 1 at the end of the first.
fn bins(age_s: f64) -> f64 {
    (libm::log(age_s / DAY_S) / libm::log(RATIO)).clamp(0.0, BINS as f64)
}

impl LongStays {
    /// Adds a look.
    pub(super) fn add(&mut self, look: Look) {
        let Some(begin) = self.begin else {
            (self.begin, self.last_s) = (Some(look), look.time_s);
            return;
        };
        let ages = [self.last_s, look.time_s].map(|time_s| bins(time_s - begin.time_s));
        for bin in ages[0] as usize..=(ages[1] as usize).min(BINS - 1) {
            let from = bin as f64;
            self.spent[bin] += (ages[1].min(from + 1.0) - ages[0].max(from)).max(0.0) as f32;
        }
        if look.is_blocked != begin.is_blocked {
            if look.time_s - begin.time_s > DAY_S {
                self.ended[(ages[1] as usize).min(BINS - 1)] += 1.0;
            }
            self.begin = Some(look);
        }
        self.last_s = look.time_s;
    }

    /// The first look of the present stay.
    pub(super) fn begin_s(&self) -> f64 {
        self.begin.map_or(0.0, |look| look.time_s)
    }

    /// The probability that a stay lasts at least from one age to another, s; `None` in its first day.
    pub(super) fn unchanged(&self, ages_s: [f64; 2]) -> Option<f64> {
        if ages_s[0] < DAY_S {
            return None;
        }
        let ages = ages_s.map(bins);
        let hazard: f64 = (0..BINS)
            .map(|bin| {
                let from = bin as f64;
                let part = (ages[1].min(from + 1.0) - ages[0].max(from)).max(0.0);
                let prior = PRIOR_STAYS * PRIOR_HAZARD * libm::log(RATIO);
                part * (f64::from(self.ended[bin]) + prior) / (f64::from(self.spent[bin]) + PRIOR_STAYS)
            })
            .sum();
        Some(libm::exp(-hazard))
    }
}
