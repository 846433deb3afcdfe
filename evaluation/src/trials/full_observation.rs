use super::TrialWorld;
use interfaces::{CellReading, GroundTruth, Reading, TrueState, World};

/// The true state of every cell, except of cells that are partly covered, at the time and the pose of a reading. A map of these
/// readings has the errors of the estimator alone: it bounds what exploration can reach.
pub(super) fn observed<W: TrialWorld>(
    world: &W::World,
    of_sensors: &<W::World as World>::Reading,
) -> CellReading {
    let truth = W::truth(world);
    let frame = truth.frame();
    let cells = (0..frame.len()).filter_map(|index| match truth.state(index) {
        TrueState::PartlyCovered => None,
        state => Some((frame.cell(index), state == TrueState::Blocked)),
    });
    CellReading { time: of_sensors.time(), pose: *of_sensors.pose(), cells: cells.collect() }
}
