use crate::belief::{Model, POWERS};
use crate::calendar::{DAY_S, HOUR_S, Habit, Hours, Law as _, PHASES, SLOT_S, Stays};
use crate::{SLOT_STEPS, STEP_S};

/// The number of candidate habits.
pub(super) const CANDIDATES: usize = 128;
/// The law of one thing over phases and candidates.
pub(super) type Law = [[f32; CANDIDATES]; PHASES];
/// A weight for each candidate.
pub(super) type Weights = [f64; CANDIDATES];
type Transitions = [[[f32; CANDIDATES]; PHASES]; PHASES];

/// Candidate habits, spread evenly over what is plausible for any thing in any place.
pub(super) struct Candidates {
    habits: Vec<Habit>,
    /// Transitions in 2ⁿ steps: [quiet, active], then n.
    powers: [Vec<Box<Transitions>>; 2],
    /// Transitions in a slot.
    slots: [Box<Transitions>; 2],
    /// The law before any look: [quiet, active].
    pub(super) start: [Law; 2],
}

impl Candidates {
    pub(super) fn new() -> Self {
        let habits: Vec<Habit> = (0..CANDIDATES).map(candidate).collect();
        let powers = [false, true].map(|is_active| {
            (0..POWERS).map(|power| transitions(&habits, is_active, STEP_S * (1 << power) as f64)).collect()
        });
        let slots = [false, true].map(|is_active| transitions(&habits, is_active, SLOT_S));
        let mut start = [[[0.0; CANDIDATES]; PHASES]; 2];
        for (is_active, law) in [false, true].into_iter().zip(&mut start) {
            for (index, habit) in habits.iter().enumerate() {
                // The rows of the transitions in a long time are all the law that the habit comes to.
                let [phases, ..] = habit.transitions(is_active, 365.0 * DAY_S);
                phases
                    .iter()
                    .zip(law.iter_mut())
                    .for_each(|(share, law)| law[index] = (share / CANDIDATES as f64) as f32);
            }
        }
        Self { habits, powers, slots, start }
    }

    /// The law after a number of steps within a slot.
    pub(super) fn advanced(&self, law: &Law, regime: usize, steps: usize) -> Law {
        if steps == SLOT_STEPS {
            return product(law, &self.slots[regime]);
        }
        let mut law = *law;
        for power in (0..POWERS).filter(|power| steps >> power & 1 == 1) {
            law = product(&law, &self.powers[regime][power]);
        }
        law
    }

    /// The model for planning: the mean of all candidates for each length of time, given the phase.
    pub(super) fn model(&self, law: &Law, hours: Hours) -> Model {
        let sums = law.map(|shares| shares.iter().map(|share| f64::from(*share)).sum::<f64>());
        let mean = |transitions: &Transitions| {
            std::array::from_fn(|from| {
                std::array::from_fn(|to| {
                    let pairs = law[from].iter().zip(&transitions[from][to]);
                    let sum: f64 = pairs.map(|(share, probability)| f64::from(share * probability)).sum();
                    if sums[from] > 1e-12 { sum / sums[from] } else { f64::from(u8::from(from == to)) }
                })
            })
        };
        let powers = [0, 1].map(|regime| self.powers[regime].iter().map(|power| mean(power)).collect());
        let weight = |index: usize| law.iter().map(|shares| f64::from(shares[index])).sum::<f64>();
        let rates_hz =
            self.habits.iter().enumerate().map(|(index, habit)| {
                weight(index) / Habit { hours: hours.clone(), ..habit.clone() }.cycle_s()
            });
        let cycle_s = sums.iter().sum::<f64>() / rates_hz.sum::<f64>();
        Model::new(hours, powers, cycle_s)
    }
}

/// Weights whose sum is 1.
pub(super) fn normalized(weights: Weights) -> Weights {
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

/// The radical inverse of a number: the points of Halton (1960) for the bases of all dimensions cover a cube evenly.
fn radical_inverse(mut number: usize, base: usize) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while number > 0 {
        digit /= base as f64;
        value += digit * (number % base) as f64;
        number /= base;
    }
    value
}

/// A candidate: short stays of a minute to six hours, long ones that take up to 200 times as long, at most five days.
/// In quiet hours stays take up to 100 times as long, or the thing is put to rest in one state.
fn candidate(index: usize) -> Habit {
    let mut bases = [2, 3, 5, 7, 11, 13, 17, 19, 23].into_iter();
    let mut draw = |low: f64, high: f64| {
        let unit = radical_inverse(index + 20, bases.next().unwrap_or(29));
        low + unit * (high - low)
    };
    let mut stays = || {
        let short_s = 60.0 * libm::exp(draw(0.0, libm::log(360.0)));
        let long_s = (short_s * libm::exp(draw(libm::log(2.0), libm::log(200.0)))).min(5.0 * DAY_S);
        Stays { short_s, long_s, long_share: draw(0.0, 0.8) }
    };
    let active = [stays(), stays()];
    let way = draw(0.0, 4.0);
    let (first, second) = (draw(0.0, 1.0), draw(0.0, 1.0));
    let quiet = if way < 2.0 {
        let factor = libm::pow(100.0, first);
        active.map(|stays| Stays { short_s: factor * stays.short_s, long_s: factor * stays.long_s, ..stays })
    } else {
        let mut quiet = [Stays::of_mean(60.0 * libm::pow(120.0, second)); 2];
        quiet[usize::from(way >= 3.0)] = Stays::of_mean(6.0 * HOUR_S * libm::pow(40.0, first));
        quiet
    };
    Habit { hours: Hours::always(), active, quiet }
}

fn transitions(habits: &[Habit], is_active: bool, time_s: f64) -> Box<Transitions> {
    let mut all = Box::new([[[0.0; CANDIDATES]; PHASES]; PHASES]);
    for (index, habit) in habits.iter().enumerate() {
        let matrix = habit.transitions(is_active, time_s);
        for (from, row) in matrix.iter().enumerate() {
            row.iter().enumerate().for_each(|(to, share)| all[from][to][index] = *share as f32);
        }
    }
    all
}

fn product(law: &Law, transitions: &Transitions) -> Law {
    let mut after = [[0.0; CANDIDATES]; PHASES];
    for (shares, rows) in law.iter().zip(transitions) {
        for (after, row) in after.iter_mut().zip(rows) {
            for ((after, share), probability) in after.iter_mut().zip(shares).zip(row) {
                *after += share * probability;
            }
        }
    }
    after
}
