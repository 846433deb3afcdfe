use crate::route::Route;
use crate::settings::SurveySettings;

/// The noise of the mapper, in standard deviations of the residuals of a trajectory. The residuals are taken on surfaces
/// that several passes have seen; at edges, plants and glass they have long tails, each of which would count as a change.
const PER_RESIDUAL: f64 = 5.0;
/// The least and the largest noise, m.
const LEAST_M: f64 = 0.02;
const LARGEST_M: f64 = 0.1;

impl SurveySettings {
    /// Sets the noise that the mapper must expect by what the routes say about the errors of ranges and poses together:
    /// 5 times the largest residual, from 0.02 to 0.1 m. The noise stays as it is if no place was seen twice.
    pub fn learn_noise(&mut self, routes: &[Route]) {
        self.learn_noise_from(routes.iter().filter_map(|route| route.residual_std_m));
    }

    pub(crate) fn learn_noise_from(&mut self, residuals_m: impl Iterator<Item = f64>) {
        if let Some(largest_m) = residuals_m.reduce(f64::max) {
            self.mapper.steady.range_noise_std_m = (PER_RESIDUAL * largest_m).clamp(LEAST_M, LARGEST_M);
        }
    }
}
