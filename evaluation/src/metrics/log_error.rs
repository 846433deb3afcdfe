use super::mean::Mean;
use interfaces::GroundTruth;
use mapper::Mapper;

/// The log error is limited to this factor, in both directions.
const MAX_FACTOR: f64 = 10.0;

/// The log error of one cell: min(|ln(estimate / truth)|, ln 10). No estimate counts as ln 10.
pub fn log_error(estimate: f64, truth: f64) -> f64 {
    let limit = libm::log(MAX_FACTOR);
    if estimate > 0.0 { libm::log(estimate / truth).abs().min(limit) } else { limit }
}

/// The log error of the rates, the primary metric: the mean of [`log_error`] over the cells of each moving
/// thing that truly changed, then the mean over the things. `None` before anything changed.
///
/// Over- and underestimates weigh the same, no error is unbounded, and a long path counts as much as a short
/// one.
pub fn mean_log_error(mapper: &Mapper, truth: &impl GroundTruth) -> Option<f64> {
    let mut things = Mean::default();
    for thing in truth.moving_things().iter() {
        let mut cells = Mean::default();
        for &index in thing {
            let true_rate = truth.cycle_rate(index);
            if true_rate > 0.0 {
                cells.add(log_error(mapper.rate(index), true_rate));
            }
        }
        things.add_mean(&cells);
    }
    things.get()
}
