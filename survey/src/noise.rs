use crate::session::Session;

/// The noise of the mapper, in standard deviations of the residuals of a trajectory. The residuals are taken on surfaces
/// that several passes have seen; at edges, plants and glass they have long tails, each of which would count as a change.
const PER_RESIDUAL: f64 = 5.0;
/// The least and the largest noise, m.
const LEAST_M: f64 = 0.02;
const LARGEST_M: f64 = 0.1;

/// The noise that the mapper must expect, m, by what the trajectories say about the errors of ranges and poses together.
/// `None` if no place was seen twice.
pub fn learned_noise_m(sessions: &[Session]) -> Option<f64> {
    let residuals_m = sessions.iter().filter_map(|session| session.residual_std_m);
    residuals_m.reduce(f64::max).map(|largest_m| (PER_RESIDUAL * largest_m).clamp(LEAST_M, LARGEST_M))
}
