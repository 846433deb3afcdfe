use crate::route::Route;
use crate::settings::SurveySettings;

/// The least noise, m: with poses that were found, and of a laser that stands.
const LEAST_M: f64 = 0.02;
const LEAST_STANDING_M: f64 = 0.01;
/// The largest noise, m.
const LARGEST_M: f64 = 0.1;

impl SurveySettings {
    /// Sets the noise that the mapper must expect by what the routes say about the errors of ranges and poses together:
    /// the largest of all routes. That of a route is the distance below which 97 % of its points lie from the surfaces of other
    /// passes, from 0.02 to 0.1 m: at edges, plants and glass, real scans have long tails, each of which would count as a
    /// change. That of a laser that stands is the noise of its ranges, from 0.01 to 0.1 m. The noise stays as it is if no place
    /// was seen twice.
    pub fn learn_noise(&mut self, routes: &[Route]) {
        self.learn_noise_from(routes.iter().filter_map(noise_m));
    }

    pub(crate) fn learn_noise_from(&mut self, noises_m: impl Iterator<Item = f64>) {
        if let Some(largest_m) = noises_m.reduce(f64::max) {
            self.set_noise(largest_m);
        }
    }
}

/// The noise that the mapper must expect along a route, m.
pub(crate) fn noise_m(route: &Route) -> Option<f64> {
    let found = route.residual.map(|residual| residual.tail_m.clamp(LEAST_M, LARGEST_M));
    found.or_else(|| route.range_std_m.map(|std_m| std_m.clamp(LEAST_STANDING_M, LARGEST_M)))
}
