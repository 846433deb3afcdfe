//! A model of one thing over time: its schedule over day and week, and its memory of all past looks.

mod calendar;
mod guard;
mod long_stays;
mod memory;
mod schedule;
mod simplex;

pub use calendar::{Calendar, DAY_S, UnknownZone};
use guard::{Forecast, Guard, MODELS};
use long_stays::LongStays;
use memory::Memory;
use schedule::Schedule;

/// A look at a thing.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Look {
    /// The time, s.
    pub time_s: f64,
    /// Whether the thing was blocked (a door: open, a room: occupied; one of two states).
    pub is_blocked: bool,
}

/// No prediction is more certain than this.
const MIN_PROBABILITY: f64 = 0.001;

/// The model of one thing.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Clock {
    schedule: Schedule,
    memory: Memory,
    stays: LongStays,
    guard: Guard,
    last: Option<Look>,
}

impl Clock {
    /// Learns from a look, and updates the state.
    pub fn observe(&mut self, look: Look, calendar: &Calendar) {
        let Look { time_s, is_blocked } = look;
        let civil_s = calendar.civil_s(time_s);
        let mut guard = std::mem::take(&mut self.guard);
        guard.test(time_s, is_blocked, |forecast| self.models(forecast, time_s, civil_s));
        self.guard = guard;
        self.schedule.add(civil_s, is_blocked);
        let residual = f64::from(u8::from(is_blocked)) - self.schedule.probability(civil_s);
        self.memory.learn(time_s, residual);
        self.track(look, calendar);
        self.guard.keep(self.forecast(look));
    }

    /// Updates the state with a look from which nothing is learned.
    pub fn track(&mut self, look: Look, calendar: &Calendar) {
        let residual =
            f64::from(u8::from(look.is_blocked)) - self.schedule.probability(calendar.civil_s(look.time_s));
        self.memory.filter(look.time_s, residual);
        self.stays.add(look);
        self.last = Some(look);
    }

    /// The probability that the thing is blocked at a time that is not before the last look.
    pub fn probability(&self, time_s: f64, calendar: &Calendar) -> f64 {
        let Some(last) = self.last else { return 0.5 };
        let models = self.models(&self.forecast(last), time_s, calendar.civil_s(time_s));
        let weights = self.guard.weights(time_s - last.time_s);
        weights.iter().zip(models).map(|(weight, model)| weight * model).sum::<f64>()
            .clamp(MIN_PROBABILITY, 1.0 - MIN_PROBABILITY)
    }

    fn forecast(&self, Look { time_s, is_blocked }: Look) -> Forecast {
        Forecast { time_s, since_s: self.stays.begin_s(), is_blocked, parts: *self.memory.parts() }
    }

    /// The probabilities by the models of the guard.
    fn models(&self, from: &Forecast, time_s: f64, civil_s: Option<f64>) -> [f64; MODELS] {
        let ahead_s = time_s - from.time_s;
        let last = f64::from(u8::from(from.is_blocked));
        let mut clock = self.schedule.probability(civil_s) + memory::predicted(&from.parts, ahead_s);
        if let Some(unchanged) = self.stays.unchanged([from.time_s, time_s].map(|time_s| time_s - from.since_s)) {
            clock = if from.is_blocked { clock.max(unchanged) } else { clock.min(1.0 - unchanged) };
        }
        let mean = self.schedule.mean();
        let chain = mean + (last - mean) * libm::exp(-ahead_s * self.memory.chain_rate);
        [clock, chain, last].map(|model| model.clamp(MIN_PROBABILITY, 1.0 - MIN_PROBABILITY))
    }
}
