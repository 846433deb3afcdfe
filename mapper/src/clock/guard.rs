use super::calendar::DAY_S;
use super::parts::PARTS;
use std::ops::RangeInclusive;

/// The models that are mixed: the clock, a Markov chain, and the last look.
pub(super) const MODELS: usize = 3;
/// The weights of the models before any test.
const PRIOR: [f64; MODELS] = [0.7, 0.05, 0.25];
/// Weights are exp(−η · loss), with the largest η at which a mixture loses little against the best model in hindsight
/// (squared error is mixable up to η = 2; Vovk, 2001).
const LEARNING_RATE: f64 = 2.0;
/// An error of this age counts 1/e.
const FADING_S: f64 = 21.0 * DAY_S;
/// The times ahead at which the models are compared, s. Another time ahead has the weights of the nearest. Half a day and
/// half a week are among them, since the last look is best after whole days and weeks.
const HORIZONS_S: [f64; 9] =
    [60.0, 240.0, 900.0, 3600.0, 4.0 * 3600.0, 0.5 * DAY_S, DAY_S, 3.5 * DAY_S, 7.0 * DAY_S];
/// After a test, the next forecast waits for this part of the horizon, so that the hours of the day are tested in turn.
const PAUSE: f64 = 0.13;
/// A forecast is tested by the first look in this part of its horizon.
const WINDOW: RangeInclusive<f64> = 1.0..=1.5;

/// What is known at a look, and all that the models predict from.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Forecast {
    /// The time of the look, s.
    pub(super) time_s: f64,
    /// The time of the first look of the stay, s.
    pub(super) since_s: f64,
    pub(super) is_blocked: bool,
    /// The values of the memory.
    pub(super) values: [f32; PARTS],
}

/// The errors of the models at one horizon.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
struct Horizon {
    /// The sum of squared errors, which fade.
    losses: [f32; MODELS],
    /// The time of the last test, s.
    tested_s: f64,
    waiting: Option<Forecast>,
}

/// Mixes models by their past errors at each horizon: where a chain or the last look are better than the clock, they
/// get its weight.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Guard {
    horizons: [Horizon; HORIZONS_S.len()],
}

impl Default for Guard {
    fn default() -> Self {
        let untested = Horizon { losses: [0.0; MODELS], tested_s: f64::NEG_INFINITY, waiting: None };
        Self { horizons: [untested; HORIZONS_S.len()] }
    }
}

impl Guard {
    /// Tests the forecasts whose horizon is reached by a look. `predict` gives the probability of each model.
    pub(super) fn test(
        &mut self,
        time_s: f64,
        is_blocked: bool,
        predict: impl Fn(&Forecast) -> [f64; MODELS],
    ) {
        let found = f64::from(u8::from(is_blocked));
        for (horizon, horizon_s) in self.horizons.iter_mut().zip(HORIZONS_S) {
            let Some(forecast) = horizon.waiting else { continue };
            let age = (time_s - forecast.time_s) / horizon_s;
            if age >= *WINDOW.start() {
                horizon.waiting = None;
            }
            if WINDOW.contains(&age) {
                let fading = libm::exp(-(time_s - horizon.tested_s) / FADING_S);
                for (loss, predicted) in horizon.losses.iter_mut().zip(predict(&forecast)) {
                    let error = predicted - found;
                    *loss = (f64::from(*loss) * fading + error * error) as f32;
                }
                horizon.tested_s = time_s;
            }
        }
    }

    /// Keeps a forecast for each horizon that has none to test.
    pub(super) fn keep(&mut self, forecast: Forecast) {
        for (horizon, horizon_s) in self.horizons.iter_mut().zip(HORIZONS_S) {
            if forecast.time_s - horizon.tested_s >= PAUSE * horizon_s {
                horizon.waiting.get_or_insert(forecast);
            }
        }
    }

    /// The weights of the models for a time ahead.
    pub(super) fn weights(&self, ahead_s: f64) -> [f64; MODELS] {
        let apart = |horizon: usize| libm::log(ahead_s.max(1.0) / HORIZONS_S[horizon]).abs();
        let nearest = (0..HORIZONS_S.len()).min_by(|a, b| apart(*a).total_cmp(&apart(*b))).unwrap_or(0);
        let losses = self.horizons[nearest].losses.map(f64::from);
        let least = losses.iter().copied().fold(f64::INFINITY, f64::min);
        let weights: [f64; MODELS] =
            std::array::from_fn(|model| PRIOR[model] * libm::exp(LEARNING_RATE * (least - losses[model])));
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_that_was_right_gets_the_weight_of_its_horizon() {
        let mut guard = Guard::default();
        for minute in 0..200 {
            let time_s = 60.0 * f64::from(minute);
            let is_blocked = minute % 2 == 0;
            // Right after one minute: the state that the last look did not have.
            guard.test(time_s, is_blocked, |forecast| {
                let last = f64::from(u8::from(forecast.is_blocked));
                [0.5, 1.0 - last, last]
            });
            guard.keep(Forecast { time_s, since_s: 0.0, is_blocked, values: [0.0; PARTS] });
        }
        assert!(guard.weights(50.0)[1] > 0.99, "{:?}", guard.weights(50.0));
        assert!(guard.weights(240.0)[2] > 0.99, "after an even number of minutes the last look is right");
        assert_eq!(guard.weights(7.0 * DAY_S), PRIOR);
    }
}
