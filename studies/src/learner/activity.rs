use crate::calendar::{HOUR_S, Hours, SLOT_S};

const SLOTS_OF_DAY: usize = 48;
const SLOTS_OF_WEEK: usize = 7 * SLOTS_OF_DAY;

/// The weight of what is usual in any place against what was learned from the hours of the day, in days.
const DAY_WEIGHT: f64 = 1.0;
/// The weight of the hours of the day against the hours of the weekday, in weeks.
const WEEK_WEIGHT: f64 = 1.0;
/// One look says at most this about the activity of the building, as a logarithm of a ratio of likelihoods: habits are
/// never known exactly.
const LIMIT: f64 = 2.0;

/// Probabilities of switches [from][to] at the beginning of a slot; 0 is quiet, 1 active.
type Switches = [[f64; 2]; 2];

/// Whether a building is active or quiet: a hidden state that can switch every half hour, with probabilities that are
/// learned for the hours of the day and of the week.
#[derive(Clone, Debug)]
pub(super) struct Activity {
    active: f64,
    /// The number of slots since Monday, 0:00.
    slot: usize,
    /// The looks in the present slot: the logarithm of the ratio of likelihoods, active to quiet.
    evidence: f64,
    /// The evidence of all slots of the present day before the present one.
    today: Vec<f64>,
    /// The probability at the beginning of the day, before its looks.
    morning: f64,
    /// Expected numbers of switches in the past, for each slot of the day and of the week.
    of_day: Vec<Switches>,
    of_week: Vec<Switches>,
}

impl Activity {
    pub(super) fn new() -> Self {
        let active = 0.2;
        Self {
            active,
            slot: 0,
            evidence: 0.0,
            today: Vec::new(),
            morning: active,
            of_day: vec![[[0.0; 2]; 2]; SLOTS_OF_DAY],
            of_week: vec![[[0.0; 2]; 2]; SLOTS_OF_WEEK],
        }
    }

    /// The probability that the building is active now.
    pub(super) fn probability(&self) -> f64 {
        self.active
    }

    /// Learns from the likelihoods of a look in a quiet and in an active building.
    pub(super) fn look(&mut self, [quiet, active]: [f64; 2]) {
        let ratio = libm::log(active.max(1e-12) / quiet.max(1e-12)).clamp(-LIMIT, LIMIT);
        self.evidence += ratio;
        self.active = updated(self.active, ratio);
    }

    /// The next slot begins. Returns the probabilities [to][from] of the state before, given the one after.
    pub(super) fn next_slot(&mut self) -> [[f64; 2]; 2] {
        self.today.push(self.evidence);
        self.evidence = 0.0;
        if self.today.len() == SLOTS_OF_DAY {
            self.learn_day();
        }
        self.slot += 1;
        let switches = self.switches(self.slot);
        let before = [1.0 - self.active, self.active];
        let after = [0, 1].map(|to| before[0] * switches[0][to] + before[1] * switches[1][to]);
        self.active = after[1];
        if self.today.is_empty() {
            self.morning = self.active;
        }
        [0, 1].map(|to| [0, 1].map(|from| before[from] * switches[from][to] / after[to]))
    }

    /// The probabilities of switches at the beginning of a slot.
    fn switches(&self, slot: usize) -> Switches {
        let [day, week] = [&self.of_day[slot % SLOTS_OF_DAY], &self.of_week[slot % SLOTS_OF_WEEK]];
        let usual = usual(slot);
        std::array::from_fn(|from| {
            let shrunk = |counts: &[f64; 2], prior: [f64; 2], weight: f64| {
                let sum = counts[0] + counts[1] + weight;
                [0, 1].map(|to| (counts[to] + weight * prior[to]) / sum)
            };
            shrunk(&week[from], shrunk(&day[from], usual[from], DAY_WEIGHT), WEEK_WEIGHT)
        })
    }

    /// Learns the switches of the day that ends from all of its looks (the forward–backward algorithm; Baum et al., 1970).
    fn learn_day(&mut self) {
        let first = self.slot + 1 - SLOTS_OF_DAY;
        let mut forward = vec![updated(self.morning, self.today[0])];
        for at in 1..SLOTS_OF_DAY {
            let (switches, before) = (self.switches(first + at), forward[at - 1]);
            let after = (1.0 - before) * switches[0][1] + before * switches[1][1];
            forward.push(updated(after, self.today[at]));
        }
        let mut later = forward[SLOTS_OF_DAY - 1];
        for at in (1..SLOTS_OF_DAY).rev() {
            let (switches, before) = (self.switches(first + at), [1.0 - forward[at - 1], forward[at - 1]]);
            let after = [1.0 - later, later];
            let mut counts = [[0.0; 2]; 2];
            for to in 0..2 {
                let sum = before[0] * switches[0][to] + before[1] * switches[1][to];
                for from in 0..2 {
                    counts[from][to] = after[to] * before[from] * switches[from][to] / sum.max(1e-12);
                }
            }
            let slot = first + at;
            for (all, new) in [
                (&mut self.of_day[slot % SLOTS_OF_DAY], &counts),
                (&mut self.of_week[slot % SLOTS_OF_WEEK], &counts),
            ] {
                all.iter_mut().flatten().zip(new.iter().flatten()).for_each(|(all, new)| *all += new);
            }
            later = counts[1][0] + counts[1][1];
        }
        self.today.clear();
    }

    /// Whether the building will rather be active, for each half hour of the coming week.
    pub(super) fn forecast(&self) -> Hours {
        let mut hours = Hours::daily(&[], 0.0, 0.0);
        let mut active = self.active;
        for slot in self.slot..self.slot + SLOTS_OF_WEEK {
            if slot > self.slot {
                let switches = self.switches(slot);
                active = (1.0 - active) * switches[0][1] + active * switches[1][1];
            }
            let (day, hour) = (slot / SLOTS_OF_DAY % 7, 0.5 * (slot % SLOTS_OF_DAY) as f64);
            hours.set(day, hour, hour + SLOT_S / HOUR_S, active > 0.5);
        }
        hours
    }
}

/// A probability after evidence (the logarithm of a ratio of likelihoods).
fn updated(probability: f64, evidence: f64) -> f64 {
    let odds = probability.max(1e-9) / (1.0 - probability).max(1e-9) * libm::exp(evidence);
    (odds / (1.0 + odds)).clamp(1e-9, 1.0 - 1e-9)
}

/// What is usual in any place: it becomes active in the morning and quiet in the evening.
fn usual(slot: usize) -> Switches {
    let hour = 0.5 * (slot % SLOTS_OF_DAY) as f64;
    let begins = if (6.0..10.0).contains(&hour) { 0.12 } else { 0.01 };
    let ends = if hour >= 17.0 { 0.1 } else { 0.01 };
    [[1.0 - begins, begins], [ends, 1.0 - ends]]
}
