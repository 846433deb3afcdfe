use super::Look;
use super::calendar::DAY_S;

/// Bins of the age of a stay: the first begins after half a day, each ends at 1.5 times its begin, the last after two years.
const BINS: usize = 18;
const FIRST_AGE_S: f64 = 0.5 * DAY_S;
const RATIO: f64 = 1.5;
/// The prior of one stay: a stay of any age lasts at least r times as long with the probability r^−½.
const PRIOR_STAYS: f64 = 1.0;
const PRIOR_EXPONENT: f64 = 0.5;

/// How long stays last that have lasted for half a day: of a door that is no longer used, of a sensor that is stuck. The memory
/// of a thing that is used every hour forgets them within days.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct LongStays {
    /// The first and the last look of the present stay.
    first: Option<Look>,
    last_s: f64,
    /// The number of stays that ended in a bin.
    ended: [f32; BINS],
    /// The number of bins' lengths that stays have spent in a bin.
    spent: [f32; BINS],
}

/// The number of bins that an age has reached.
fn bins(age_s: f64) -> f64 {
    (libm::log(age_s / FIRST_AGE_S) / libm::log(RATIO)).clamp(0.0, BINS as f64)
}

/// The parts of the bins between two ages.
fn parts(ages_s: [f64; 2]) -> [f64; BINS] {
    let [from, to] = ages_s.map(bins);
    std::array::from_fn(|bin| (to.min(bin as f64 + 1.0) - from.max(bin as f64)).max(0.0))
}

impl LongStays {
    /// Adds a look.
    pub(super) fn add(&mut self, look: Look) {
        let first = *self.first.get_or_insert(look);
        let age_s = look.time_s - first.time_s;
        if age_s > FIRST_AGE_S {
            for (spent, part) in self.spent.iter_mut().zip(parts([self.last_s - first.time_s, age_s])) {
                *spent += part as f32;
            }
        }
        if look.is_blocked != first.is_blocked {
            if age_s > FIRST_AGE_S {
                self.ended[(bins(age_s) as usize).min(BINS - 1)] += 1.0;
            }
            self.first = Some(look);
        }
        self.last_s = look.time_s;
    }

    /// The time of the first look of the present stay, s.
    pub(super) fn since_s(&self) -> f64 {
        self.first.map_or(0.0, |look| look.time_s)
    }

    /// The probability that a stay lasts from one age at least to another, s; `None` in the first half day.
    pub(super) fn survival(&self, ages_s: [f64; 2]) -> Option<f64> {
        if ages_s[0] < FIRST_AGE_S {
            return None;
        }
        let hazard = |bin: usize| {
            let prior = PRIOR_STAYS * PRIOR_EXPONENT * libm::log(RATIO);
            (f64::from(self.ended[bin]) + prior) / (f64::from(self.spent[bin]) + PRIOR_STAYS)
        };
        let hazards = parts(ages_s).into_iter().enumerate().map(|(bin, part)| part * hazard(bin));
        Some(libm::exp(-hazards.sum::<f64>()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stays of these lengths, seen every hour.
    fn stays(lengths_h: &[u32]) -> LongStays {
        let mut stays = LongStays::default();
        let (mut hour, mut is_blocked) = (0, false);
        for length_h in lengths_h {
            for _ in 0..*length_h {
                stays.add(Look { time_s: 3600.0 * f64::from(hour), is_blocked });
                hour += 1;
            }
            is_blocked = !is_blocked;
        }
        stays
    }

    #[test]
    fn short_stays_say_nothing_about_long_ones() {
        let stays = stays(&[1, 2, 3, 4, 5, 6, 7, 8, 9]);
        assert_eq!(stays.survival([0.4 * DAY_S, DAY_S]), None);
        let survival = stays.survival([DAY_S, 4.0 * DAY_S]).unwrap();
        assert!((survival - 0.5).abs() < 1e-12, "the prior: {survival}");
    }

    #[test]
    fn stays_that_end_after_two_days_are_expected_to() {
        let stays = stays(&[48; 40]);
        assert!(stays.survival([0.5 * DAY_S, 1.2 * DAY_S]).unwrap() > 0.9);
        assert!(stays.survival([1.2 * DAY_S, 3.0 * DAY_S]).unwrap() < 0.2);
    }
}
