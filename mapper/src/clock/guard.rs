use super::calendar::DAY_S;
use super::memory::Parts;

/// The models: the clock, a chain, and the last look.
pub(super) const MODELS: usize = 3;
/// The horizons at which the models are compared, s. Another horizon has the weights of the nearest.
const HORIZONS_S: [f64; 7] = [60.0, 240.0, 900.0, 3600.0, 4.0 * 3600.0, DAY_S, 7.0 * DAY_S];
/// A forecast is tested by a look at its horizon times these.
const WINDOW: [f64; 2] = [0.75, 1.25];
/// The weights of the models without a test, and how fast they change with the loss.
const PRIOR: [f64; MODELS] = [0.6, 0.2, 0.2];
const SHARPNESS: f64 = 2.0;
/// Errors this old count 1/e.
const FADING_S: f64 = 21.0 * DAY_S;

/// A forecast that waits for its test.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Forecast {
    pub(super) time_s: f64,
    /// The begin of the stay.
    pub(super) since_s: f64,
    pub(super) is_blocked: bool,
    pub(super) parts: Parts,
}

/// The errors of the models at one horizon.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Horizon {
    loss: [f32; MODELS],
    tested_s: f64,
    waiting: Option<Forecast>,
}

/// Mixes models by their past errors: where the clock is worse than a chain or than the last look, these get its weight.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Guard {
    horizons: [Horizon; HORIZONS_S.len()],
}

impl Guard {
    /// Tests the forecasts whose horizon is reached. `predict` gives the probabilities of a forecast by each model.
    pub(super) fn test(
        &mut self,
        time_s: f64,
        is_blocked: bool,
        predict: impl Fn(&Forecast) -> [f64; MODELS],
    ) {
        let found = f64::from(u8::from(is_blocked));
        for (horizon, horizon_s) in self.horizons.iter_mut().zip(HORIZONS_S) {
            let Some(forecast) = &horizon.waiting else { continue };
            let age = (time_s - forecast.time_s) / horizon_s;
            if age < WINDOW[0] {
                continue;
            }
            if age <= WINDOW[1] {
                let fading = libm::exp(-(time_s - horizon.tested_s) / FADING_S) as f32;
                let errors = predict(forecast).map(|predicted| (predicted - found) * (predicted - found));
                for (loss, error) in horizon.loss.iter_mut().zip(errors) {
                    *loss = *loss * fading + error as f32;
                }
                horizon.tested_s = time_s;
            }
            horizon.waiting = None;
        }
    }

    /// Keeps a forecast for every horizon that waits for none.
    pub(super) fn keep(&mut self, forecast: Forecast) {
        for horizon in &mut self.horizons {
            horizon.waiting.get_or_insert(forecast);
        }
    }

    /// The weights of the models for a time ahead.
    pub(super) fn weights(&self, ahead_s: f64) -> [f64; MODELS] {
        let apart = |horizon_s: f64| libm::log(ahead_s.max(1.0) / horizon_s).abs();
        let nearest = (0..HORIZONS_S.len())
            .min_by(|a, b| apart(HORIZONS_S[*a]).total_cmp(&apart(HORIZONS_S[*b])))
            .unwrap_or(0);
        let loss = self.horizons[nearest].loss.map(f64::from);
        let least = loss.iter().copied().fold(f64::INFINITY, f64::min);
        let weights: [f64; MODELS] =
            std::array::from_fn(|model| PRIOR[model] * libm::exp(-SHARPNESS * (loss[model] - least)));
        let total: f64 = weights.iter().sum();
        weights.map(|weight| weight / total)
    }
}
