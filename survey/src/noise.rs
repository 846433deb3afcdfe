use crate::route::Route;

/// The least noise, m: with poses that were found, and of a laser that stands.
const MIN_M: f64 = 0.02;
const MIN_STANDING_M: f64 = 0.01;
/// The largest noise, m.
const MAX_M: f64 = 0.1;

/// The noise that the mapper must expect along a route, m, by what the route says about the errors of ranges and poses
/// together: the distance below which 97 % of its points lie from the surfaces of other passes, from 0.02 to 0.1 m. At edges,
/// plants and glass, real scans have long tails, each of which would count as a change. Of a laser that stands, it is the noise
/// of its ranges, from 0.01 to 0.1 m. `None` if no place was seen twice.
pub(crate) fn noise_m(route: &Route) -> Option<f64> {
    let found = route.residual.map(|residual| residual.tail_m.clamp(MIN_M, MAX_M));
    found.or_else(|| route.range_std_m.map(|std_m| std_m.clamp(MIN_STANDING_M, MAX_M)))
}
