//! A model of one thing over time: its schedule over day and week in local civil time, its memory of all past looks, how long
//! its long stays last, and a guard that falls back to a Markov chain or to the last look where these were better.
//!
//! It starts as the chain, and becomes a clock with data. Work per look and memory are bounded.

mod calendar;
mod correlations;
mod guard;
mod long_stays;
mod memory;
mod parts;
mod schedule;
mod simplex;
#[cfg(test)]
mod tests;
mod week;

use calendar::Civil;
pub use calendar::{Calendar, DAY_S, UnknownZone};
use guard::{Forecast, Guard, MODELS};
use long_stays::LongStays;
use memory::Memory;
use parts::fading;
use schedule::Schedule;
pub use week::{UsualChange, UsualSlot, Week};

/// A look at a thing that has two states.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Look {
    /// The time, s, as in the [`Calendar`].
    pub time_s: f64,
    /// Whether the thing was in the second of its states: a place blocked, a door open, a room occupied.
    pub is_blocked: bool,
}

/// No prediction is nearer to 0 or 1.
const MIN_PROBABILITY: f64 = 0.001;

/// The least number of pairs of looks from which it is known how a state goes on.
const MIN_PAIRS: f64 = 0.5;

/// A look that shows the state of the last one within this time says nothing new, s: lasers look ten times per second.
const MIN_SPACING_S: f64 = 5.0;

/// The shortest and the longest time for which a look is worth more than the schedule, s, and the ratio of two of the times
/// that are tried.
const MIN_EXPIRY_S: f64 = 10.0;
const MAX_EXPIRY_S: f64 = 28.0 * DAY_S;
const EXPIRY_STEP: f64 = 1.1;

/// Predicts the state of one thing from looks at it.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Clock {
    models: Models,
    guard: Guard,
    /// The last look that counted.
    last: Option<Look>,
    /// The time of the last look, whether it counted or not, s.
    last_s: f64,
}

impl Clock {
    /// Updates the belief with a look, and learns from it. A look with a time before that of the last one, or not finite, is
    /// ignored.
    pub fn observe(&mut self, look: Look, calendar: &Calendar) {
        if !self.counts(look) {
            return;
        }
        let Look { time_s, is_blocked } = look;
        let civil = calendar.civil(time_s);
        self.models.schedule.advance(civil);
        self.guard.test(time_s, is_blocked, |forecast| self.models.predict(forecast, time_s, civil));
        self.models.learn(look, civil);
        self.models.update(look, civil);
        self.guard.keep(self.models.forecast(look));
        self.last = Some(look);
    }

    /// Updates the belief with a look, and learns nothing from it: to compare what was learned before with what came after.
    pub fn track(&mut self, look: Look, calendar: &Calendar) {
        if self.counts(look) {
            let civil = calendar.civil(look.time_s);
            self.models.schedule.advance(civil);
            self.models.update(look, civil);
            self.last = Some(look);
        }
    }

    /// The probability that the thing is blocked at a time, s; a time before the last look counts as that of the last look.
    /// ½ without any look.
    pub fn probability(&self, time_s: f64, calendar: &Calendar) -> f64 {
        let Some(last) = self.last else { return 0.5 };
        let time_s = time_s.max(self.last_s);
        let (weights, predicted) = self.models_at(last, time_s, calendar);
        bounded(weights.iter().zip(predicted).map(|(weight, predicted)| weight * predicted).sum())
    }

    /// The interval that contains the true probability that the thing is blocked at a time, s, with 90 %; `None` before the thing
    /// was seen on 14 days.
    pub fn interval_90(&self, time_s: f64, calendar: &Calendar) -> Option<[f64; 2]> {
        let (last, time_s) = (self.last?, time_s.max(self.last_s));
        let (civil, ahead_s, memory) = (calendar.civil(time_s), time_s - self.last_s, &self.models.memory);
        let of_schedule = self.models.schedule.variance(civil, |lag_s| memory.correlation(lag_s))?;
        // How a state goes on is known from the pairs of looks that began with it.
        let share =
            if last.is_blocked { self.models.schedule.mean() } else { 1.0 - self.models.schedule.mean() };
        let of_memory = 1.0 / (share * memory.pairs(ahead_s)).max(MIN_PAIRS);
        let left = memory.correlation(ahead_s);
        let (weights, predicted) = self.models_at(last, time_s, calendar);
        let variance =
            left * of_memory + (1.0 - left) * of_schedule + schedule::disagreement(weights, predicted);
        Some(week::interval_90(self.probability(time_s, calendar), variance))
    }

    /// What is usual for the thing in every half hour of a week; `None` before the thing was seen on 14 days, and with
    /// [`Calendar::Relative`].
    pub fn week(&self, calendar: &Calendar) -> Option<Week> {
        let has_hours = calendar.civil(self.last_s).has_hours;
        self.models.schedule.week(|lag_s| self.models.memory.correlation(lag_s)).filter(|_| has_hours)
    }

    /// For how long after the last look this look says more than the schedule, s: until its expected squared error,
    /// P(state ≠ last), exceeds that of the schedule, p (1 − p) + (p − s)², where p is the probability by all looks and s
    /// that of the schedule. `None` without any look, and if this takes longer than four weeks.
    pub fn expiry_s(&self, calendar: &Calendar) -> Option<f64> {
        let last = self.last?;
        let ahead = std::iter::successors(Some(MIN_EXPIRY_S), |ahead_s| Some(ahead_s * EXPIRY_STEP));
        ahead.take_while(|ahead_s| *ahead_s <= MAX_EXPIRY_S).find(|ahead_s| {
            let time_s = self.last_s + ahead_s;
            let p = self.probability(time_s, calendar);
            let schedule = self.models.schedule.probability(calendar.civil(time_s));
            let error_of_last = if last.is_blocked { 1.0 - p } else { p };
            error_of_last > p * (1.0 - p) + (p - schedule) * (p - schedule)
        })
    }

    /// The rate of changes at a time, s, divided by the mean rate, by what is usual then; 1 without hours.
    pub fn pace(&self, time_s: f64, calendar: &Calendar) -> f64 {
        self.models.schedule.pace(calendar.civil(time_s))
    }

    /// The number of days with a look.
    pub fn days(&self) -> u32 {
        self.models.schedule.days_seen()
    }

    /// The number of half hours, of all days, with a look.
    pub fn half_hours(&self) -> f64 {
        self.models.schedule.slots()
    }

    /// The weights and the probabilities of the models at a time.
    fn models_at(&self, last: Look, time_s: f64, calendar: &Calendar) -> ([f64; MODELS], [f64; MODELS]) {
        let from = Forecast { time_s: self.last_s, ..self.models.forecast(last) };
        let predicted = self.models.predict(&from, time_s, calendar.civil(time_s));
        (self.guard.weights(time_s - self.last_s), predicted)
    }

    /// Whether a look is news. The time of one that is not counts nevertheless.
    fn counts(&mut self, look: Look) -> bool {
        if !look.time_s.is_finite() || self.last.is_some() && look.time_s < self.last_s {
            return false;
        }
        self.last_s = look.time_s;
        self.last.is_none_or(|last| {
            look.is_blocked != last.is_blocked || look.time_s - last.time_s >= MIN_SPACING_S
        })
    }
}

/// How the times of a map relate to local civil time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dates<'a> {
    pub(crate) calendar: &'a Calendar,
    /// The time of the calendar at which the map has the time 0, s.
    pub(crate) epoch_s: f64,
}

impl Dates<'_> {
    /// A look at the time of the map is one of the clock.
    pub(crate) fn observe(self, clock: &mut Clock, look: Look) {
        clock.observe(Look { time_s: self.epoch_s + look.time_s, ..look }, self.calendar);
    }
}

/// What the guard mixes: the clock itself (schedule, memory and long stays), a Markov chain, and the last look.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Models {
    schedule: Schedule,
    memory: Memory,
    stays: LongStays,
}

impl Models {
    fn learn(&mut self, look: Look, civil: Civil) {
        self.schedule.add(civil, look.is_blocked);
        self.memory.learn(look.time_s, self.residual(look, civil));
    }

    fn update(&mut self, look: Look, civil: Civil) {
        self.memory.filter(look.time_s, self.residual(look, civil));
        self.stays.add(look);
    }

    /// The difference between a look and the schedule.
    fn residual(&self, look: Look, civil: Civil) -> f64 {
        f64::from(u8::from(look.is_blocked)) - self.schedule.probability(civil)
    }

    fn forecast(&self, Look { time_s, is_blocked }: Look) -> Forecast {
        let values = self.memory.values().map(|value| value as f32);
        Forecast { time_s, since_s: self.stays.since_s(), is_blocked, values }
    }

    /// The probabilities that the thing is blocked at a time: by the clock, the chain, and the last look.
    fn predict(&self, from: &Forecast, time_s: f64, civil: Civil) -> [f64; MODELS] {
        let ahead_s = time_s - from.time_s;
        let memory =
            from.values.iter().zip(fading(ahead_s)).map(|(value, fading)| f64::from(*value) * fading);
        let mut clock = self.schedule.probability(civil) + memory.sum::<f64>();
        let ages_s = [from.time_s, time_s].map(|time_s| time_s - from.since_s);
        if let Some(survival) = self.stays.survival(ages_s) {
            clock = if from.is_blocked { clock.max(survival) } else { clock.min(1.0 - survival) };
        }
        let (mean, last) = (self.schedule.mean(), f64::from(u8::from(from.is_blocked)));
        let chain = mean + (last - mean) * self.memory.chain_memory(ahead_s);
        [clock, chain, last].map(bounded)
    }
}

fn bounded(probability: f64) -> f64 {
    probability.clamp(MIN_PROBABILITY, 1.0 - MIN_PROBABILITY)
}
